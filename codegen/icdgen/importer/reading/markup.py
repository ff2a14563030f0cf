"""Web pages, Markdown and Word documents -> documents.

They state headings, captions and spans themselves.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
from icdgen.importer.document import (
    Block,
    Cell,
    Document,
    Heading,
    SourceRow,
    SourceTable,
    Text,
)
from icdgen.importer.profile import Profile
from icdgen.importer.reading.captions import Caption, attach_captions
from icdgen.importer.reading.utf8 import utf8_text
from icdgen.importer.words import CONTINUED, plain, table_number

CODE = "IMP002"
# As type sizes: larger ones contain smaller ones.
_HEADINGS = {f"h{level}": float(20 - level) for level in range(1, 7)}
_BREAKS = {"p", "div", "li", "br", "tr"}
_SKIPPED = {"script", "style", "head", "template", "noscript"}


def read_html(path: Path, profile: Profile) -> Document:
    """Return the document of a web page.

    Raises `Findings` if it cannot be read, `UserError` without lxml.
    """
    return _of_html(path.read_bytes(), str(path), profile)


def read_markdown(path: Path, profile: Profile) -> Document:
    """Return the document of a Markdown file: GitHub's tables, and HTML tables within
    it.
    """
    from markdown_it import MarkdownIt

    text = utf8_text(path, "save it as UTF-8")
    html = MarkdownIt("commonmark", {"html": True}).enable("table").render(text)
    return _of_html(
        # Without a declared encoding, the parser would guess one.
        f'<html><meta charset="utf-8"><body>{html}</body></html>'.encode(),
        str(path),
        profile,
    )


def _of_html(data: bytes, name: str, profile: Profile) -> Document:
    try:
        from lxml import etree, html
    except ImportError:
        raise UserError(
            "reading a web page or Markdown needs lxml", "pip install 'icdgen[import]'"
        ) from None
    try:
        root = html.document_fromstring(data)
    except etree.ParserError as error:
        raise Findings(
            [
                Finding(
                    CODE,
                    f"the page cannot be read: {error}",
                    Place(name),
                    "is it a web page?",
                )
            ]
        ) from None
    title = root.findtext(".//title") or ""
    document = Document(name, title=plain(title))
    body = root.find("body")
    document.blocks = attach_captions(
        list(_html_blocks(body if body is not None else root, profile))
    )
    return document


def _html_blocks(element: Any, profile: Profile) -> Iterator[Block | Caption]:
    # The tag of a comment or of a processing instruction is a function in lxml.
    for child in element:
        if not isinstance(child.tag, str) or child.tag in _SKIPPED:
            continue
        if child.tag == "table" and not _is_layout(child):
            yield _html_table(child)
        elif child.tag in _HEADINGS:
            yield _heading(plain(_text(child)), _HEADINGS[child.tag])
        elif (
            child.find(".//table") is not None
            or child.find(".//h1") is not None
            or child.tag in ("div", "section", "article", "main")
        ):
            if child.text and child.text.strip():
                yield from _paragraph(child.text, profile)
            yield from _html_blocks(child, profile)
        else:
            for line in _text(child).split("\n"):
                yield from _paragraph(line, profile)
        if child.tail and child.tail.strip():
            yield from _paragraph(child.tail, profile)


def _is_layout(table: Any) -> bool:
    """Return whether a table contains other tables, and therefore only arranges the
    page.
    """
    return table.find(".//table") is not None


def _html_table(table: Any) -> SourceTable:
    caption = table.find("caption")
    rows = []
    # All rows are its own: tables that contain others do not come here.
    for row in table.iter("tr"):
        cells = [c for c in row if c.tag in ("td", "th")]
        rows.append(
            SourceRow(
                [
                    Cell(_cell_text(c), _span(c, "colspan"), _span(c, "rowspan"))
                    for c in cells
                ]
            )
        )
    text = plain(_text(caption)) if caption is not None else ""
    return SourceTable(caption=text, rows=_within(rows))


def _within(rows: list[SourceRow]) -> list[SourceRow]:
    """Return the rows with row spans limited to the table, as in browsers."""
    for index, row in enumerate(rows):
        for cell in row.cells:
            cell.rows = min(cell.rows, len(rows) - index)
    return rows


def _span(cell: Any, name: str) -> int:
    text = cell.get(name, "1").strip()
    # HTML limits `colspan` to 1,000.
    return min(max(int(text), 1), 1000) if text.isdigit() else 1


def _text(element: Any) -> str:
    """Return the text with a line break at each side of a block, and for `<br>`."""
    parts = [element.text or ""]
    for child in element:
        if isinstance(child.tag, str) and child.tag not in _SKIPPED:
            around = "\n" if child.tag in _BREAKS else ""
            parts.append(f"{around if child.tag != 'br' else ''}{_text(child)}{around}")
        parts.append(child.tail or "")
    return "".join(parts)


def _cell_text(element: Any) -> str:
    """Return the text of a cell with the line breaks of the document.

    Line ends of the markup are blanks.
    """
    for child in element.iter():
        if isinstance(child.tag, str) and child.tag != "pre":
            child.text = " ".join(child.text.split("\n")) if child.text else child.text
        if child is not element:
            child.tail = " ".join(child.tail.split("\n")) if child.tail else child.tail
    return "\n".join(filter(None, (plain(line) for line in _text(element).split("\n"))))


def _heading(text: str, size: float) -> Heading:
    match = re.match(r"(?P<number>[0-9]+(?:\.[0-9]+)*)\.?\s+(?P<text>\S.*)\Z", text)
    return (
        Heading(match["number"], match["text"], size=size)
        if match
        else Heading("", text, size=size)
    )


def _paragraph(text: str, profile: Profile) -> Iterator[Block | Caption]:
    text = plain(text)
    if not text:
        return
    caption = profile.caption.match(text)
    if caption and (caption["mark"] or not caption["title"]):
        yield Caption(
            table_number(caption["number"]),
            CONTINUED.sub("", caption["title"]).strip(),
            text,
        )
    else:
        yield Text(text)


def read_docx(path: Path, profile: Profile) -> Document:
    """Return the document of a Word file.

    Raises `Findings` if it cannot be read, `UserError` without python-docx.
    """
    try:
        import docx
        from docx.opc.exceptions import PackageNotFoundError
        from docx.table import Table as WordTable
        from docx.text.paragraph import Paragraph
    except ImportError:
        raise UserError(
            "reading a Word document needs python-docx", "pip install 'icdgen[import]'"
        ) from None
    try:
        word = docx.Document(str(path))
    except (PackageNotFoundError, zipfile.BadZipFile, KeyError, ValueError) as error:
        help = "open it in a word processor and save it as .docx"
        raise Findings(
            [
                Finding(
                    CODE,
                    f"the document cannot be read: {error}",
                    Place(str(path)),
                    help,
                )
            ]
        ) from None
    document = Document(str(path), title=word.core_properties.title or "")
    blocks: list[Block | Caption] = []
    for part in word.iter_inner_content():
        if isinstance(part, WordTable):
            blocks.append(SourceTable(rows=_word_rows(part)))
        elif isinstance(part, Paragraph):
            style = (
                part.style.name if part.style is not None and part.style.name else ""
            )
            # Word stores the names of its own styles in English, whatever its language.
            level = style.removeprefix("Heading ")
            if style.startswith("Heading ") and level.isdigit():
                blocks.append(_heading(plain(part.text), 20.0 - int(level)))
            else:
                for line in part.text.split("\n"):
                    blocks += _paragraph(line, profile)
    document.blocks = attach_captions(blocks)
    return document


def _word_rows(table: Any) -> list[SourceRow]:
    """Return the rows of a Word table. Vertically merged cells have a row span."""
    rows: list[SourceRow] = []
    above: dict[int, Cell] = {}  # column -> the cell that may go on
    for row in table._tbl.tr_lst:
        cells = []
        here: dict[int, Cell] = {}
        column = row.grid_before if hasattr(row, "grid_before") else 0
        cells += [Cell("") for _ in range(column)]
        for tc in row.tc_lst:
            span = tc.grid_span
            if tc.vMerge == "continue" and column in above:
                above[column].rows += 1
                here[column] = above[column]
            else:
                lines = (line for p in tc.p_lst for line in p.text.split("\n"))
                cell = Cell("\n".join(filter(None, map(plain, lines))), span)
                cells.append(cell)
                here[column] = cell
            column += span
        above = here
        rows.append(SourceRow(cells))
    return rows
