"""Extraction of words, ruling lines and shaded areas from one page of a PDF.

Only this module uses the pages of pdfplumber. It runs in worker processes, so its
results are small and simple.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.importer.words import SUPERSCRIPTS, plain

THIN = 2.5  # points; a filled rectangle thinner than this is a ruling line
GAP = 0.18  # of the type size; a wider gap between two characters separates words
SMALL = 0.8  # of a word's size: a smaller raised character is a superscript


class Word(NamedTuple):
    """A word. Coordinates are in points, y downwards."""

    text: str
    x0: float
    top: float
    x1: float
    bottom: float
    size: float
    style: str  # font, slant and colour, to tell captions and headings from text

    @property
    def centre(self) -> float:
        return (self.x0 + self.x1) / 2

    @property
    def middle(self) -> float:
        return (self.top + self.bottom) / 2


class RulingLine(NamedTuple):
    """A horizontal or vertical ruling line at ``at``, from ``start`` to ``end``."""

    at: float
    start: float
    end: float


class Fill(NamedTuple):
    """A shaded area."""

    x0: float
    top: float
    x1: float
    bottom: float


@dataclass(slots=True)
class PageContents:
    """Words, ruling lines and shaded areas of a page."""

    number: int
    width: float
    height: float
    words: list[Word] = field(default_factory=list)
    across: list[RulingLine] = field(default_factory=list)  # horizontal rules
    down: list[RulingLine] = field(default_factory=list)  # vertical rules
    fills: list[Fill] = field(default_factory=list)
    images: int = 0
    unmapped: int = 0  # characters without a meaning
    # Words outside the visible page; a reader of the manual does not see them either.
    unseen: int = 0
    turned: int = 0  # words that are not upright
    failed: str = ""  # reason why the page cannot be read


def extract(page: Any) -> PageContents:
    """Return words, rules and shaded areas of a page of pdfplumber."""
    from pdfminer.layout import LTChar, LTCurve, LTImage, LTLine, LTRect
    from pdfplumber.utils.text import extract_words

    # Viewers show the crop box (PDF 32000-1, 14.11.2).
    left, top, right, bottom = (float(edge) for edge in page.cropbox)
    content = PageContents(page.page_number, right - left, bottom - top)
    shift = _Shift(page.mediabox[0] - left, page.mediabox[1] + page.height - top)
    chars = []
    for thing in _drawn(page):
        if isinstance(thing, LTChar):
            chars.append(_char(thing, shift))
        elif isinstance(thing, LTLine):
            _line(content, *shift.box(thing))
        elif isinstance(thing, LTRect):
            _rectangle(content, thing, *shift.box(thing))
        elif isinstance(thing, LTCurve):
            _curve(content, thing, shift)
        elif isinstance(thing, LTImage):
            content.images += 1
    for word in extract_words(
        chars, x_tolerance_ratio=GAP, y_tolerance=2.5, return_chars=True
    ):
        _word(content, word)
    return content


def _drawn(page: Any) -> Iterator[Any]:
    """Iterate over characters, lines, curves and pictures of a page and of its forms.

    The ``objects`` of pdfplumber create a dictionary of twenty entries for each object,
    which takes as long as reading the page.
    """
    from pdfminer.converter import PDFPageAggregator
    from pdfminer.layout import LTContainer
    from pdfminer.pdfinterp import PDFPageInterpreter

    device = PDFPageAggregator(page.pdf.rsrcmgr, pageno=page.page_number)
    PDFPageInterpreter(page.pdf.rsrcmgr, device).process_page(page.page_obj)
    waiting = [iter(device.get_result())]
    while waiting:
        thing = next(waiting[-1], None)
        if thing is None:
            waiting.pop()
        # A form XObject (PDF 32000-1, 8.10) contains objects of the page, too.
        elif isinstance(thing, LTContainer):
            waiting.append(iter(thing))
        else:
            yield thing


class _Shift(NamedTuple):
    """Conversion from coordinates of the sheet (y upwards) to its visible part (y
    downwards).
    """

    x: float
    y: float

    def box(self, thing: Any) -> tuple[float, float, float, float]:
        return (
            thing.x0 + self.x,
            self.y - thing.y1,
            thing.x1 + self.x,
            self.y - thing.y0,
        )


def _char(thing: Any, shift: _Shift) -> dict[str, Any]:
    """Return a character in the form from which pdfplumber assembles words."""
    x0, top, x1, bottom = shift.box(thing)
    # The box of a slanted character overlaps the next one.
    if thing.upright and _slanted(thing):
        x0 = thing.matrix[4] + shift.x
        x1 = x0 + thing.adv * thing.matrix[0]
    return {"text": thing.get_text(), "x0": x0, "x1": x1, "top": top, "bottom": bottom, "doctop": top,
            "upright": thing.upright, "size": thing.size, "from": thing}  # fmt: skip


def _word(content: PageContents, word: Mapping[str, Any]) -> None:
    text = _text(word)
    if not text:
        return
    if not word["upright"]:
        content.turned += 1
        return
    x0, top, x1, bottom = word["x0"], word["top"], word["x1"], word["bottom"]
    if not (
        0 <= (x0 + x1) / 2 <= content.width
        and 0 <= (top + bottom) / 2 <= content.height
    ):
        content.unseen += 1
        return
    content.words.append(
        Word(
            text,
            x0,
            top,
            x1,
            bottom,
            _size(word["chars"]),
            _style(word["chars"][0]["from"]),
        )
    )
    # pdfminer writes `(cid:12)` for a glyph that the PDF maps to no character.
    content.unmapped += text.count("(cid:") + text.count("\ufffd")


def _size(chars: list[dict[str, Any]]) -> float:
    return max(float(char["size"]) for char in chars)


def _style(char: Any) -> str:
    name = char.fontname
    if isinstance(name, bytes):
        name = name.decode("utf-8", "replace")
    shade = " ".join(
        f"{v:.2f}"
        for v in _values(char.graphicstate.ncolor)
        if isinstance(v, (int, float))
    )
    # A subset of a font has a tag in front of its name, as in `ABCDEF+Arial` (PDF
    # 32000-1, 9.6.4).
    return f"{name.rsplit('+', 1)[-1]} {shade}{' slanted' if _slanted(char) else ''}"


def _slanted(char: Any) -> bool:
    """Return whether the matrix slants an upright font.

    Writers without an italic font do this.
    """
    a, b, c, _, _, _ = char.matrix
    # A rotation has both b and c, a slant only c (PDF 32000-1, 8.3.3).
    return not b and abs(c) > 0.1 * abs(a)


def _values(colour: Any) -> tuple[Any, ...]:
    return tuple(colour) if isinstance(colour, (tuple, list)) else (colour,)


def _text(word: Mapping[str, Any]) -> str:
    chars = word["chars"]
    size = _size(chars)
    if min(char["size"] for char in chars) > SMALL * size:
        return plain(word["text"])
    floor = max(char["bottom"] for char in chars if char["size"] > SMALL * size)
    text = ""
    for char in chars:
        # A small character on the base line is no superscript.
        raised = char["size"] <= SMALL * size and char["bottom"] < floor - 0.12 * size
        text += char["text"].translate(SUPERSCRIPTS) if raised else char["text"]
    return plain(text)


def _line(
    content: PageContents, x0: float, top: float, x1: float, bottom: float
) -> None:
    if bottom - top <= THIN and x1 - x0 > bottom - top:
        content.across.append(RulingLine((top + bottom) / 2, x0, x1))
    elif x1 - x0 <= THIN and bottom > top:
        content.down.append(RulingLine((x0 + x1) / 2, top, bottom))


def _rectangle(
    content: PageContents, rect: Any, x0: float, top: float, x1: float, bottom: float
) -> None:
    if x1 - x0 <= THIN or bottom - top <= THIN:
        _line(content, x0, top, x1, bottom)
        return
    if rect.fill and not _white(rect.non_stroking_color):
        content.fills.append(Fill(x0, top, x1, bottom))
    if rect.stroke:
        for y in (top, bottom):
            content.across.append(RulingLine(y, x0, x1))
        for x in (x0, x1):
            content.down.append(RulingLine(x, top, bottom))


def _curve(content: PageContents, curve: Any, shift: _Shift) -> None:
    """Add the straight pieces of a path, with which some writers draw rules."""
    points = [(x + shift.x, shift.y - y) for x, y in curve.pts]
    for (xa, ya), (xb, yb) in itertools.pairwise(points):
        _line(content, min(xa, xb), min(ya, yb), max(xa, xb), max(ya, yb))


def _white(colour: object) -> bool:
    # The initial colour is black (PDF 32000-1, 8.4.1).
    if colour is None:
        return False
    values = _values(colour)
    if not all(isinstance(v, (int, float)) for v in values):
        return False
    # Four values are CMYK, which is white without ink.
    return (
        all(v <= 0.01 for v in values)
        if len(values) == 4
        else all(v >= 0.99 for v in values)
    )
