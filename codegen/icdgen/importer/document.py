"""Headings, text and tables of a document in reading order, whatever the source.

Rules (`rules/`) give tables a meaning. A table keeps what rules need: the line breaks
in cells, the spans of cells in both directions, the caption, the chain of headings
above the table, and all text since the table before it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.frozen import NamedTuple
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.words import plain, squeezed


class PageBox(NamedTuple):
    """A rectangle on a page in points; y grows downwards."""

    page: int
    x0: float
    top: float
    x1: float
    bottom: float

    @property
    def width(self) -> float:
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        return self.bottom - self.top


@dataclass(slots=True)
class SourceCell:
    """A cell; ``text`` has the line breaks of the source, ``columns`` and ``rows`` are
    its spans.
    """

    text: str
    columns: int = 1
    rows: int = 1


@dataclass(slots=True)
class SourceRow:
    """Cells that begin in a row, from left to right.

    Cells of rows above that span this row are not repeated.
    """

    cells: list[SourceCell]
    page: int | None = None
    line: int | None = None

    @property
    def shown(self) -> str:
        """The filled cells, for a finding."""
        return " | ".join(plain(cell.text) for cell in self.cells if cell.text.strip())


class Slot(NamedTuple):
    """One row and column of a table: the cell over it, the first column of that cell,
    and whether it begins here.
    """

    cell: SourceCell
    column: int
    is_origin: bool

    @property
    def text(self) -> str:
        """Text of the cell in its first column, and in all rows that it spans;
        otherwise empty.
        """
        return self.cell.text if self.is_origin else ""


@dataclass(slots=True)
class SourceTable:
    """A table with all its continuations on later pages.

    ``number`` is its place in the document, counted from 1. ``headings`` is the chain
    of section headings, the outermost first. ``before`` are the texts since the table
    before, in reading order, headings among them; ``after`` those behind the last table
    of the document.
    """

    number: int = 0
    rows: list[SourceRow] = field(default_factory=list)
    caption: str = ""
    label: int | None = None  # the number that its caption prints
    headings: list[str] = field(default_factory=list)
    before: list[str] = field(default_factory=list)
    after: list[str] = field(default_factory=list)
    boxes: list[PageBox] = field(default_factory=list)
    sheet: str = ""  # of a spreadsheet
    # Which run of ascending labels it is in: parts of a document may number their
    # tables anew.
    run: int = 1

    @property
    def page(self) -> int | None:
        """First page of the table."""
        return (
            self.boxes[0].page
            if self.boxes
            else next((row.page for row in self.rows if row.page), None)
        )

    @property
    def line(self) -> int | None:
        """Line of the first row, if the source has lines."""
        return next((row.line for row in self.rows if row.line), None)

    @property
    def spot(self) -> SourcePlace:
        """Place of the table, for a finding."""
        return SourcePlace(self.page, self.line, self.label, self.number - 1)

    def spot_of(self, row: SourceRow) -> SourcePlace:
        """Return the place of a row."""
        return SourcePlace(row.page or self.page, row.line, self.label, self.number - 1)

    @property
    def title(self) -> str:
        """Title for a finding, such as ``table 12 (`Motor State`)``."""
        name = self.caption or (self.headings[-1] if self.headings else "")
        return f"table {self.number}" + (f" (`{plain(name)[:60]}`)" if name else "")

    @property
    def width(self) -> int:
        """Number of columns."""
        return max((len(row) for row in self.grid()), default=0)

    def grid(self) -> list[list[Slot]]:
        """Every row with a slot for each column, cells that span rows or columns in all
        of their slots.
        """
        grid: list[list[Slot]] = []
        # Column -> rows that a cell above goes on, the cell, its first column.
        reaching: dict[int, tuple[int, SourceCell, int]] = {}
        for row in self.rows:
            slots: dict[int, Slot] = {}
            for column, (left, cell, first) in list(reaching.items()):
                slots[column] = Slot(cell, first, column == first)
                reaching[column] = left - 1, cell, first
                if left == 1:
                    del reaching[column]
            column = 0
            for cell in row.cells:
                # Cells of rows above that span this row occupy their columns.
                while column in slots:
                    column += 1
                for offset in range(cell.columns):
                    slots[column + offset] = Slot(cell, column, offset == 0)
                    if cell.rows > 1:
                        reaching[column + offset] = cell.rows - 1, cell, column
                column += cell.columns
            width = max(slots, default=-1) + 1
            grid.append(
                [
                    slots.get(column) or Slot(SourceCell(""), column, True)
                    for column in range(width)
                ]
            )
        return grid

    @property
    def kind(self) -> tuple[str, ...]:
        """Key of all tables with the same headings: the first row of several filled
        cells, without case and punctuation.
        """
        return tuple(squeezed(text) for text in self.titles)

    @property
    def titles(self) -> list[str]:
        """First row with several filled cells, usually the headings of the columns."""
        for row in self.rows:
            texts = [plain(cell.text) for cell in row.cells]
            if sum(map(bool, texts)) > 1:
                return texts
        return [plain(cell.text) for cell in self.rows[0].cells] if self.rows else []


@dataclass(slots=True)
class Heading:
    """A section heading; ``number`` is empty where it has none."""

    number: str
    text: str
    page: int | None = None
    line: int | None = None
    # of its type; larger headings hold smaller ones that have no number
    size: float = 0.0

    def contains(self, other: Heading) -> bool:
        """Return whether the section continues at another heading.

        Section numbers are compared if both headings have one, otherwise type sizes.
        """
        if self.number and other.number:
            return self.number.count(".") < other.number.count(".")
        return bool(self.number) or (not other.number and self.size > other.size + 0.4)

    @property
    def title(self) -> str:
        """Number and text, ``4.2 Motor State``."""
        return f"{self.number} {self.text}".strip()


@dataclass(slots=True)
class TextBlock:
    """A paragraph, or a line of one."""

    text: str
    page: int | None = None
    line: int | None = None


Block = SourceTable | Heading | TextBlock


@dataclass(slots=True)
class Document:
    """A manual as read."""

    file: str
    blocks: list[Block] = field(default_factory=list)
    import_findings: list[ImportFinding] = field(default_factory=list)
    pages: int | None = None  # None for text, which has no pages
    title: str = ""

    @property
    def tables(self) -> list[SourceTable]:
        return [block for block in self.blocks if isinstance(block, SourceTable)]
