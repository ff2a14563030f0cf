"""Reading of text with tab-separated tables.

Page breaks are blank lines within tables, and can divide a row. `read` takes a file in
UTF-8 and a profile, and returns a `Document`. A line with tabs is a row. Any other line
with text ends the table and is a caption, heading or text. Form feeds count pages; code
blocks (```) are ignored. `reading` calls it for files of no other kind.
"""

from __future__ import annotations

import re
from pathlib import Path

from icdgen.importer import labels
from icdgen.importer.document import (
    Block,
    Document,
    Heading,
    SourceCell,
    SourceRow,
    SourceTable,
    TextBlock,
)
from icdgen.importer.profile import Profile
from icdgen.importer.reading.captions import Caption, attach_captions
from icdgen.importer.reading.utf8 import utf8_text
from icdgen.importer.words import CONTINUED, plain, table_number

_RULE = re.compile(r"\s*:?-{2,}:?\s*\Z")
_HEADING = re.compile(r"(?P<number>[0-9]+(?:\.[0-9]+)*)\.?\s+(?P<text>[A-Z].*)\Z")


def read(path: Path, profile: Profile) -> Document:
    """Return the document of a text file. Raise `Findings` if it is not UTF-8."""
    name = str(path)
    text = utf8_text(path, "save the text as UTF-8")
    document = Document(name)
    reader = _TextReader(profile, name)
    # Not `splitlines`, which would also split at form feeds.
    for number, words in enumerate(re.split("\r\n|[\n\r]", text), 1):
        reader.line(words.rstrip(" "), number)
    document.blocks = reader.done()
    document.pages = reader.page if "\f" in text else None
    return document


class _TextReader:
    def __init__(self, profile: Profile, name: str) -> None:
        self.profile, self.name = profile, name
        self.blocks: list[Block | Caption] = []
        self.rows: list[SourceRow] = []
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
            self.row(cells, number)
            return
        self.close()
        caption = self.profile.caption.match(plain(text))
        heading = _HEADING.match(plain(text))
        if caption and (caption["mark"] or not caption["title"]):
            title = CONTINUED.sub("", caption["title"]).strip()
            self.blocks.append(
                Caption(
                    table_number(caption["number"]),
                    title,
                    plain(text),
                    self.page,
                    number,
                )
            )
        elif heading and len(text) < 120:
            self.blocks.append(
                Heading(heading["number"], heading["text"], self.page, number)
            )
        else:
            self.blocks.append(TextBlock(plain(text), self.page, number))

    def row(self, cells: list[str], number: int) -> None:
        if labels.begins_message_table(" ".join(filter(None, cells)), self.profile):
            self.close()  # a message's table begins behind the one before it
        self.rows.append(SourceRow(list(map(SourceCell, cells)), self.page, number))

    def close(self) -> None:
        """End the table."""
        if self.rows:
            self.blocks.append(SourceTable(rows=self.rows))
            self.rows = []

    def done(self) -> list[Block]:
        """Return the blocks, with captions assigned to tables."""
        self.close()
        return attach_captions(self.blocks)
