"""Rows of a table, from its bands.

If horizontal rules separate the rows, each band is a row. Otherwise, the keys in the
key column (offsets, values or ids) separate them.
"""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import dataclass

from icdgen.importer.pages.columns import index_of
from icdgen.importer.pages.draft import HeadingRow, PrintedRow
from icdgen.importer.pages.extract import Word
from icdgen.importer.pages.lines import TextLine, lines, words_of
from icdgen.importer.words import join, unbroken

_UNIT = r"(?:(?:[Bb]its?|[Bb]ytes?|[Oo]ctets?)\s*)?"
# A number has at least one decimal digit: words such as `Add` and `Face` consist of
# hexadecimal digits, too. Marks of footnotes may follow.
_KEY = re.compile(
    _UNIT
    + rf"(?:0[xX])?[0-9A-Fa-f]*[0-9][0-9A-Fa-f]*(?:\s*(?:[-–:/~]|\.\.\.?|to)\s*{_UNIT}[0-9]+)?[⁰¹²³⁴⁵⁶⁷⁸⁹*†]*\Z"
)
KEYS = {
    "fields": ("at", "at_bytes"),
    "enumeration": ("value",),
    "list": ("id", "set_id", "get_id"),
    "loggable": ("id",),
}


@dataclass(slots=True)
class Band:
    """Part of a table between two horizontal rules.

    ``edges`` are the sides of its cells, in order.
    """

    page: int
    edges: list[float]
    words: list[Word]
    continues: tuple[bool, ...] = ()  # for each cell, whether it has no rule above it

    def of(self, lines_of_band: list[TextLine]) -> Band:
        """Return the part of the band that has these lines."""
        return Band(self.page, self.edges, words_of(lines_of_band))

    def texts(self, document_words: frozenset[str]) -> list[str]:
        """Return the texts of the cells."""
        return [
            _cell(part, edge, document_words)
            for part, edge in zip(self.parts(), self.edges[1:], strict=True)
        ]

    def printed(self, document_words: frozenset[str]) -> PrintedRow:
        """Return the row as printed on the page."""
        cells = zip(self.parts(), self.edges[1:], strict=True)
        texts = [
            "\n".join(unbroken(*_lines_of_cell(part, edge), document_words))
            for part, edge in cells
        ]
        return PrintedRow(texts, tuple(self.edges), self.continues, self.page)

    def parts(self) -> list[list[Word]]:
        """Return the words of each cell."""
        columns: list[list[Word]] = [[] for _ in self.edges[1:]]
        for word in self.words:
            columns[index_of(word.centre, self.edges)].append(word)
        return columns


def _cell(words: list[Word], right: float, document_words: frozenset[str]) -> str:
    texts, full = _lines_of_cell(words, right)
    return join(texts, document_words, full)


def _lines_of_cell(words: list[Word], right: float) -> tuple[list[str], list[bool]]:
    """Return the lines of a cell, and whether each is a single word that fills its
    line.
    """
    lines_of_cell = lines(words)
    return [line.text for line in lines_of_cell], [
        # Less room than for another short word: the word may be broken here.
        len(n.words) == 1 and n.x1 > right - 1.6 * n.size
        for n in lines_of_cell
    ]


def is_key(text: str) -> bool:
    """Return whether the text of a key column is a key: a number, a range of numbers,
    two ids.
    """
    return bool(_KEY.match(text.strip()))


def aligned_band(band: Band, edges: list[float]) -> Band:
    """Return the band with its words in the columns of the heading row.

    ``edges`` are the edges of the heading row. A cell that spans several columns is
    moved to the first one.
    """
    if len(band.edges) == len(edges):
        return band
    moved = []
    for index, part in enumerate(band.parts()):
        if not part:
            continue
        left, right = band.edges[index], band.edges[index + 1]
        overlaps = [
            max(0.0, min(right, b) - max(left, a)) for a, b in itertools.pairwise(edges)
        ]
        covered = [
            i for i, o in enumerate(overlaps) if o > 0.5 * (edges[i + 1] - edges[i])
        ]
        target = covered[0] if covered else overlaps.index(max(overlaps))
        a, b = edges[target], edges[target + 1]
        if all(a <= w.centre <= b for w in part):
            moved += part
        else:  # do not split the lines of a cell over several columns
            moved += [
                line.words[0]._replace(text=line.text, x0=a + 1, x1=b - 1)
                for line in lines(part)
            ]
    return Band(band.page, edges, moved)


def rows_of_band(
    band: Band, header: HeadingRow, document_words: frozenset[str], torn: bool = False
) -> list[PrintedRow]:
    """Return the rows of a band with the columns of ``header``.

    ``torn``: the first row may continue the last row of the previous page.
    """
    lines_of_band = lines(band.words)
    key = (
        _key_column(header)
        if header.kind in KEYS
        else _column_of_most_keys(lines_of_band, band.edges)
    )
    if header.kind == "list" and (
        groups := [
            i
            for i, line in enumerate(lines_of_band)
            if _is_group(line, band.edges, key)
        ]
    ):
        return _around(band, lines_of_band, groups, header, document_words)
    keyed = [
        i
        for i, line in enumerate(lines_of_band)
        if is_key(_text_in(line, band.edges, key))
    ]
    # A band with one key is one row, unless it may begin with the end of a row of the
    # page before.
    if len(keyed) <= (0 if torn else 1):
        return [band.printed(document_words)] if band.words else []
    printed = []
    for first, last in _stretches(lines_of_band, keyed, _leading(band), torn):
        printed.append(band.of(lines_of_band[first:last]).printed(document_words))
    return printed


def has_keys(band: Band, header: HeadingRow) -> bool:
    """Return whether a line has a key in the key column and words in another column."""
    lines_of_band = lines(band.words)
    key = (
        _key_column(header)
        if header.kind in KEYS
        else _column_of_most_keys(lines_of_band, band.edges)
    )
    for line in lines_of_band:
        columns = {index_of(w.centre, band.edges) for w in line.words}
        if len(columns) > 1 and is_key(_text_in(line, band.edges, key)):
            return True
    return False


def _key_column(header: HeadingRow) -> int:
    return next(
        (i for i, role in enumerate(header.roles) if role in KEYS[header.kind]), 0
    )


def _column_of_most_keys(lines_of_band: list[TextLine], edges: list[float]) -> int:
    """Return the column in which most lines have a key, or the first column."""
    counts = [
        sum(is_key(_text_in(line, edges, column)) for line in lines_of_band)
        for column in range(len(edges) - 1)
    ]
    return counts.index(max(counts)) if counts else 0


def _is_group(line: TextLine, edges: list[float], key: int) -> bool:
    """Return whether the line is a group heading: words other than keys in the column
    of ids.
    """
    first = [word.text for word in line.words if index_of(word.x0, edges) <= key]
    return (
        bool(first)
        and index_of(line.x0, edges) <= key
        and not any(is_key(word) for word in first)
    )


def _around(
    band: Band,
    lines_of_band: list[TextLine],
    groups: list[int],
    header: HeadingRow,
    document_words: frozenset[str],
) -> list[PrintedRow]:
    """Return the rows of a band that contains group headings."""
    printed: list[PrintedRow] = []
    start = 0
    for index in [*groups, len(lines_of_band)]:
        if start < index:
            printed += rows_of_band(
                band.of(lines_of_band[start:index]), header, document_words
            )
        if index < len(lines_of_band):
            printed.append(
                group_row(lines_of_band[index].text, len(band.edges) - 1, band.page)
            )
        start = index + 1
    return printed


def group_row(text: str, width: int, page: int) -> PrintedRow:
    """Return the row of a group heading: ``width`` cells, of which only the first has a
    text.
    """
    return PrintedRow([text, *[""] * (width - 1)], page=page)


def _text_in(line: TextLine, edges: list[float], column: int) -> str:
    return " ".join(w.text for w in line.words if index_of(w.centre, edges) == column)


def _leading(band: Band) -> float:
    """Return the smallest distance of two lines in a cell; infinite if no cell has two
    lines.
    """
    columns = [lines(part) for part in band.parts() if part]
    return min(
        (
            b.middle - a.middle
            for lines_of_column in columns
            for a, b in itertools.pairwise(lines_of_column)
        ),
        default=math.inf,
    )


def _stretches(
    lines_of_band: list[TextLine], keyed: list[int], leading: float, torn: bool
) -> list[tuple[int, int]]:
    """Return the range of lines of each row.

    Lines before the first key continue a row of the previous page.
    """
    gaps = [b.middle - a.middle for a, b in itertools.pairwise(lines_of_band)]
    starts = [_first_start(keyed, gaps, leading, torn, len(lines_of_band))]
    for before, here in itertools.pairwise(keyed):
        starts.append(_start(before, here, gaps, starts[-1]))
    ends = [*starts[1:], len(lines_of_band)]
    lead = [(0, starts[0])] if starts[0] else []
    return lead + list(zip(starts, ends, strict=True))


def _first_start(
    keyed: list[int], gaps: list[float], leading: float, torn: bool, count: int
) -> int:
    """Return the first line of the first row with a key.

    Lines above the key belong to its row if the key is vertically centred in the row.
    """
    first = keyed[0]
    if first == 0:
        return 0
    widest = max(range(first), key=lambda i: gaps[i])
    if gaps[widest] > 1.25 * leading and (widest > 0 or torn):
        return widest + 1
    after = (keyed[1] if len(keyed) > 1 else count) - first - 1
    return 0 if after >= first else first


def _start(before: int, here: int, gaps: list[float], start: int) -> int:
    """Return the first line of the row with the key at ``here``.

    The previous key is at ``before``, and its row begins at ``start``.
    """
    if here == before + 1:
        return here
    between = range(before, here)
    widest = max(between, key=lambda i: gaps[i])
    other_gaps = [gaps[i] for i in between if i != widest]
    if gaps[widest] > 1.2 * max(other_gaps):
        return widest + 1
    above = before - start  # a vertically centred key has as many lines below as above
    return min(before + above + 1, here) if above else here
