"""Tables without vertical rules and with unknown headings: lines of several aligned
cells.

They become tables so that an import reports them instead of dropping them.
"""

from __future__ import annotations

import itertools

from icdgen.importer.pages.draft import PrintedRow, TableDraft
from icdgen.importer.pages.flow import TextItem
from icdgen.importer.pages.lines import box_around

FEWEST_CELLS = 3
FEWEST_LINES = 3
ALIGNED = 4.0  # points


def with_guessed_tables(
    items: list[TableDraft | TextItem],
) -> list[TableDraft | TextItem]:
    """Return the items, with such lines as tables, so that they are reported."""
    out: list[TableDraft | TextItem] = []
    for is_mark, group in itertools.groupby(
        items, lambda item: isinstance(item, TextItem)
    ):
        run = list(group)
        marks = [item for item in run if isinstance(item, TextItem)]
        at = 0
        for start, end, table in _tables(marks) if is_mark else ():
            out += [*run[at:start], table]
            at = end
        out += run[at:]
    return out


def _tables(marks: list[TextItem]) -> list[tuple[int, int, TableDraft]]:
    """Return first and last index, and the table, of each run of text lines like a
    table.
    """
    tables = []
    start = 0
    while start < len(marks):
        end = _end(marks, start)
        rows = [mark for mark in marks[start:end] if len(mark.cells) >= FEWEST_CELLS]
        # The first line would be the heading row, which does not begin with a number.
        if len(rows) >= FEWEST_LINES and not marks[start].text[:1].isdigit():
            tables.append((start, end, _table(marks[start:end])))
            start = end
        else:
            start += 1
    return tables


def _end(marks: list[TextItem], start: int) -> int:
    """Return the index after the last line of a table that begins at ``start``."""
    first = marks[start]
    if first.kind != "text" or len(first.cells) < FEWEST_CELLS:
        return start
    columns = [x for x, _ in first.cells]
    index = start + 1
    while index < len(marks):
        mark, above = marks[index], marks[index - 1]
        if (
            mark.kind != "text"
            or mark.box.page != first.box.page
            or mark.box.top - above.box.bottom > 2.5 * mark.size
        ):
            break
        hits = sum(
            any(abs(x - column) < ALIGNED for column in columns) for x, _ in mark.cells
        )
        # A single cell in the first column is more likely a line of text below the
        # table.
        alone = len(mark.cells) == 1 and abs(mark.cells[0][0] - columns[0]) < ALIGNED
        if alone or hits < min(2, len(mark.cells)):
            break
        index += 1
    return index


def _table(marks: list[TextItem]) -> TableDraft:
    box = box_around(marks[0].box.page, [mark.box for mark in marks])
    columns = [x for x, _ in marks[0].cells]
    draft = TableDraft([box])
    for mark in marks:
        cells = [""] * len(columns)
        for x, text in mark.cells:
            nearest = min(range(len(columns)), key=lambda i: abs(columns[i] - x))
            cells[nearest] = f"{cells[nearest]} {text}".strip()
        draft.head.append(PrintedRow(cells, page=box.page))
    return draft
