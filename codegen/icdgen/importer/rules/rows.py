"""A table and its rule -> rows by heading.

The operations run in a fixed order, whatever the order of the keys:

transpose, headings, repeated headings, `stop`, `skip`, `join`, `fill`, `glue`, `keep`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from icdgen.importer.document import Slot, SourceCell, SourceRow, SourceTable
from icdgen.importer.rules.language import cell_text, normalised
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rule import TableRule
from icdgen.importer.rules.selection import heading_rows, texts_of_rows


@dataclass
class DataRow:
    """A row below the headings.

    ``values``: heading -> text with its line breaks; ``ranges``: heading -> the first
    and the last column that the cell covers; ``roles``: what the rule knows of the row
    before it looks at cells.
    """

    values: dict[str, str]
    source: SourceRow
    cells: dict[str, SourceCell] = field(default_factory=dict)
    ranges: dict[str, tuple[int, int]] = field(default_factory=dict)
    roles: dict[str, str] = field(default_factory=dict)
    is_short: bool = False

    @property
    def text(self) -> str:
        """The whole row in one line."""
        return " | ".join(filter(None, map(normalised, self.values.values())))


def read_rows(
    rule: TableRule, table: SourceTable, notes: Notes
) -> tuple[list[str], list[DataRow]]:
    """Return the headings and the rows of a table that a rule selected."""
    texts = texts_of_rows(table, rule.transpose)
    head = heading_rows(rule, texts)
    assert head is not None
    grid = table.grid()
    if rule.transpose:
        titles, rows = _transposed(table, grid, head.start if head else -1)
    else:
        heads = grid[head.start : head.stop]
        titles = (
            _titles(heads)
            if head
            else [str(i + 1) for i in range(max(map(len, grid), default=0))]
        )
        below = zip(grid[head.stop :], table.rows[head.stop :], strict=True)
        rows = [
            _row(titles, _completed(rule, titles, slots), row) for slots, row in below
        ]
        repeated = [[normalised(slot.text) for slot in slots] for slots in heads]
        if head:
            rows = [
                row
                for row in rows
                if [normalised(v) for v in row.values.values()] not in repeated
            ]
    return titles, _operated(rule, rows, notes)


def _titles(heads: list[list[Slot]]) -> list[str]:
    """Return the heading of each column.

    A heading over several columns gets a number: ``Name``, ``Name.2``.
    """
    width = max(map(len, heads), default=0)
    titles: list[str] = []
    for column in range(width):
        slots = [row[column] for row in heads if column < len(row)]
        titles.append(
            " ".join(
                dict.fromkeys(
                    filter(None, (normalised(slot.cell.text) for slot in slots))
                )
            )
        )
    return [numbered(title, titles[:index]) for index, title in enumerate(titles)]


def numbered(title: str, before: list[str]) -> str:
    """Return the heading, with a number if columns to the left have it, too."""
    count = before.count(title)
    return f"{title}.{count + 1}" if count and title else title


def _completed(rule: TableRule, titles: list[str], slots: list[Slot]) -> list[Slot]:
    """Return the cells of a row.

    If the row has one cell less than headings, an empty cell is added in the column
    `absent`.
    """
    at = next(
        (index for index, title in enumerate(titles) if title in rule.absent), None
    )
    # Only if one cell is missing, so that the cell at its place is that of the next
    # column.
    if at is None or len(slots) != len(titles) - 1 or not slots[at].text.strip():
        return slots
    return [
        *slots[:at],
        Slot(SourceCell(""), at, True),
        *(slot._replace(column=slot.column + 1) for slot in slots[at:]),
    ]


def _row(titles: list[str], slots: list[Slot], source: SourceRow) -> DataRow:
    data_row = DataRow(
        dict.fromkeys(filter(None, titles), ""),
        source,
        is_short=len(slots) < len(titles),
    )
    for column, slot in enumerate(slots):
        title = titles[column] if column < len(titles) else ""
        # A cell below no heading keeps its text, so that it is reported as a column
        # without a role.
        if not title and slot.is_origin and slot.cell.text.strip():
            title = f"column {column + 1}"
        if not title or not slot.is_origin:
            continue
        data_row.values[title] = slot.cell.text
        data_row.cells[title] = slot.cell
        data_row.ranges[title] = (
            column,
            min(column + slot.cell.columns, len(titles)) - 1,
        )
    return data_row


def _transposed(
    table: SourceTable, grid: list[list[Slot]], head: int
) -> tuple[list[str], list[DataRow]]:
    """Rows for the columns of a table whose headings stand on the left.

    A cell over several columns is one row, in which the other cells give a range
    (``7:5``); a heading that is repeated begins the next byte.
    """
    names = [
        normalised(slots[head].cell.text) if head < len(slots) else "" for slots in grid
    ]
    # The first heading repeats at the beginning of each block.
    starts = [index for index, name in enumerate(names) if name == names[0]]
    titles = names[: starts[1] if len(starts) > 1 else None]
    data_rows: list[DataRow] = []
    for block, start in enumerate(starts):
        rows = grid[start : starts[block + 1] if block + 1 < len(starts) else None]
        source = table.rows[start]
        width = max(map(len, rows), default=0)
        column = head + 1
        while column < width:
            end = max(
                (
                    slots[column].column + slots[column].cell.columns
                    for slots in rows
                    if column < len(slots)
                ),
                default=column + 1,
            )
            values = {}
            for name, slots in zip(titles, rows, strict=False):
                texts = [slot.cell.text for slot in slots[column:end] if slot.is_origin]
                values[name] = texts[0] if texts else ""
                if len(texts) > 1:
                    values[name] = f"{texts[0]}:{texts[-1]}"
            data_rows.append(
                DataRow(
                    values,
                    source,
                    roles={"byte": str(block)} if len(starts) > 1 else {},
                )
            )
            column = max(end, column + 1)
    return titles, data_rows


def _operated(rule: TableRule, rows: list[DataRow], notes: Notes) -> list[DataRow]:
    joined: list[DataRow] = []
    section = ""
    for row in rows:
        if not any(text.strip() for text in row.values.values()):
            continue
        if rule.stop is not None and rule.stop.search(row.text):
            break
        # `skip` precedes `join`: a total row without a name would be joined to the last
        # field and dropped with it.
        if rule.skip is not None and rule.skip.search(row.text):
            notes.drop(rule, "skip", row.text)
            continue
        if rule.group_rows:
            filled = [normalised(text) for text in row.values.values() if text.strip()]
            if len(filled) == 1 and normalised(next(iter(row.values.values()))):
                section = filled[0]
                continue
            row.roles["section"] = section
        if (
            joined
            and rule.join
            and all(_goes_on(joined[-1], row, title) for title in rule.join)
        ):
            _append(joined[-1], row)
            continue
        joined.append(row)
    above: dict[str, str] = {}
    for row in joined:
        for title in rule.fill:
            above[title] = row.values[title] = row.values.get(title) or above.get(
                title, ""
            )
        for title in rule.glue:
            if title in row.values:
                row.values[title] = re.sub(r"\s*\n\s*", "", row.values[title])
    selected = []
    for row in joined:
        if all(
            pattern.search(normalised(row.values.get(title, "")))
            for title, pattern in rule.keep.items()
        ):
            selected.append(row)
        else:
            notes.drop(rule, "keep", row.text)
    return selected


def _goes_on(above: DataRow, row: DataRow, title: str) -> bool:
    """Return whether a column is empty in a row, or has a cell that spans the row
    above, too.
    """
    cell = row.cells.get(title)
    return not row.values.get(title, "").strip() or (
        cell is not None and cell is above.cells.get(title)
    )


def _append(above: DataRow, row: DataRow) -> None:
    """Append the cells of a row to the cells of the row above.

    A cell that spans both rows stands there already, and so does the rest of a cell
    that a page break repeats.
    """
    for title, text in row.values.items():
        if text.strip() and row.cells.get(title) is not above.cells.get(title):
            # Some writers repeat the last lines of a cell on the next page. Shorter
            # texts, such as units, repeat by themselves.
            if len(text) > 12 and normalised(above.values.get(title, "")).endswith(
                normalised(text)
            ):
                continue
            above.values[title] = f"{above.values.get(title, '')}\n{text}".strip("\n")
    above.cells = {
        title: cell
        for title, cell in above.cells.items()
        if cell is row.cells.get(title)
    } | {title: cell for title, cell in above.cells.items() if title not in row.cells}


def one_line(row: DataRow, title: str, document_words: frozenset[str]) -> str:
    """Return the text of a cell in one line."""
    return cell_text(row.values.get(title, ""), document_words)
