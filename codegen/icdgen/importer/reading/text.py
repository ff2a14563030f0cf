"""Text with tab-separated tables -> document. Page breaks stand within tables as blank lines; rows may be torn there."""

from __future__ import annotations

import re
from pathlib import Path

from icdgen.importer import headings, labels
from icdgen.importer.document import Block, Document, Heading, Row, Table, Text
from icdgen.importer.profile import Profile
from icdgen.importer.reading.captions import Caption, attach_captions
from icdgen.importer.reading.utf8 import utf8_text
from icdgen.importer.understand import grids
from icdgen.importer.words import CONTINUED, plain, table_number

_RULE = re.compile(r"\s*:?-{2,}:?\s*\Z")
_HEADING = re.compile(r"(?P<number>[0-9]+(?:\.[0-9]+)*)\.?\s+(?P<text>[A-Z].*)\Z")


def read(path: Path, profile: Profile) -> Document:
    """The document of a text. Raises `Findings` if it is not UTF-8."""
    name = str(path)
    text = utf8_text(path, "save the text as UTF-8")
    document = Document(name)
    reader = _Reader(profile, name)
    for number, words in enumerate(re.split("\r\n|[\n\r]", text), 1):
        reader.line(words.rstrip(" "), number)
    document.blocks = reader.done()
    document.pages = reader.page if "\f" in text else None
    return document


class _Reader:
    def __init__(self, profile: Profile, name: str) -> None:
        self.profile, self.name = profile, name
        self.blocks: list[Block | Caption] = []
        self.table: Table | None = None
        self.raw: list[Row] = []
        self.page: int | None = None
        self.in_code = False

    def line(self, text: str, number: int) -> None:
        if "\f" in text:
            self.page = (self.page or 1) + text.count("\f")
            text = text.replace("\f", "")
        if text.lstrip().startswith("```"):
            self.in_code = not self.in_code
            return
        if self.in_code or not text.strip():
            return
        if "\t" in text:
            cells = [plain(cell) for cell in text.split("\t")]
            if all(_RULE.match(cell) for cell in cells if cell):
                return  # what a converter puts below a heading row
            self.row(Row(cells, self.page, number))
            return
        self.close()
        caption = self.profile.caption.match(plain(text))
        heading = _HEADING.match(plain(text))
        if caption and (caption["mark"] or not caption["title"]):
            title = CONTINUED.sub("", caption["title"]).strip()
            self.blocks.append(Caption(table_number(caption["number"]), title, plain(text), self.page, number))
        elif heading and len(text) < 120:
            self.blocks.append(Heading(heading["number"], heading["text"], self.page, number))
        else:
            self.blocks.append(Text(plain(text), self.page, number))

    def row(self, row: Row) -> None:
        if self.raw and (labels.begins(row.text, self.profile) or grids.is_heading(row)):
            self.close()
        self.raw.append(row)

    def close(self) -> None:
        """Ends the table: finds its heading row, and puts each row's cells under the headings."""
        if not self.raw:
            return
        table = Table(page=self.raw[0].page, line=self.raw[0].line)
        rows, self.raw = self.raw, []
        index = 0
        while index < len(rows):
            row = rows[index]
            index += 1
            if table.header is None:
                found = headings.match(row.cells, self.profile, loose=True)
                both = _stacked(row.cells, rows[index].cells) if index < len(rows) else None
                stacked = headings.match(both, self.profile) if both else None
                if stacked and (found is None or stacked.known_words > found.known_words):
                    found = stacked
                    index += 1
                if found is None:
                    table.head.append(row)
                else:
                    table.header = found
            elif not headings.repeats(row.cells, table.header, self.profile):
                table.rows.append(_fitted(row, table))
        self.blocks.append(table)

    def done(self) -> list[Block]:
        """The blocks, each caption with its table."""
        self.close()
        return attach_captions(self.blocks)


def _stacked(upper: list[str], lower: list[str]) -> list[str] | None:
    """Headings in two lines as one row."""
    if len(lower) > len(upper) or any(re.match("[0-9]", cell) for cell in lower):
        return None
    lower = lower + [""] * (len(upper) - len(lower))
    return [f"{a} {b}".strip() for a, b in zip(upper, lower, strict=True)]


def _fitted(row: Row, table: Table) -> Row:
    """The row with a cell for each heading: a first empty cell that was lost is put back, surplus ones are cut."""
    header = table.header
    assert header is not None
    cells = row.cells
    width = len(header.roles)
    if len(cells) == width - 1 and cells[0] and not header.roles[0] and re.match("[0-9]", cells[0]):
        row.mended = "its first, empty cell was lost"
        cells = ["", *cells]
    if len(cells) > width and not any(cells[width:]):
        cells = cells[:width]
    row.cells = cells + [""] * (width - len(cells))
    return row
