"""Words of a page at places in points, for tests of the layout of pages."""

from __future__ import annotations

from icdgen.importer.pages.extract import Word
from icdgen.importer.pages.lines import TextLine

SIZE = 10.0


def word(text: str, x0: float, x1: float | None = None, top: float = 0.0) -> Word:
    """Return a word of size 10; its letters are 5 points wide unless ``x1`` is given."""
    end = x0 + 5 * len(text) if x1 is None else x1
    return Word(text, x0, top, end, top + SIZE, SIZE, "plain")


def line(*places: tuple[str, float], top: float = 0.0) -> TextLine:
    """Return a line of words, each given by its text and its left side."""
    return TextLine([word(text, x0, top=top) for text, x0 in places])
