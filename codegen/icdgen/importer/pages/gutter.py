"""Pages with two columns of text, which are read one after the other.

`columns_of_text` divides the words of such a page at the white gutter in the middle.
"""

from __future__ import annotations

from icdgen.importer.pages.extract import PageContents
from icdgen.importer.pages.lines import WIDE_GAP, TextLine, lines, runs, words_of
from icdgen.importer.pages.rules import Region

NARROWEST = 6.0  # minimum points of white space between the columns
FEWEST = 8  # minimum lines of text in the left column: fewer may be a column of a table
WORDS = 7  # minimum words of such a line
FULL = 0.8  # minimum width of such a line, as a fraction of the column


def columns_of_text(
    page: PageContents, regions: list[Region], lines_of_page: list[TextLine]
) -> list[tuple[list[Region], list[TextLine]]]:
    """Return the regions and lines of the page, column by column."""
    words = words_of(lines_of_page)
    middle = _middle(page, regions, lines_of_page)
    if middle is None:
        return [(regions, lines_of_page)]
    in_order = []
    for is_left in (True, False):
        inside = lines([word for word in words if (word.x1 <= middle) == is_left])
        in_order.append(
            ([region for region in regions if (region.x1 <= middle) == is_left], inside)
        )
    return in_order


def _middle(
    page: PageContents, regions: list[Region], lines_of_page: list[TextLine]
) -> float | None:
    """Return the position of the gap between two columns of text.

    Return None if the page has one column, or little text left of the gap.
    """
    spans = [(word.x0, word.x1) for word in words_of(lines_of_page)] + [
        (r.x0, r.x1) for r in regions
    ]
    low, high = 0.4 * page.width, 0.6 * page.width
    best, at = (0.0, 0.0), low
    # Only a gap that ends within the middle of the page counts.
    for x0, x1 in sorted((x0, x1) for x0, x1 in spans if x1 > low and x0 < high):
        best = max(best, (min(x0, high) - at, (min(x0, high) + at) / 2))
        at = max(at, x1)
    if best[0] < NARROWEST:
        return None
    middle = best[1]
    column = lines(word for word in words_of(lines_of_page) if word.x1 <= middle)
    right = max((line.x1 for line in column), default=0.0)
    text = [line for line in column if _is_text(line)]
    full = [
        line
        for line in text
        if line.x1 - line.x0 > FULL * (right - min(line.x0 for line in text))
    ]
    return middle if len(full) >= FEWEST else None


def _is_text(line: TextLine) -> bool:
    words = [word for word in line.words if any(c.islower() for c in word.text)]
    return len(words) >= WORDS and len(runs(line, WIDE_GAP)) == 1
