"""One page of a PDF -> its words, ruling lines and shaded areas. The only place that knows pdfplumber.

Runs in worker processes, so what it returns is small and plain.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from icdgen.importer.words import SUPERSCRIPTS, plain

THIN = 2.5  # points; a filled rectangle thinner than this is a ruling line
GAP = 0.18  # of the type size; a wider gap between two characters separates words
SMALL = 0.8  # of a word's size: a smaller raised character is a superscript


class Word(NamedTuple):
    """A word; coordinates in points, y downwards."""

    text: str
    x0: float
    top: float
    x1: float
    bottom: float
    size: float
    style: str  # font and colour, to tell captions and headings from text

    @property
    def middle(self) -> float:
        return (self.top + self.bottom) / 2


class Rule(NamedTuple):
    """A horizontal or vertical ruling line: at ``at``, from ``start`` to ``end``."""

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
class Page:
    """What a page shows."""

    number: int
    width: float
    height: float
    words: list[Word] = field(default_factory=list)
    across: list[Rule] = field(default_factory=list)  # horizontal rules
    down: list[Rule] = field(default_factory=list)  # vertical rules
    fills: list[Fill] = field(default_factory=list)
    images: int = 0
    unmapped: int = 0  # characters without a meaning
    unseen: int = 0  # words outside the visible page; a reader of the manual does not see them either
    turned: int = 0  # words that do not stand upright
    failed: str = ""  # why the page could not be read


def extract(page: Any) -> Page:
    """What ``page``, a page of pdfplumber, shows."""
    left, top, right, bottom = (float(edge) for edge in page.cropbox)
    made = Page(page.page_number, right - left, bottom - top, images=len(page.images))
    shift = _Shift(left, top)
    words = page.extract_words(
        x_tolerance_ratio=GAP, y_tolerance=2.5, keep_blank_chars=False, use_text_flow=False, return_chars=True
    )
    for word in words:
        text = _text(word)
        if not text:
            continue
        if not word.get("upright", True):
            made.turned += 1
            continue
        x0, above, x1, below = shift.box(word)
        if not (0 <= (x0 + x1) / 2 <= made.width and 0 <= (above + below) / 2 <= made.height):
            made.unseen += 1
            continue
        made.words.append(Word(text, x0, above, x1, below, _size(word["chars"]), _style(word)))
        made.unmapped += text.count("(cid:") + text.count("\ufffd")
    for line in page.lines:
        _line(made, *shift.box(line))
    for rect in page.rects:
        _rectangle(made, rect, *shift.box(rect))
    for curve in page.curves:
        _curve(made, curve, shift)
    return made


class _Shift(NamedTuple):
    """From the coordinates of a PDF's sheet to those of its visible part."""

    x: float
    y: float

    def box(self, thing: Mapping[str, Any]) -> tuple[float, float, float, float]:
        return thing["x0"] - self.x, thing["top"] - self.y, thing["x1"] - self.x, thing["bottom"] - self.y


def _size(chars: list[dict[str, Any]]) -> float:
    return max(float(char["size"]) for char in chars)


def _style(word: Mapping[str, Any]) -> str:
    first = word["chars"][0]
    colour = first.get("non_stroking_color")
    values = colour if isinstance(colour, (tuple, list)) else (colour,)
    shade = " ".join(f"{v:.2f}" for v in values if isinstance(v, (int, float)))
    return f"{first['fontname'].rsplit('+', 1)[-1]} {shade}"


def _text(word: Mapping[str, Any]) -> str:
    chars = word["chars"]
    size = _size(chars)
    if min(char["size"] for char in chars) > SMALL * size:
        return plain(word["text"])
    floor = max(char["bottom"] for char in chars if char["size"] > SMALL * size)
    text = ""
    for char in chars:
        raised = char["size"] <= SMALL * size and char["bottom"] < floor - 0.12 * size
        text += char["text"].translate(SUPERSCRIPTS) if raised else char["text"]
    return plain(text)


def _line(made: Page, x0: float, top: float, x1: float, bottom: float) -> None:
    if bottom - top <= THIN and x1 - x0 > bottom - top:
        made.across.append(Rule((top + bottom) / 2, x0, x1))
    elif x1 - x0 <= THIN and bottom > top:
        made.down.append(Rule((x0 + x1) / 2, top, bottom))


def _rectangle(made: Page, rect: Mapping[str, Any], x0: float, top: float, x1: float, bottom: float) -> None:
    if x1 - x0 <= THIN or bottom - top <= THIN:
        _line(made, x0, top, x1, bottom)
        return
    if rect.get("fill") and not _white(rect.get("non_stroking_color")):
        made.fills.append(Fill(x0, top, x1, bottom))
    if rect.get("stroke") and rect.get("linewidth", 1) is not None:
        for y in (top, bottom):
            made.across.append(Rule(y, x0, x1))
        for x in (x0, x1):
            made.down.append(Rule(x, top, bottom))


def _curve(made: Page, curve: Mapping[str, Any], shift: _Shift) -> None:
    """Rules drawn as paths: the straight pieces of them."""
    points = [(x - shift.x, y - shift.y) for x, y in curve.get("pts") or ()]
    for (xa, ya), (xb, yb) in itertools.pairwise(points):
        _line(made, min(xa, xb), min(ya, yb), max(xa, xb), max(ya, yb))


def _white(colour: object) -> bool:
    if colour is None:
        return False
    values = colour if isinstance(colour, (tuple, list)) else (colour,)
    if not all(isinstance(v, (int, float)) for v in values):
        return False
    return all(v <= 0.01 for v in values) if len(values) == 4 else all(v >= 0.99 for v in values)
