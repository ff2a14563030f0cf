"""What both readers, of PDF and of text, make of a manual: headings, text and tables in reading order."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from icdgen.import_results.findings import CERTAIN as CERTAIN
from icdgen.import_results.findings import DOUBTFUL as DOUBTFUL
from icdgen.import_results.findings import LIKELY as LIKELY
from icdgen.import_results.findings import Spot as Spot
from icdgen.import_results.findings import Trouble as Trouble
from icdgen.importer.words import plain, table_name


class Box(NamedTuple):
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
class PrintedRow:
    """A row exactly as the page shows it, before cells are moved below headings or their lines are joined.

    ``texts``: one text per cell, lines separated by line breaks; ``edges``: the x coordinates between which the cells
    stand, one more than cells, or none where nothing on the page separates them; ``continues``: whether a cell has no rule
    above it, so that it belongs to the cell above.
    """

    texts: list[str]
    edges: tuple[float, ...] = ()
    continues: tuple[bool, ...] = ()
    page: int | None = None

    def slice(self, start: int, width: int) -> PrintedRow:
        """Return the cells of some columns."""
        end = start + width
        return PrintedRow(self.texts[start:end], self.edges[start : end + 1], self.continues[start:end], self.page)


@dataclass(slots=True)
class Cell:
    """A cell; ``text`` has the line breaks of the source, ``columns`` and ``rows`` are its spans."""

    text: str
    columns: int = 1
    rows: int = 1


@dataclass(slots=True)
class SourceRow:
    """The cells that begin in a row, from left to right; those of cells above that reach into it are left out."""

    cells: list[Cell]
    page: int | None = None
    line: int | None = None

    @property
    def shown(self) -> str:
        """The filled cells for a finding."""
        return " | ".join(plain(cell.text) for cell in self.cells if cell.text.strip())


@dataclass(slots=True)
class Row:
    """A row of a table. ``cells`` may be fewer or more than the columns where the page has them so (spans, torn rows)."""

    cells: list[str]
    page: int | None = None
    line: int | None = None
    mended: str = ""  # what the reader had to do to it, in words
    edges: tuple[float, ...] = ()  # of its cells, where rules on the page part them
    printed: PrintedRow | None = None

    @classmethod
    def of(cls, text: str, width: int, page: int | None, line: int | None = None) -> Row:
        """A row of so many cells, of which only the first one holds something: a heading over rows below."""
        return cls([text, *[""] * (width - 1)], page, line)

    @property
    def text(self) -> str:
        """What stands in it, as if it were a line of text."""
        return " ".join(filter(None, self.cells))

    @property
    def shown(self) -> str:
        """Its cells for a finding."""
        return " | ".join(filter(None, self.cells))


@dataclass(slots=True)
class Header:
    """The heading row of a table: what kind of table has such headings, and the role of each cell ("" if unknown)."""

    kind: str  # "fields" | "enumeration" | "list" | "loggable"
    roles: list[str]
    titles: list[str]
    printed: list[PrintedRow] = field(default_factory=list, compare=False)

    @property
    def known(self) -> int:
        """How many cells have a role."""
        return sum(map(bool, self.roles))

    @property
    def known_words(self) -> int:
        """How many words these cells have."""
        return sum(len(title.split()) for title, role in zip(self.titles, self.roles, strict=True) if role)

    @property
    def has_offsets(self) -> bool:
        """Whether a column says where fields stand."""
        return "at" in self.roles or "at_bytes" in self.roles


@dataclass(slots=True)
class Table:
    """A table with all its continuations on later pages. ``head`` are the rows above the headings."""

    number: int | None = None
    caption: str = ""
    header: Header | None = None
    head: list[Row] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)
    page: int | None = None
    line: int | None = None
    doubts: list[str] = field(default_factory=list)  # what makes the reading less than certain
    order: int | None = None  # which table of the document it is
    run: int = 1  # which run of ascending numbers it is in
    section: str = ""  # the heading above it
    sheet: str = ""  # of a spreadsheet
    source_rows: list[SourceRow] = field(default_factory=list)  # of sources that state the spans of cells

    @property
    def all_rows(self) -> list[Row]:
        return self.head + self.rows

    @property
    def spot(self) -> Spot:
        return Spot(self.page, self.line, self.number, self.order)

    def spot_of(self, row: Row) -> Spot:
        """Where one of its rows stands."""
        return Spot(row.page or self.page, row.line, self.number, self.order)

    @property
    def title(self) -> str:
        """How a reader finds it: number and caption."""
        number = f"table {table_name(self.number)}" if self.number is not None else "a table without number"
        if not self.caption and self.number is None and self.section:
            return f"the table below `{self.section[:60]}`"
        return f"{number}: {self.caption}" if self.caption else number


@dataclass(slots=True)
class Heading:
    """A section heading; ``number`` is empty where it has none."""

    number: str
    text: str
    page: int | None = None
    line: int | None = None
    size: float = 0.0  # of its type; larger headings hold smaller ones that have no number

    def contains(self, other: Heading) -> bool:
        """Whether the section goes on when another heading begins: section numbers decide, else the type size."""
        if self.number and other.number:
            return self.number.count(".") < other.number.count(".")
        return bool(self.number) or (not other.number and self.size > other.size + 0.4)

    @property
    def title(self) -> str:
        """Number and text, ``4.2 Motor State``."""
        return f"{self.number} {self.text}".strip()


@dataclass(slots=True)
class Text:
    """A paragraph, or a line of one."""

    text: str
    page: int | None = None
    line: int | None = None


Block = Table | Heading | Text


@dataclass(slots=True)
class Document:
    """A manual as read."""

    file: str
    blocks: list[Block] = field(default_factory=list)
    troubles: list[Trouble] = field(default_factory=list)
    pages: int | None = None  # None for text, which has no pages
    title: str = ""
    needs_rules: bool = False  # of sources whose tables only rules can read

    @property
    def tables(self) -> list[Table]:
        return [block for block in self.blocks if isinstance(block, Table)]

    def count_tables(self) -> None:
        """Tells each table its place in the document."""
        for order, table in enumerate(self.tables):
            table.order = order
