"""Headings, captions, text and pieces of tables from all pages, in reading order.

The words and ruling lines of pages go in (`extract`). The items that come out are
assembled to tables over page breaks by `tables`.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from icdgen.importer import labels
from icdgen.importer.document import PageBox
from icdgen.importer.pages import columns, furniture, gutter, headings
from icdgen.importer.pages.bands import Band, is_key
from icdgen.importer.pages.columns import Columns
from icdgen.importer.pages.extract import PageContents
from icdgen.importer.pages.lines import (
    NARROW_GAP,
    WIDE_GAP,
    TextLine,
    box_around,
    lines,
    runs,
    text_of,
)
from icdgen.importer.pages.rules import Region, joined, regions
from icdgen.importer.profile import Profile
from icdgen.importer.words import folded

_HEADING = re.compile(r"(?P<number>[0-9]+(?:\.[0-9]+)*)\.?\s+(?P<text>[A-Z].*)\Z")
_CONTINUED = re.compile(
    r"\(?\s*(?:table )?continue[ds]\b.*|.*\bcontinued (?:on|from) (?:the )?(?:next|previous) page.*",
    re.I,
)


@dataclass(slots=True)
class TablePiece:
    """Part of a table on one page.

    ``columns``: columns of the headings; None without headings.
    """

    box: PageBox
    bands: list[Band]
    ruled: bool
    columns: Columns | None = None
    # The following attributes are used without vertical rules only.
    head: list[str] = field(default_factory=list)  # lines above the headings
    lines: list[TextLine] = field(default_factory=list)  # lines of the body
    page: PageContents | None = None  # page of the body
    top: float = 0.0  # top of the body
    extent: tuple[float, float] = (0.0, 0.0)  # left and right side


@dataclass(slots=True)
class TextItem:
    """A caption, a heading or a line of text."""

    kind: str  # "caption" | "heading" | "text"
    text: str
    box: PageBox
    size: float
    number: str = ""
    strong: bool = False  # looks like a heading without a number
    # Left side and text of each run of words.
    cells: list[tuple[float, str]] = field(default_factory=list)


Item = TablePiece | TextItem


def items(pages: list[PageContents], profile: Profile) -> list[Item]:
    """Return all items of the pages in reading order."""
    ruled = {page.number: regions(page) for page in pages}
    loose = {}
    for page in pages:
        inside = ruled[page.number]
        words = [w for w in page.words if not any(r.holds(w) for r in inside)]
        loose[page.number] = lines(words)
    lines_of_page = furniture.without_heads_and_feet(
        pages, loose, lambda line, near: _is_of_a_table(line, near, profile)
    )
    in_order: list[Item] = []
    flow = _Flow(profile, itertools.chain.from_iterable(loose.values()))
    for page in pages:
        for regions_of, lines_of in gutter.columns_of_text(
            page, ruled[page.number], lines_of_page[page.number]
        ):
            in_order += flow.read_page(page, regions_of, lines_of)
    return in_order


def _is_of_a_table(line: TextLine, near: list[TextLine], profile: Profile) -> bool:
    """Return whether a line in a margin certainly belongs to a table, even if pages
    repeat it.
    """
    if profile.caption.match(line.text) or labels.begins_message_table(
        line.text, profile
    ):
        return True
    if headings.segmented(line.text.split(), profile) is not None:
        return True
    if any(
        label.what and label.value
        for label in labels.parse_labels(line.text, profile)[:1]
    ):
        return True
    # It may be one of several lines of headings, which are close together.
    parts = folded(line.text)
    tight = any(
        max(line.top - other.bottom, other.top - line.bottom) < 0.5 * line.size
        for other in near
    )
    return (
        tight and bool(parts) and all(part in profile.heading_words for part in parts)
    )


class _Flow:
    """Reader of consecutive pages, with the columns of a table that the next page may
    continue.

    ``following`` are the lines of a page from the current line up to the next ruled
    table. The methods that read an item return how many of them it takes.
    """

    def __init__(self, profile: Profile, text: Iterable[TextLine]) -> None:
        """Determine the size and style of body text from all lines ``text``."""
        self.profile = profile
        sizes: Counter[float] = Counter()
        styles: Counter[str] = Counter()
        for line in text:
            # By characters, so that short lines such as headings weigh little.
            sizes[round(line.size, 1)] += len(line.text)
            styles[line.style] += len(line.text)
        self.body_size = max(sizes, key=sizes.__getitem__, default=10.0)
        self.body_style = max(styles, key=styles.__getitem__, default="")
        # A table without vertical rules that the next page may continue: its columns,
        # type size, left and right side.
        self.open: Columns | None = None
        self.size = 0.0
        self.extent = (0.0, 0.0)

    def read_page(
        self, page: PageContents, ruled: list[Region], loose: list[TextLine]
    ) -> list[Item]:
        """Return the items of a page, from its ruled regions and all other lines."""
        items_of_page: list[Item] = []
        index = 0
        waiting = list(ruled)
        while index < len(loose) or waiting:
            if waiting and (
                index >= len(loose) or waiting[0].top <= loose[index].middle
            ):
                items_of_page.append(self.ruled_piece(page, waiting.pop(0)))
                # A ruled table is between: nothing below it continues the table above.
                self.open = None
                continue
            limit = waiting[0].top if waiting else float("inf")
            upto = index
            while upto < len(loose) and loose[upto].middle < limit:
                upto += 1
            taken, item = self.next_item(page, loose[index:upto], not items_of_page)
            index += taken
            if item is not None:
                items_of_page.append(item)
        return items_of_page

    def ruled_piece(self, page: PageContents, region: Region) -> TablePiece:
        inside = [w for w in page.words if region.holds(w)]
        cuts = region.cuts()
        bands = []
        for top, bottom in itertools.pairwise(cuts):
            # Points. No text fits between rules so close: they are one double rule.
            if bottom - top < 3:
                continue
            words = [w for w in inside if top <= w.middle < bottom]
            edges = region.separators(top, bottom)
            bands.append(Band(page.number, edges, words, region.open_above(top, edges)))
        return TablePiece(
            PageBox(page.number, region.x0, region.top, region.x1, region.bottom),
            bands,
            ruled=True,
        )

    def next_item(
        self, page: PageContents, following: list[TextLine], first: bool
    ) -> tuple[int, Item | None]:
        """Return the number of lines that belong to the item at the first line, and the
        item.
        """
        line = following[0]
        if _CONTINUED.match(line.text):
            return 1, None
        # At the top of a page, a reference such as `Table 5` in a cell that goes on
        # from the page before is no caption.
        goes_on = (
            first
            and self.open is not None
            and _begins_in_a_column(line, self.open.spans)
        )
        if self.is_caption(line) and not goes_on:
            self.open = None
            return self.read_caption(page, following)
        length, header = self.head_length(following)
        if header is not None or length:
            return self.read_table(page, following, length, header)
        if first and self.continues_table(following):
            return self.read_continuation(page, following)
        self.open = None
        kind, number, text = "text", "", line.text
        heading = _HEADING.match(line.text)
        if heading and self.stands_out(line) and len(line.text) < 120:
            kind, number, text = "heading", heading["number"], heading["text"]
        strong = (
            kind == "text"
            and self.stands_out(line)
            and len(text) < 80
            and not text.endswith((".", ":", ",", ";"))
        )
        return 1, TextItem(
            kind,
            text,
            box_around(page.number, [line]),
            line.size,
            number,
            strong,
            _cells(line),
        )

    def stands_out(self, line: TextLine) -> bool:
        return line.size > self.body_size + 0.6 or line.style != self.body_style

    def is_caption(self, line: TextLine) -> bool:
        match = self.profile.caption.match(line.text)
        # A sentence of the text can begin with `Table 5`, too.
        return match is not None and bool(
            match["mark"] or self.stands_out(line) or not match["title"]
        )

    def read_caption(
        self, page: PageContents, following: list[TextLine]
    ) -> tuple[int, TextItem]:
        """Return the number of lines of a caption, and the caption.

        Its lines have one size and style, are close together, and are not a sentence.
        """
        taken = 1
        while taken < min(3, len(following)):
            above, line = following[taken - 1], following[taken]
            if (
                line.style != above.style
                or abs(line.size - above.size) > 0.3
                or line.top - above.bottom > 0.45 * line.size
                or not self.stands_out(line)
                or self.is_caption(line)
                or self.head_length(following[taken:]) != (0, None)
            ):
                break
            taken += 1
        text = " ".join(line.text for line in following[:taken])
        cells = _cells(following[0]) if taken == 1 else []
        return taken, TextItem(
            "caption",
            text,
            box_around(page.number, following[:taken]),
            following[0].size,
            cells=cells,
        )

    def head_length(self, following: list[TextLine]) -> tuple[int, Columns | None]:
        """Return the number of lines above the headings of a table that begins here,
        and the headings.

        Return ``(0, None)`` if no table begins here.
        """
        header = columns.find_headings(following, self.profile)
        if header is not None:
            return 0, header
        first = self.lines_of_first_row(following)
        if not first:
            return 0, None
        at = _value_column(following[0])
        taken = first
        for index in range(first, min(14, len(following))):
            line = following[index]
            header = columns.find_headings(following[index:], self.profile)
            if header is not None:
                return index, header
            if self.is_caption(line) or self.lines_of_first_row(following[index:]):
                break
            label = labels.leading_meaning(line.text, self.profile)
            gap = line.top - following[index - 1].bottom
            if (
                not label
                and (line.x0 < at - 3 or gap > 1.5 * line.size)
                and not self.completes_label(following[index - 1], line)
            ):
                break
            if label == "description":
                at = _value_column(line)
            taken = index + 1
        return taken, None

    def completes_label(self, above: TextLine, line: TextLine) -> bool:
        """Return whether a line completes the label above it, in a narrow column."""
        if line.top - above.bottom > 0.5 * line.size:
            return False
        labelled = labels.parse_labels(above.text, self.profile)
        return bool(labelled) and bool(
            labels.meaning_of_label(f"{labelled[-1].label} {line.text}", self.profile)
        )

    def lines_of_first_row(self, following: list[TextLine]) -> int:
        """Return the number of lines of the first row of a message table that begins
        here, or 0.

        It has more than one line if its cells wrap.
        """
        for count in range(1, min(3, len(following)) + 1):
            if (
                count > 1
                and following[count - 1].top - following[count - 2].bottom
                > 0.6 * following[0].size
            ):
                return 0
            if labels.begins_message_table(
                columns.side_by_side(following[:count]), self.profile
            ):
                return count
        return 0

    def rows_above_headings(self, lines: list[TextLine]) -> list[str]:
        """Return the rows above the headings as text."""
        count = self.lines_of_first_row(lines) if lines else 0
        return ([columns.side_by_side(lines[:count])] if count else []) + [
            line.text for line in lines[count:]
        ]

    def read_table(
        self,
        page: PageContents,
        following: list[TextLine],
        length: int,
        header: Columns | None,
    ) -> tuple[int, TablePiece]:
        head = self.rows_above_headings(following[:length])
        if header is None:
            self.open = None
            return length, TablePiece(
                box_around(page.number, following[:length]), [], ruled=False, head=head
            )
        start = length + header.lines
        end = self.end_of_table(page, following, start, header)
        x0, x1 = (
            min(line.x0 for line in following[:start]),
            max(line.x1 for line in following[:start]),
        )
        body = self.without_row_label(following[start:end], header)
        piece = TablePiece(
            box_around(page.number, following[:end]), [], ruled=False, columns=header, head=head, lines=body, page=page,
            top=following[start - 1].bottom, extent=(x0, x1),
        )  # fmt: skip
        self.open, self.size = header, following[min(start, end - 1)].size
        self.extent = (min(x0, piece.box.x0), max(x1, piece.box.x1))
        return end, piece

    def without_row_label(
        self, body: list[TextLine], columns: Columns
    ) -> list[TextLine]:
        """Return the lines without a word left of all headings, such as ``Channels``.

        Such a word labels all rows and belongs to none.
        """
        cell_lines = []
        for line in body:
            first = runs(line, NARROW_GAP)[0]
            text = " ".join(w.text for w in first)
            if (
                first[-1].x1 <= columns.spans[0][0]
                and labels.meaning_of_label(text, self.profile) == "fields"
            ):
                if len(first) < len(line.words):
                    cell_lines.append(TextLine(line.words[len(first) :]))
            else:
                cell_lines.append(line)
        return cell_lines

    def end_of_table(
        self, page: PageContents, following: list[TextLine], start: int, header: Columns
    ) -> int:
        """Return the index of the first line after the table."""
        size = following[start].size if start < len(following) else 0
        end = next(
            (
                index
                for index in range(start, len(following))
                if self.ends_table(following, index, header, size)
            ),
            len(following),
        )
        bottom = following[-1].bottom + 8
        # Exclude the upper rule of the next table.
        if start < end < len(following) and self.is_heading_row(following, end):
            bottom = (following[end - 1].bottom + following[end].top) / 2
        limit = _lowest_rule(page, following, start, header, bottom)
        below = (
            i
            for i in range(start, end)
            if following[i].middle > limit and not self.is_row(following[i], header)
        )
        return next(below, end)

    def ends_table(
        self, following: list[TextLine], index: int, header: Columns, size: float
    ) -> bool:
        line = following[index]
        in_cell = _begins_in_a_column(line, header.spans)
        if self.is_caption(line) and not in_cell:
            return True
        if self.lines_of_first_row(following[index:]) or self.is_heading_row(
            following, index
        ):
            return True
        if abs(line.size - size) > 1.2 and not in_cell:
            return True
        if (
            _HEADING.match(line.text)
            and self.stands_out(line)
            and line.size > size + 0.6
        ):
            return True
        if self.is_prose(following[index:], header):
            return True
        gap = line.top - following[index - 1].bottom if index else 0
        return gap > 2.2 * line.size and not self.has_key(line)

    def is_heading_row(self, following: list[TextLine], index: int) -> bool:
        """Return whether the line is a heading row.

        A line at the height of the line above is a part of a cell.
        """
        line = following[index]
        if index and line.top < following[index - 1].bottom - 0.2 * line.size:
            return False
        return (
            columns.find_headings(
                following[index : index + 3], self.profile, loose=False
            )
            is not None
        )

    def is_prose(self, following: list[TextLine], header: Columns) -> bool:
        """Return whether the first line belongs to a paragraph instead of a table."""
        return (
            self.runs_across_headings(following[0], header.spans)
            and not self.has_key(following[0])
            and not self.is_group(following, header)
        )

    def has_key(self, line: TextLine) -> bool:
        first = runs(line, NARROW_GAP)[0]
        return is_key(" ".join(w.text for w in first))

    def is_row(self, line: TextLine, header: Columns) -> bool:
        """Return whether the line certainly belongs to a table.

        It has a key, continues a cell, or has several cells.
        """
        return (
            self.has_key(line)
            or _begins_in_a_column(line, header.spans)
            or len(runs(line, WIDE_GAP)) >= min(3, len(header.spans))
        )

    def is_group(self, following: list[TextLine], header: Columns) -> bool:
        """Return whether a line is a group heading of a list of any width: the next
        line has a key.
        """
        return (
            header.header.kind == "list"
            and len(following) > 1
            and self.has_key(following[1])
        )

    def runs_across_headings(
        self, line: TextLine, spans: list[tuple[float, float]]
    ) -> bool:
        """Return whether text runs across three headings or more, as in a paragraph."""
        for run in runs(line, WIDE_GAP):
            x0, x1 = run[0].x0, run[-1].x1
            if sum(
                1 for a, b in spans if min(b, x1) - max(a, x0) > 0.5 * (b - a)
            ) >= min(3, len(spans)):
                return True
        return False

    def continues_table(self, following: list[TextLine]) -> bool:
        """Return whether the lines at the top of a page continue the table before."""
        line = following[0]
        if (
            self.open is None
            or line.x0 < self.extent[0] - 8
            or self.is_prose(following, self.open)
        ):
            return False
        if _HEADING.match(line.text) and line.size > self.size + 0.6:
            return False
        return any(map(self.has_key, following[:8])) or self.is_row(line, self.open)

    def read_continuation(
        self, page: PageContents, following: list[TextLine]
    ) -> tuple[int, TablePiece]:
        assert self.open is not None
        end = max(1, self.end_of_table(page, following, 0, self.open))
        body = self.without_row_label(following[:end], self.open)
        top = following[0].top - 1
        piece = TablePiece(
            box_around(page.number, following[:end]),
            [],
            ruled=False,
            lines=body,
            page=page,
            top=top,
            extent=self.extent,
        )
        return end, piece


def _cells(line: TextLine) -> list[tuple[float, str]]:
    """Return the left side and the text of each run of words in a line."""
    return [(run[0].x0, text_of(run)) for run in runs(line, WIDE_GAP)]


def _value_column(line: TextLine) -> float:
    """Return the left side of the second run of words, which is the value next to a
    label.
    """
    runs_of_line = runs(line, NARROW_GAP)
    return runs_of_line[1][0].x0 if len(runs_of_line) > 1 else line.x0


def _begins_in_a_column(line: TextLine, spans: list[tuple[float, float]]) -> bool:
    """Return whether the line begins at a later column, and therefore continues a cell."""
    return any(abs(line.x0 - a) < 3 for a, _ in spans[2:])


def _lowest_rule(
    page: PageContents,
    following: list[TextLine],
    start: int,
    header: Columns,
    bottom: float,
) -> float:
    """Return the lowest horizontal rule of the table above ``bottom``.

    No row is below it. It is infinite if the body has no rule.
    """
    x0, x1 = header.spans[0][0], header.spans[-1][1]
    top = following[start - 1].bottom - 1 if start else 0
    wide = [
        r
        for r in joined(page.across)
        if r.start <= x0 + 12 and r.end >= x1 - 12 and r.at > top
    ]
    wide = [r for r in wide if r.at <= bottom]
    # Rules around the headings do not end the table.
    head = (
        [r for r in wide if start < len(following) and r.at < following[start].top + 2]
        if start < len(following)
        else wide
    )
    below = [r.at for r in wide if r not in head]
    return max(below) if below else float("inf")
