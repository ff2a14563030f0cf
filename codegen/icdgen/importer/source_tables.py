"""Tables as a source prints them, before anybody says what they mean: the intermediate of an import.

A PDF, a text, a spreadsheet, a web page or a folder of table files (`table_files`) gives a list of `SourceTable`. Rules (`rules/`)
give them a meaning. A table keeps what rules need: the line breaks in cells, the spans of cells in both directions, the caption,
the chain of headings above the table, and all text since the table before it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from icdgen.importer.document import Box, Cell, Document, Heading, PrintedRow, Row, SourceRow, Spot, Table, Text
from icdgen.importer.words import plain, squeezed, table_name

SNAP = 3.0  # points: edges of cells that are nearer than this are one
SAME_WIDTH = 8.0  # points: by so much may the parts of a table differ that stand on several pages


class Slot(NamedTuple):
    """One row and column of a table: the cell over it, the first column of that cell, and whether it begins here."""

    cell: Cell
    column: int
    is_origin: bool

    @property
    def text(self) -> str:
        """The text of the cell in the row and column where it begins, and in the rows that it spans; else empty."""
        return self.cell.text if self.is_origin else ""


@dataclass(slots=True)
class SourceTable:
    """A table with all its continuations on later pages.

    ``number`` is its place in the document, counted from 1. ``headings`` is the chain of section headings, the outermost
    first. ``before`` are the texts since the table before, in reading order, headings among them.
    """

    number: int
    rows: list[SourceRow]
    caption: str = ""
    label: int | None = None  # the number that its caption prints
    headings: list[str] = field(default_factory=list)
    before: list[str] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)
    sheet: str = ""  # of a spreadsheet
    shown: list[Row] = field(
        default_factory=list, compare=False, repr=False
    )  # the rows for reports, once they are asked for
    run: int = 1  # which run of ascending labels it is in: parts of a document may number their tables anew

    @property
    def page(self) -> int | None:
        """The page on which the table begins."""
        return self.boxes[0].page if self.boxes else next((row.page for row in self.rows if row.page), None)

    @property
    def line(self) -> int | None:
        """The line on which the first row stands, of sources that have lines."""
        return next((row.line for row in self.rows if row.line), None)

    @property
    def spot(self) -> Spot:
        """Where the table stands, for a finding."""
        return Spot(self.page, self.line, self.label, self.number - 1)

    def spot_of(self, row: SourceRow) -> Spot:
        """Where one of the rows stands."""
        return Spot(row.page or self.page, row.line, self.label, self.number - 1)

    @property
    def title(self) -> str:
        """How a finding calls the table: ``table 12 (`Motor State`)``."""
        name = self.caption or (self.headings[-1] if self.headings else "")
        return f"table {self.number}" + (f" (`{plain(name)[:60]}`)" if name else "")

    @property
    def width(self) -> int:
        """How many columns the table has."""
        return max((len(row) for row in self.grid()), default=0)

    def grid(self) -> list[list[Slot]]:
        """Every row with a slot for each column, cells that span rows or columns in all of their slots."""
        made: list[list[Slot]] = []
        reaching: dict[int, tuple[int, Cell, int]] = (
            {}
        )  # column -> rows that a cell above goes on, the cell, its first column
        for row in self.rows:
            slots: dict[int, Slot] = {}
            for column, (left, cell, first) in list(reaching.items()):
                slots[column] = Slot(cell, first, column == first)
                reaching[column] = left - 1, cell, first
                if left == 1:
                    del reaching[column]
            column = 0
            for cell in row.cells:
                while column in slots:
                    column += 1
                for offset in range(cell.columns):
                    slots[column + offset] = Slot(cell, column, offset == 0)
                    if cell.rows > 1:
                        reaching[column + offset] = cell.rows - 1, cell, column
                column += cell.columns
            width = max(slots, default=-1) + 1
            made.append([slots.get(column) or Slot(Cell(""), column, True) for column in range(width)])
        return made

    @property
    def kind(self) -> tuple[str, ...]:
        """What tables with the same headings have in common: the first row of several filled cells, without case and
        punctuation."""
        return tuple(squeezed(text) for text in self.titles)

    @property
    def titles(self) -> list[str]:
        """The first row of several filled cells: usually the headings of the columns."""
        for row in self.rows:
            texts = [plain(cell.text) for cell in row.cells]
            if sum(map(bool, texts)) > 1:
                return texts
        return [plain(cell.text) for cell in self.rows[0].cells] if self.rows else []

    def as_table(self) -> Table:
        """The table as findings, reports and ICDs refer to it."""
        if not self.shown:
            texts = ([plain(slot.text) for slot in slots] for slots in self.grid())
            self.shown = [Row(cells, row.page, row.line) for cells, row in zip(texts, self.rows, strict=True)]
        return Table(
            self.label,
            self.caption,
            head=self.shown,
            page=self.page,
            line=self.line,
            order=self.number - 1,
            run=self.run,
            boxes=list(self.boxes),
            section=self.headings[-1] if self.headings else "",
        )


def from_document(document: Document) -> list[SourceTable]:
    """Return the tables of a PDF or text in reading order; those without any text are left out."""
    made: list[SourceTable] = []
    chain: list[Heading] = []
    before: list[str] = []
    for block in document.blocks:
        if isinstance(block, Heading):
            chain = [heading for heading in chain if heading.contains(block)] + [block]
            before.append(block.title)
        elif isinstance(block, Text):
            before.append(block.text)
        else:
            rows = block.source_rows or _rows(block)
            if not any(cell.text for row in rows for cell in row.cells):
                continue
            headings = [heading.title for heading in chain]
            boxes = [Box(box.page, *(round(value, 1) for value in box[1:])) for box in block.boxes]
            made.append(
                SourceTable(len(made) + 1, rows, block.caption, block.number, headings, before, boxes, block.sheet)
            )
            before = []
    return made


def _rows(table: Table) -> list[SourceRow]:
    """The rows of a table, its heading row among them."""
    printed = [(_printed(row), row.page, row.line) for row in table.head]
    if table.header is not None:
        titles = table.header.printed or [PrintedRow(table.header.titles)]
        printed += [(row, row.page or table.page, table.line) for row in titles]
    printed += [(_printed(row), row.page, row.line) for row in table.rows]
    edges = _columns([row for row, _, _ in printed])
    made: list[SourceRow] = []
    above: dict[int, Cell] = {}  # first column of a cell of the row above -> the cell
    for row, page, line in printed:
        placed = _placed(row, edges)
        is_open = row.continues if len(row.continues) == len(placed) else (False,) * len(placed)
        cells: list[Cell] = []
        here: dict[int, Cell] = {}
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
        made.append(SourceRow(cells, page, line))
    return made


def _printed(row: Row) -> PrintedRow:
    return row.printed or PrintedRow(row.cells)


def _shift(row: PrintedRow, first: Sequence[float]) -> float:
    """How far the row stands to the left of the rows of the first page: margins of facing pages differ."""
    if not first or not row.edges or abs((row.edges[-1] - row.edges[0]) - (first[-1] - first[0])) > SAME_WIDTH:
        return 0.0
    return first[0] - row.edges[0]


def _columns(rows: list[PrintedRow]) -> list[float]:
    """The edges between which the columns of the whole table stand; none if no row has any."""
    first = max((row.edges for row in rows), key=lambda edges: edges[-1] - edges[0] if edges else 0.0, default=())
    edges: list[float] = []
    for x in sorted(x + _shift(row, first) for row in rows for x in row.edges):
        if not edges or x - edges[-1] > SNAP:
            edges.append(x)
    return edges


def _placed(row: PrintedRow, edges: list[float]) -> list[tuple[Cell, int]]:
    """The cells of a row with the column in which each begins."""
    if not row.edges or len(edges) < 2:
        if len(row.texts) == 1 and len(edges) > 2:
            return [(Cell(row.texts[0], len(edges) - 1), 0)]
        return [(Cell(text), index) for index, text in enumerate(row.texts)]
    shift = _shift(row, edges)
    places = [min(range(len(edges)), key=lambda i: abs(edges[i] - x - shift)) for x in row.edges]
    made: list[tuple[Cell, int]] = [(Cell(""), column) for column in range(places[0])]
    for text, start, end in zip(row.texts, places, places[1:], strict=False):
        if end > start:
            made.append((Cell(text, end - start), start))
        elif text and made:
            made[-1][0].text = f"{made[-1][0].text}\n{text}".strip("\n")
    return made


def count_runs(tables: list[SourceTable]) -> None:
    """Tell each table in which run of ascending labels it stands."""
    run, last = 1, -1
    for table in tables:
        if table.label is not None:
            run += table.label <= last
            last = table.label
        table.run = run


def kinds(tables: list[SourceTable]) -> list[list[SourceTable]]:
    """The tables in groups with the same headings, the most frequent group first."""
    groups: dict[tuple[str, ...], list[SourceTable]] = {}
    for table in tables:
        groups.setdefault(table.kind, []).append(table)
    return sorted(groups.values(), key=lambda group: (-len(group), group[0].number))


def name_of(table: SourceTable) -> str:
    """How people call the table: ``Table 4-12: Motor State``, or its caption, or the heading above it."""
    if table.label is not None:
        return f"Table {table_name(table.label)}" + (f": {table.caption}" if table.caption else "")
    return table.caption or (table.headings[-1] if table.headings else table.sheet)


def texts(table: SourceTable) -> Iterator[str]:
    """Every text of the table and around it."""
    yield from (table.caption, *table.headings, *table.before)
    for row in table.rows:
        yield from (cell.text for cell in row.cells)
