"""Drafts of tables: rows as printed on the page, and their conversion to tables.

`tables` fills a `TableDraft` while it reads the pages. `TableDraft.table` returns the
`SourceTable`, with cells that span rows or columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from icdgen.importer.document import PageBox, SourceCell, SourceRow, SourceTable

SNAP = 3.0  # points: closer edges of cells count as one
# points: maximum difference of the widths of parts of a table on several pages
SAME_WIDTH = 8.0


@dataclass(slots=True)
class PrintedRow:
    """A row as printed on the page.

    ``texts``: one text per cell, with line breaks. ``edges``: the x coordinates of the
    sides of the cells, one more than cells, or none if nothing on the page separates
    them. ``continues``: whether a cell has no rule above it and belongs to the cell
    above.
    """

    texts: list[str]
    edges: tuple[float, ...] = ()
    continues: tuple[bool, ...] = ()
    page: int | None = None

    def slice(self, start: int, width: int) -> PrintedRow:
        """Return the cells of some columns."""
        end = start + width
        return PrintedRow(
            self.texts[start:end],
            self.edges[start : end + 1],
            self.continues[start:end],
            self.page,
        )

    @property
    def lines(self) -> list[str]:
        """The texts of the cells without line breaks."""
        return [" ".join(text.split()) for text in self.texts]


@dataclass(slots=True)
class HeadingRow:
    """The heading row of a table: the kind of table, and the role of each cell ("" if
    unknown).
    """

    kind: (
        str  # "fields" | "enumeration" | "list" | "loggable", or a rule of the profile
    )
    roles: list[str]
    titles: list[str]
    printed: list[PrintedRow] = field(default_factory=list, compare=False)

    @property
    def known(self) -> int:
        """Number of cells with a role."""
        return sum(map(bool, self.roles))

    @property
    def known_words(self) -> int:
        """Number of words of cells with a role."""
        return sum(
            len(title.split())
            for title, role in zip(self.titles, self.roles, strict=True)
            if role
        )

    @property
    def has_offsets(self) -> bool:
        """Whether a column has the offsets of fields."""
        return "at" in self.roles or "at_bytes" in self.roles


@dataclass(slots=True)
class TableDraft:
    """A draft of a table.

    ``head`` are the rows above the headings, ``rows`` the rows below.
    """

    boxes: list[PageBox]
    header: HeadingRow | None = None
    head: list[PrintedRow] = field(default_factory=list)
    rows: list[PrintedRow] = field(default_factory=list)
    edges: list[float] | None = None

    @property
    def last_page(self) -> int:
        """The page of the last part."""
        return self.boxes[-1].page

    def table(self) -> SourceTable:
        """Return the table."""
        titles = (
            (self.header.printed or [PrintedRow(self.header.titles)])
            if self.header
            else []
        )
        return SourceTable(
            rows=_rows([*self.head, *titles, *self.rows], self.boxes[0].page),
            boxes=self.boxes,
        )


def _rows(printed: list[PrintedRow], page: int) -> list[SourceRow]:
    """Return the rows with the spans of their cells.

    ``page`` is the default page of a row.
    """
    edges = _columns(printed)
    rows: list[SourceRow] = []
    above: dict[
        int, SourceCell
    ] = {}  # first column of a cell of the row above -> the cell
    for row in printed:
        placed = _placed(row, edges)
        is_open = (
            row.continues
            if len(row.continues) == len(placed)
            else (False,) * len(placed)
        )
        cells: list[SourceCell] = []
        here: dict[int, SourceCell] = {}
        for (cell, column), goes_on in zip(placed, is_open, strict=True):
            upper = above.get(column)
            if goes_on and upper is not None and upper.columns == cell.columns:
                upper.text = f"{upper.text}\n{cell.text}".strip("\n")
                upper.rows += 1
                here[column] = upper
            else:
                cells.append(cell)
                here[column] = cell
        above = here
        rows.append(SourceRow(cells, row.page or page))
    return rows


def _shift(row: PrintedRow, first: Sequence[float]) -> float:
    """Return the distance of the row to the left of the rows on the first page.

    The margins of facing pages differ.
    """
    if (
        not first
        or not row.edges
        or abs((row.edges[-1] - row.edges[0]) - (first[-1] - first[0])) > SAME_WIDTH
    ):
        return 0.0
    return first[0] - row.edges[0]


def _columns(rows: list[PrintedRow]) -> list[float]:
    """Return the edges of the columns of the whole table, or none if no row has edges."""
    first = max(
        (row.edges for row in rows),
        key=lambda edges: edges[-1] - edges[0] if edges else 0.0,
        default=(),
    )
    edges: list[float] = []
    for x in sorted(x + _shift(row, first) for row in rows for x in row.edges):
        if not edges or x - edges[-1] > SNAP:
            edges.append(x)
    return edges


def _placed(row: PrintedRow, edges: list[float]) -> list[tuple[SourceCell, int]]:
    """Return the cells of a row with their first columns."""
    if not row.edges or len(edges) < 2:
        # A line above the headings spans all columns.
        if len(row.texts) == 1 and len(edges) > 2:
            return [(SourceCell(row.texts[0], len(edges) - 1), 0)]
        return [(SourceCell(text), index) for index, text in enumerate(row.texts)]
    shift = _shift(row, edges)
    places = [
        min(range(len(edges)), key=lambda i: abs(edges[i] - x - shift))
        for x in row.edges
    ]
    # The row can begin right of the first columns.
    placed: list[tuple[SourceCell, int]] = [
        (SourceCell(""), column) for column in range(places[0])
    ]
    for text, start, end in zip(row.texts, places, places[1:], strict=False):
        if end > start:
            placed.append((SourceCell(text, end - start), start))
        # Both sides of the cell are one edge of the table, so that it has no column of
        # its own.
        elif text and placed:
            placed[-1][0].text = f"{placed[-1][0].text}\n{text}".strip("\n")
    return placed
