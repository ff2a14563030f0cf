"""Lines of text from words, and runs of closely spaced words in them.

The other modules of this package use these lines instead of single words.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from icdgen.importer.document import PageBox
from icdgen.importer.pages.extract import SMALL, Word
from icdgen.importer.words import SUPERSCRIPTS

# Gaps between runs of words, as fractions of the type size; a blank has about 0.25.
NARROW_GAP = 0.45  # between headings, whose columns are close together
WIDE_GAP = 0.9  # between cells of a body: justified text has blanks of twice the size
TOUCH = 0.12  # fraction of the type size: closer words are parts of one word


class TextLine:
    """Words of one line, from left to right."""

    __slots__ = ("words", "x0", "x1", "top", "bottom", "size", "style")

    def __init__(self, words: list[Word]) -> None:
        self.words = sorted(words, key=lambda w: w.x0)
        self.x0, self.x1 = self.words[0].x0, max(w.x1 for w in words)
        self.top, self.bottom = min(w.top for w in words), max(w.bottom for w in words)
        self.size = max(w.size for w in words)
        self.style = self.words[0].style

    @property
    def text(self) -> str:
        return text_of(self.words)

    @property
    def middle(self) -> float:
        return (self.top + self.bottom) / 2

    def __repr__(self) -> str:
        return f"Line({self.text!r} at {self.x0:.0f},{self.top:.0f})"


def lines(words: Iterable[Word]) -> list[TextLine]:
    """Return the lines from top to bottom.

    Words of a line overlap vertically by more than half the height of the lower one.
    """
    # [top, bottom, words] of the tall words first, so that raised marks find their
    # line.
    groups: list[list[Any]] = []
    for word in sorted(words, key=lambda w: (w.top, w.x0)):
        best, most = None, 0.5
        # Words come from top to bottom, so that a word belongs to one of the last
        # lines.
        for group in groups[-8:]:
            overlap = min(group[1], word.bottom) - max(group[0], word.top)
            # The lower bound avoids a division by zero for words without height.
            share = overlap / max(min(group[1] - group[0], word.bottom - word.top), 0.1)
            if share > most:
                best, most = group, share
        if best is None:
            groups.append([word.top, word.bottom, [word]])
        else:
            best[2].append(word)
            tallest = max(best[2], key=lambda w: w.size)
            best[0], best[1] = tallest.top, tallest.bottom
    return sorted(
        (TextLine(group[2]) for group in groups), key=lambda line: line.middle
    )


def text_of(words: list[Word]) -> str:
    """Return the text of the words of one line.

    Words that touch are joined. Small raised figures become superscripts.
    """
    text = ""
    last: Word | None = None
    for word in sorted(words, key=lambda w: w.x0):
        part = word.text
        if last is not None:
            near = word.x0 - last.x1 < TOUCH * max(word.size, last.size)
            raised = (
                word.size <= SMALL * last.size
                and word.bottom < last.bottom - 0.12 * last.size
            )
            text += "" if near else " "
            if raised and near:
                part = part.translate(SUPERSCRIPTS)
        text += part
        # A superscript is not the measure of the words behind it.
        last = (
            word
            if last is None or word.size > SMALL * last.size
            else last._replace(x1=word.x1)
        )
    return text


def words_of(lines_of_words: Iterable[TextLine]) -> list[Word]:
    """Return the words of several lines."""
    return [word for line in lines_of_words for word in line.words]


def box_around(page: int, things: Sequence[TextLine | PageBox]) -> PageBox:
    """Return the smallest box around objects on one page."""
    x0, top = min(thing.x0 for thing in things), min(thing.top for thing in things)
    return PageBox(
        page,
        x0,
        top,
        max(thing.x1 for thing in things),
        max(thing.bottom for thing in things),
    )


def runs(line: TextLine, gap: float = 0.6) -> list[list[Word]]:
    """Return the words of a line in runs.

    ``gap`` is the minimum distance of two runs, as a fraction of the type size.
    """
    groups = [[line.words[0]]]
    for before, word in zip(line.words, line.words[1:], strict=False):
        if word.x0 - before.x1 > gap * max(word.size, before.size):
            groups.append([word])
        else:
            groups[-1].append(word)
    return groups
