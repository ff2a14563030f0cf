"""Columns of tables without vertical rules, from the headings and the white space.

`find_headings` finds a heading row and the horizontal extent of each heading.
`boundaries` returns the edges of columns between them, which no word of the table
should cross.
"""

from __future__ import annotations

import itertools
from bisect import bisect_left, bisect_right

from icdgen.frozen import NamedTuple
from icdgen.importer.pages import headings
from icdgen.importer.pages.draft import HeadingRow
from icdgen.importer.pages.extract import Word
from icdgen.importer.pages.lines import NARROW_GAP, TextLine, lines, runs, words_of
from icdgen.importer.profile import Profile
from icdgen.importer.words import folded, join

MOST_LINES = 4  # maximum lines of a heading row


class Columns(NamedTuple):
    """A heading row: its header, the extent of each heading, and its number of lines."""

    header: HeadingRow
    spans: list[tuple[float, float]]
    lines: int


def find_headings(
    lines: list[TextLine], profile: Profile, loose: bool = True
) -> Columns | None:
    """Return the heading row that begins with the first of ``lines``, or None.

    ``loose``: also accept headings of fields without offsets.
    """
    if not lines or profile.heading_words.isdisjoint(folded(lines[0].text)):
        return None
    best: Columns | None = None
    for count in range(1, min(MOST_LINES, len(lines)) + 1):
        block = lines[:count]
        if count > 1 and block[-1].top - block[-2].bottom > 1.2 * block[-1].size:
            break
        columns = _in_one_line(block[0], profile) if count == 1 else None
        for cells in filter(None, (columns, _clustered(block))):
            header = headings.match_headings([_text(cell) for cell in cells], profile)
            if header and (
                best is None or header.known_words > best.header.known_words
            ):
                best = Columns(header, [_extent(cell) for cell in cells], count)
    # Headings without offsets need more evidence: a sentence can have the same words.
    if best is None and loose:
        for cells in filter(
            None, (_in_one_line(lines[0], profile), _clustered(lines[:1]))
        ):
            header = headings.match_headings(
                [_text(cell) for cell in cells], profile, loose=True
            )
            if header and header.kind == "fields" and _is_sure(header):
                return Columns(header, [_extent(cell) for cell in cells], 1)
    return best


def _is_sure(header: HeadingRow) -> bool:
    """Return whether headings without offsets are unlikely to be prose.

    All are known, or all but one of four or more.
    """
    unknown = len(header.roles) - header.known
    return header.titles[0][:1].isupper() and (
        unknown == 0 or (unknown == 1 and header.known >= 3)
    )


def _extent(cell: list[Word]) -> tuple[float, float]:
    """Return the left and right side of a cell."""
    return min(w.x0 for w in cell), max(w.x1 for w in cell)


def _text(cell: list[Word]) -> str:
    return join([line.text for line in lines(cell)])


def _in_one_line(line: TextLine, profile: Profile) -> list[list[Word]] | None:
    """Return the cells of a heading row in one line. Return None for any other line.

    The gaps between headings may be narrow. A line is a sentence, not a heading row, if
    no gap separates a known heading from an unknown word, as in ``Mode of Value``.
    """
    segments = headings.segmented([w.text for w in line.words], profile)
    if not segments:
        return None
    cells = [[line.words[i] for i in segment.words] for segment in segments]
    for (left, right), (before, after) in zip(
        itertools.pairwise(segments), itertools.pairwise(cells), strict=True
    ):
        is_one_run = len(runs(TextLine([before[-1], after[0]]), NARROW_GAP)) == 1
        if left.is_known != right.is_known and is_one_run:
            return None
    return cells


def _clustered(block: list[TextLine]) -> list[list[Word]]:
    """Return the cells of several lines: runs of words that are above each other."""
    cells: list[list[Word]] = []
    for run in sorted(
        (run for line in block for run in runs(line, NARROW_GAP)),
        key=lambda r: (r[0].top, r[0].x0),
    ):
        x0, x1 = run[0].x0, run[-1].x1
        for cell in cells:
            left, right = _extent(cell)
            # The left sides are not compared: the lines of a centred heading begin at
            # different places.
            if min(x1, right) - max(x0, left) > 0.3 * min(x1 - x0, right - left):
                cell.extend(run)
                break
        else:
            cells.append(list(run))
    return sorted(cells, key=lambda cell: min(w.x0 for w in cell))


def side_by_side(block: list[TextLine]) -> str:
    """Return the text of some lines cell by cell, as if no cell was wrapped."""
    if len(block) == 1:
        return block[0].text
    return " ".join(_text(cell) for cell in _clustered(block))


def boundaries(
    spans: list[tuple[float, float]], lines: list[TextLine], x0: float, x1: float
) -> list[float]:
    """Return the edges of the columns with headings at ``spans``.

    Between two headings, the edge is where it crosses the fewest words.
    """
    words = words_of(lines)
    edges = [min([x0, spans[0][0], *(w.x0 for w in words)]) - 1]
    last = max([x1, spans[-1][1], *(w.x1 for w in words)]) + 1
    # An edge lies between the centres of two headings, since the words of a column can
    # be wider than its heading.
    centres = [(a + b) / 2 for a, b in spans]
    for index, (low, high) in enumerate(itertools.pairwise(centres)):
        beyond = centres[index + 2] if index + 2 < len(centres) else last
        guess = (spans[index][1] + spans[index + 1][0]) / 2
        edges.append(
            _river(words, low, high, guess, edges[-1], beyond, spans[index + 1][0])
        )
    return [*edges, last]


def _river(
    words: list[Word],
    low: float,
    high: float,
    guess: float,
    before: float,
    beyond: float,
    heading: float,
) -> float:
    """Return the middle of the gap between two headings that the fewest words cross.

    If equally few words cross several gaps, prefer in this order: a gap that ends at
    ``heading`` (left side of the right heading), a gap with words on both sides, a gap
    wider than half the font size, a gap at whose end several words begin, and the
    widest gap.
    """
    middles = sorted(w.centre for w in words)
    begins = sorted(w.x0 for w in words)
    near = [w for w in words if w.x1 > low and w.x0 < high]
    starts, ends = sorted(w.x0 for w in near), sorted(w.x1 for w in near)
    points = sorted({low, high, *(x for x in starts + ends if low < x < high)})
    # [from, to, crossings], neighbours with the same count put together.
    pieces: list[list[float]] = []
    for a, b in itertools.pairwise(points):
        crossings = bisect_left(starts, (a + b) / 2) - bisect_right(ends, (a + b) / 2)
        if pieces and pieces[-1][2] == crossings:
            pieces[-1][1] = b
        else:
            pieces.append([a, b, crossings])
    best, key = guess, None
    for a, b, count in pieces:
        middle = (a + b) / 2
        empty = not _any_between(middles, before, middle) or not _any_between(
            middles, middle, beyond
        )
        # Words with this left side, as in a column.
        begin = bisect_left(begins, b + 1) - bisect_right(begins, b - 1)
        headed = abs(b - heading) < 1.5
        narrow = bool(words) and b - a < 0.5 * words[0].size
        this = (count, not headed, empty, narrow, -begin if begin > 2 else 0, -(b - a))
        if key is None or this < key:
            best, key = middle, this
    return best


def _any_between(values: list[float], low: float, high: float) -> bool:
    """Return whether one of the sorted values is between ``low`` and ``high``."""
    return bisect_right(values, low) < bisect_left(values, high)


def index_of(x: float, edges: list[float]) -> int:
    """Return the column of ``x``.

    Outside of the table, return the first or last column.
    """
    for index in range(1, len(edges) - 1):
        if x < edges[index]:
            return index - 1
    return len(edges) - 2
