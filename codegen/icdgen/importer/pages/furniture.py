"""Removal of running heads and feet, which are repeated in the margins of pages.

The lines of all pages go in, because only a comparison of pages shows what is repeated.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable
from typing import Any

from icdgen.importer.pages.extract import PageContents
from icdgen.importer.pages.lines import TextLine

MARGIN = 0.12  # fraction of the height of the page, at top and bottom
_FIGURES = re.compile("[0-9]+")
_NUMBERING = re.compile(
    r"(?:page|p\.|pg\.?|seite)?\s*[-–|]?\s*([0-9]+)\s*(?:(?:of|/|von)\s*[0-9]+)?\s*[-–|]?\Z",
    re.I,
)


def without_heads_and_feet(
    pages: list[PageContents],
    lines: dict[int, list[TextLine]],
    keep: Callable[[TextLine, list[TextLine]], bool],
) -> dict[int, list[TextLine]]:
    """Return the lines of each page without heads and feet.

    ``keep`` selects lines that are never removed.
    """
    seen: dict[tuple[str, int], set[int]] = defaultdict(set)
    for page in pages:
        for line in lines[page.number]:
            if _in_margin(line, page):
                for key in _keys(line):
                    seen[key].add(page.number)
    # Left and right pages have different heads, so each is on half of the pages at
    # most.
    needed = max(2, round(0.3 * len(pages)))
    offset = _offset(pages, lines)
    by_page = {}
    for page in pages:
        content = []
        lines_of_page = lines[page.number]
        for index, line in enumerate(lines_of_page):
            repeated = (
                any(len(seen[key]) >= needed for key in _keys(line))
                if _in_margin(line, page)
                else False
            )
            near = [
                *lines_of_page[max(0, index - 1) : index],
                *lines_of_page[index + 1 : index + 2],
            ]
            if not (repeated or _numbers_the_page(line, page, offset)) or keep(
                line, near
            ):
                content.append(line)
        by_page[page.number] = content
    return by_page


def _in_margin(line: TextLine, page: PageContents) -> bool:
    return (
        line.middle < MARGIN * page.height or line.middle > (1 - MARGIN) * page.height
    )


def _keys(line: TextLine) -> list[tuple[str, int]]:
    """Return text and height of a line.

    Two roundings of the height allow a small difference.
    """
    # A running head can contain the number of its page.
    text = _FIGURES.sub("#", line.text)
    # Negative, so that the second rounding shares no key with the first.
    return [(text, int(line.middle // 4)), (text, -1 - int((line.middle + 2) // 4))]


def _numbers_the_page(line: TextLine, page: PageContents, offset: int | None) -> bool:
    if not _in_margin(line, page):
        return False
    match = _NUMBERING.match(line.text.strip())
    if match is None:
        return False
    # A bare number can also be a value of a table, so it must fit the numbers of other
    # pages.
    return not line.text.strip().isdigit() or (
        offset is not None and int(match[1]) == page.number + offset
    )


def _offset(pages: list[PageContents], lines: dict[int, list[TextLine]]) -> int | None:
    """Return the difference between printed and counted page numbers.

    Return None if the pages are not numbered with bare figures.
    """
    offsets: Counter[Any] = Counter()
    for page in pages:
        figures = {
            line.text.strip() for line in lines[page.number] if _in_margin(line, page)
        }
        # A set per page: a figure that a page prints twice counts once.
        offsets.update(
            {
                int(text) - page.number
                for text in figures
                if text.isdigit() and len(text) < 5
            }
        )
    if not offsets:
        return None
    offset, count = offsets.most_common(1)[0]
    return (
        offset
        # A single page has no others to compare with.
        if count >= max(2, len(pages) / 2) or (len(pages) == 1 and offset == 0)
        else None
    )
