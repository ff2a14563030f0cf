"""Reading of web pages, Markdown and Word documents.

These formats state headings, captions and spans of cells, so nothing has to be
recognized by its position.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
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

CODE = "IMP002"
# As type sizes: larger ones contain smaller ones.
_HEADINGS = {f"h{level}": float(20 - level) for level in range(1, 7)}
# Elements that browsers show on lines of their own, and cells of tables for layout.
_BREAKS = {
    "address", "article", "aside", "blockquote", "br", "caption", "dd", "details", "div", "dl", "dt", "fieldset",
    "figcaption", "figure", "footer", "form", "h1", "h2", "h3", "h4", "h5", "h6", "header", "hr", "li", "main", "nav",
    "ol", "option", "p", "pre", "section", "summary", "table", "td", "th", "tr", "ul",
}  # fmt: skip
# Limits of HTML for `colspan` and `rowspan`.
_MOST_COLUMNS, _MOST_ROWS = 1000, 65534
# Text that is struck through is no longer valid.
_SKIPPED = {"script", "style", "head", "template", "noscript", "del", "s", "strike"}


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
    # Each line of a paragraph stays a line, because patterns of profiles match lines.
    options = {"html": True, "breaks": True}
    html = MarkdownIt("commonmark", options).enable("table").render(text)
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
    # Without a declared encoding, the parser would read UTF-8 as ISO 8859-1. Other
    # encodings with bytes above 127 are hardly ever valid UTF-8.
    encoding = None if data.isascii() or not _is_utf8(data) else "utf-8"
    parser = html.HTMLParser(encoding=encoding)
    try:
        root = html.document_fromstring(data, parser=parser)
    except etree.ParserError as error:
        raise _refused(f"the page cannot be read: {error}", name) from None
    for entry in parser.error_log:
        # The parser leaves out what is below.
        if entry.message.startswith("Excessive depth"):
            raise _refused("its elements are nested too deeply", name, entry.line)
    title = root.findtext(".//title") or ""
    document = Document(name, title=plain(title))
    _join_source_lines(root)
    body = root.find("body")
    document.blocks = attach_captions(
        list(_html_blocks(body if body is not None else root, profile))
    )
    return document


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _refused(message: str, name: str, line: int = 1) -> Findings:
    return Findings([Finding(CODE, message, Place(name, line), "is it a web page?")])


def _html_blocks(element: Any, profile: Profile) -> Iterator[Block | Caption]:
    line = [element.text or ""]  # texts since the last table, heading or container
    for child in element:
        if not _is_shown(child):
            pass
        elif (
            child.tag in _HEADINGS
            or child.tag == "table"
            or child.find(".//table") is not None
            or any(child.find(f".//{tag}") is not None for tag in _HEADINGS)
        ):
            yield from _paragraphs("".join(line), profile)
            line = []
            if child.tag in _HEADINGS:
                yield _heading(plain(_text(child)), _HEADINGS[child.tag])
            elif child.tag == "table" and not _is_layout(child):
                yield _html_table(child)
            else:
                yield from _html_blocks(child, profile)
        else:
            line.append(_text_in_line(child))
        line.append(child.tail or "")
    yield from _paragraphs("".join(line), profile)


def _is_shown(element: Any) -> bool:
    """Return whether a browser shows the element."""
    # The tag of a comment or of a processing instruction is a function in lxml.
    return isinstance(element.tag, str) and element.tag not in _SKIPPED


def _is_layout(table: Any) -> bool:
    """Return whether a table contains other tables, and therefore only arranges the
    page.
    """
    return table.find(".//table") is not None


def _html_table(table: Any) -> SourceTable:
    caption = table.find("caption")
    text = plain(_text(caption)) if caption is not None else ""
    # All rows are its own: tables that contain others do not come here.
    groups = groupby(table.iter("tr"), key=lambda row: row.getparent())
    rows = [row for _, group in groups for row in _row_group(list(group))]
    return SourceTable(caption=text, rows=rows)


def _row_group(elements: list[Any]) -> list[SourceRow]:
    """Return the rows of a `thead`, `tbody` or `tfoot`.

    Row spans are limited to the group, as in browsers.
    """
    rows = []
    for index, row in enumerate(elements):
        left = len(elements) - index
        cells = [
            SourceCell(
                _cell_text(cell),
                max(_span(cell, "colspan", _MOST_COLUMNS), 1),
                # A row span of 0 extends to the end of the group.
                min(_span(cell, "rowspan", _MOST_ROWS) or left, left),
            )
            for cell in row
            if cell.tag in ("td", "th")
        ]
        rows.append(SourceRow(cells))
    return rows


def _span(cell: Any, name: str, most: int) -> int:
    """Return a span; 1 if it is no number. HTML ignores text behind the number."""
    match = re.match(r"\s*\+?0*([0-9]+)", cell.get(name, ""))
    if match is None:
        return 1
    return min(int(match[1]), most) if len(match[1]) < 9 else most


def _text(element: Any) -> str:
    """Return the text with a line break at each side of a block, and for `<br>`."""
    parts = [element.text or ""]
    for child in element:
        if _is_shown(child):
            parts.append(_text_in_line(child))
        parts.append(child.tail or "")
    return "".join(parts)


def _text_in_line(element: Any) -> str:
    """Return the text of an element as it stands within the text of another."""
    if element.tag == "br":
        return "\n"
    around = "\n" if element.tag in _BREAKS else ""
    return f"{around}{_text(element)}{around}"


def _cell_text(element: Any) -> str:
    """Return the text of a cell with the line breaks of the document."""
    return "\n".join(filter(None, (plain(line) for line in _text(element).split("\n"))))


def _join_source_lines(element: Any) -> None:
    """Make blanks of line ends in the markup, except in `<pre>`."""
    if element.tag == "pre":
        return
    element.text = " ".join((element.text or "").split("\n"))
    for child in element:
        if isinstance(child.tag, str):
            _join_source_lines(child)
        child.tail = " ".join((child.tail or "").split("\n"))


def _heading(text: str, size: float) -> Heading:
    match = re.match(r"(?P<number>[0-9]+(?:\.[0-9]+)*)\.?\s+(?P<text>\S.*)\Z", text)
    return (
        Heading(match["number"], match["text"], size=size)
        if match
        else Heading("", text, size=size)
    )


def _paragraphs(text: str, profile: Profile) -> Iterator[Block | Caption]:
    for line in text.split("\n"):
        yield from _paragraph(line, profile)


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
        yield TextBlock(text)


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
    _accept_changes(word.element.body)
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
                blocks += _paragraphs(part.text, profile)
    document.blocks = attach_captions(blocks)
    return document


# Elements around text, rows and tables, which python-docx does not look into: tracked
# insertions, content controls, tags and fields.
_WORD_WRAPPERS = ("ins", "moveTo", "sdt", "sdtContent", "smartTag", "customXml", "fldSimple")  # fmt: skip
# Descriptions of wrappers, and tracked deletions.
_WORD_SKIPPED = ("del", "moveFrom", "sdtPr", "sdtEndPr", "smartTagPr", "customXmlPr")


def _accept_changes(body: Any) -> None:
    """Take out what is deleted or struck through in a Word document, and wrappers."""
    word = body.nsmap["w"]

    def elements(*names: str) -> list[Any]:
        return list(body.iter(*(f"{{{word}}}{name}" for name in names)))

    # Of a row and of a run, these are properties.
    deleted = [
        mark.getparent().getparent() for mark in elements("del") if _is_of(mark, "trPr")
    ]
    for mark in elements("strike", "dstrike"):
        # Of a paragraph, these are properties of its mark, which is no text.
        is_of_run = _is_of(mark, "rPr") and _is_of(mark.getparent(), "r")
        if is_of_run and mark.get(f"{{{word}}}val") not in ("0", "false", "off"):
            deleted.append(mark.getparent().getparent())
    for element in [*deleted, *elements(*_WORD_SKIPPED)]:
        if element.getparent() is not None:
            element.getparent().remove(element)
    for wrapper in elements(*_WORD_WRAPPERS):
        parent = wrapper.getparent()
        at = parent.index(wrapper)
        parent[at : at + 1] = list(wrapper)


def _is_of(mark: Any, name: str) -> bool:
    return str(mark.getparent().tag).endswith(f"}}{name}")


def _word_rows(table: Any) -> list[SourceRow]:
    """Return the rows of a Word table. Vertically merged cells have a row span."""
    rows: list[SourceRow] = []
    above: dict[int, SourceCell] = {}  # column -> the cell that may go on
    for row in table._tbl.tr_lst:
        cells = []
        here: dict[int, SourceCell] = {}
        column = row.grid_before if hasattr(row, "grid_before") else 0
        cells += [SourceCell("") for _ in range(column)]
        for tc in row.tc_lst:
            span = tc.grid_span
            if tc.vMerge == "continue" and column in above:
                above[column].rows += 1
                here[column] = above[column]
            else:
                lines = (line for p in tc.p_lst for line in p.text.split("\n"))
                cell = SourceCell("\n".join(filter(None, map(plain, lines))), span)
                cells.append(cell)
                here[column] = cell
            column += span
        above = here
        rows.append(SourceRow(cells))
    return rows
