"""Ruled regions from ruling lines, and the bands between horizontal rules and shading.

A region is a table with vertical rules, or a part of one. Ruling lines are drawn in
pieces and with tolerances, so they are joined before regions are found.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

from icdgen.importer.pages.extract import PageContents, RulingLine, Word

SNAP = 1.8  # points: closer parallel rules count as one
REACH = 4.0  # points: rules with a smaller gap meet
# Fraction of the width of a region: a shorter horizontal rule does not separate rows.
WIDE = 0.4
ROW = 30.0  # points: maximum height of a row that interrupts rules
# Fraction of the height of a band: a shorter vertical rule does not separate cells.
TALL = 0.7


@dataclass(slots=True)
class Region:
    """Connected rules, and the rectangle around them."""

    x0: float
    top: float
    x1: float
    bottom: float
    across: list[RulingLine] = field(default_factory=list)
    down: list[RulingLine] = field(default_factory=list)

    def holds(self, word: Word) -> bool:
        """Return whether a word is inside the region."""
        return (
            self.x0 - 1 <= word.centre <= self.x1 + 1
            and self.top - 1 <= word.middle <= self.bottom + 1
        )

    def cuts(self) -> list[float]:
        """Return the heights at which rows begin and end."""
        heights = [self.top, self.bottom]
        for y, length in _lengths(self.across):
            if length >= WIDE * (self.x1 - self.x0):
                heights.append(y)
        # A vertical rule that ends within the region ends at a row with other cells.
        for rule in self.down:
            if self.x0 + 3 < rule.at < self.x1 - 3:
                heights += [rule.start, rule.end]
        return distinct([y for y in heights if self.top <= y <= self.bottom], 3.0)

    def separators(self, top: float, bottom: float) -> list[float]:
        """Return the x coordinates of vertical rules in a band, including the sides of
        the region.
        """
        height = bottom - top
        places = [self.x0, self.x1]
        for rule in self.down:
            if min(rule.end, bottom) - max(rule.start, top) >= TALL * height:
                places.append(rule.at)
        return distinct(places, 3.0)

    def open_above(self, top: float, edges: list[float]) -> tuple[bool, ...]:
        """Return for each cell whether it has no rule above it, but other cells have
        one.
        """
        # Nothing is above the region that its first row could continue.
        if top <= self.top + SNAP:
            return (False,) * (len(edges) - 1)
        here = [rule for rule in self.across if abs(rule.at - top) <= SNAP]
        covered = [
            sum(max(0.0, min(r.end, b) - max(r.start, a)) for r in here)
            for a, b in pairwise(edges)
        ]
        return tuple(
            bool(here) and length < 0.3 * (b - a)
            for length, (a, b) in zip(covered, pairwise(edges), strict=True)
        )


def distinct(values: list[float], snap: float = SNAP) -> list[float]:
    """Return the sorted values. Values closer than ``snap`` count as one."""
    separate: list[float] = []
    for value in sorted(values):
        if not separate or value - separate[-1] > snap:
            separate.append(value)
    return separate


def _lengths(rules: list[RulingLine]) -> list[tuple[float, float]]:
    """Return each height with the total length of rules at it."""
    lengths: dict[float, float] = {}
    for rule in joined(rules):
        lengths[rule.at] = lengths.get(rule.at, 0.0) + rule.end - rule.start
    return list(lengths.items())


def _joined_spans(rules: list[RulingLine]) -> list[RulingLine]:
    spans: list[RulingLine] = []
    for rule in sorted(rules, key=lambda r: r.start):
        if spans and rule.start <= spans[-1].end + SNAP:
            spans[-1] = spans[-1]._replace(end=max(spans[-1].end, rule.end))
        else:
            spans.append(rule)
    return spans


def joined(rules: list[RulingLine]) -> list[RulingLine]:
    """Return the rules, with collinear pieces that touch joined."""
    groups: list[list[RulingLine]] = []
    for rule in sorted(rules, key=lambda r: (r.at, r.start)):
        if groups and rule.at - groups[-1][0].at <= SNAP:
            groups[-1].append(rule._replace(at=groups[-1][0].at))
        else:
            groups.append([rule])
    return [rule for group in groups for rule in _joined_spans(group)]


def regions(page: PageContents) -> list[Region]:
    """Return the ruled regions of the page that have columns: a vertical rule inside."""
    across, down = joined(page.across), joined(page.down)
    parent = list(range(len(across) + len(down)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    places = [rule.at for rule in down]  # ascending: `joined` sorts
    for i, flat in enumerate(across):
        for j in range(
            bisect_left(places, flat.start - REACH),
            bisect_right(places, flat.end + REACH),
        ):
            if down[j].start - REACH <= flat.at <= down[j].end + REACH:
                parent[root(i)] = root(len(across) + j)
    _sides(down, len(across), parent, root)
    groups: dict[int, tuple[list[RulingLine], list[RulingLine]]] = {}
    for i, rule in enumerate([*across, *down]):
        # The index is a boolean: 0 for horizontal rules, 1 for vertical ones.
        groups.setdefault(root(i), ([], []))[i >= len(across)].append(rule)
    tables: list[Region] = []
    frames: list[Region] = []  # regions with a left and a right side only
    for flats, steeps in groups.values():
        if not steeps:
            continue
        xs = [r.at for r in steeps] + [x for r in flats for x in (r.start, r.end)]
        ys = [r.at for r in flats] + [y for r in steeps for y in (r.start, r.end)]
        region = Region(min(xs), min(ys), max(xs), max(ys), flats, steeps)
        if region.bottom - region.top > 6:
            has_columns = (
                len(distinct([*(r.at for r in steeps), region.x0, region.x1], 3.0)) >= 3
            )
            (tables if has_columns else frames).append(region)
    tables = _within_frames(sorted(tables, key=lambda r: (r.top, r.x0)), frames)
    return _stacked(_outermost(tables))


def _within_frames(regions: list[Region], frames: list[Region]) -> list[Region]:
    """Join regions between the same two vertical rules that are separated by rows over
    all columns.

    A frame around a page or a text does not join tables: more than one row is between
    them.
    """
    for frame in frames:
        inner = [
            region
            for region in regions
            if frame.x0 < region.x0
            and region.x1 < frame.x1
            and frame.top <= region.top < frame.bottom
        ]
        ends = [
            frame.top,
            *(y for region in inner for y in (region.top, region.bottom)),
            frame.bottom,
        ]
        columns = {
            tuple(round(x) for x in distinct([rule.at for rule in region.down]))
            for region in inner
        }
        if (
            len(inner) > 1
            and len(columns) == 1
            and all(
                0 <= b - a < ROW for a, b in zip(ends[::2], ends[1::2], strict=True)
            )
        ):
            across = [rule for region in (frame, *inner) for rule in region.across]
            down = [rule for region in (frame, *inner) for rule in region.down]
            joint = Region(frame.x0, frame.top, frame.x1, frame.bottom, across, down)
            regions = sorted(
                [*(region for region in regions if region not in inner), joint],
                key=lambda r: (r.top, r.x0),
            )
    return regions


def _stacked(regions: list[Region]) -> list[Region]:
    """Join regions that are separated only by a row over all columns.

    The rules around such a row separate only the inner columns.
    """
    stacked: list[Region] = []
    for region in regions:
        above = stacked[-1] if stacked else None
        if above is not None and _goes_on(above, region):
            stacked[-1] = Region(
                above.x0,
                above.top,
                above.x1,
                region.bottom,
                above.across + region.across,
                above.down + region.down,
            )
        else:
            stacked.append(region)
    return stacked


def _goes_on(above: Region, below: Region) -> bool:
    if not (
        -REACH < below.top - above.bottom < ROW
        and below.x0 > above.x0 + 8
        and below.x1 < above.x1 - 8
    ):
        return False
    inner = [rule.at for rule in above.down]
    return all(
        any(abs(side - at) < SNAP for at in inner) for side in (below.x0, below.x1)
    )


def _sides(
    down: list[RulingLine], first: int, parent: list[int], root: Callable[[int], int]
) -> None:
    """Join the sides of a table whose top and bottom are on other pages, and rules
    between them.
    """
    sizes = Counter(root(i) for i in range(len(parent)))
    # Vertical rules that no other rule meets.
    floating = {i for i in range(first, len(parent)) if sizes[root(i)] == 1}
    places = [rule.at for rule in down]
    # Rules by the height of their start, so that only neighbours are compared.
    near: dict[int, list[int]] = {}
    for i, side in enumerate(down, first):
        cell = int(side.start // REACH)
        for j in sorted(j for c in (cell - 1, cell, cell + 1) for j in near.get(c, ())):
            other = down[j - first]
            if (
                abs(side.start - other.start) < REACH
                and abs(side.end - other.end) < REACH
            ):
                if i in floating and j in floating:
                    low, high = sorted((side.at, other.at))
                    for k in range(
                        bisect_right(places, low), bisect_left(places, high)
                    ):
                        if (
                            down[k].start >= side.start - REACH
                            and down[k].end <= side.end + REACH
                        ):
                            parent[root(first + k)] = root(i)
                parent[root(i)] = root(j)
        near.setdefault(cell, []).append(i)


def _outermost(regions: list[Region]) -> list[Region]:
    """Return the regions that are not inside another one."""

    def is_inside(inner: Region, outer: Region) -> bool:
        """Compare with a tolerance of one point."""
        return (
            outer.x0 - 1 <= inner.x0
            and outer.x1 + 1 >= inner.x1
            and outer.top - 1 <= inner.top
            and outer.bottom + 1 >= inner.bottom
            # Of two regions that are equal within the tolerance, only the smaller one
            # is inside the other.
            and (outer.x1 - outer.x0) * (outer.bottom - outer.top)
            > (inner.x1 - inner.x0) * (inner.bottom - inner.top)
        )

    return [
        region
        for region in regions
        if not any(is_inside(region, other) for other in regions)
    ]


def row_marks(page: PageContents, x0: float, x1: float) -> list[float]:
    """Return heights with a rule, or the edge of a shaded row, over most of the width."""
    # A tall area is a background and not a row.
    shallow = [
        fill for fill in page.fills if fill.bottom - fill.top < 0.5 * page.height
    ]
    edges = [
        RulingLine(y, fill.x0, fill.x1)
        for fill in shallow
        for y in (fill.top, fill.bottom)
    ]
    heights = []
    for rules in (page.across, edges):
        inside = [
            r._replace(start=max(r.start, x0), end=min(r.end, x1))
            for r in rules
            if r.end > x0 and r.start < x1
        ]
        heights += [y for y, length in _lengths(inside) if length >= 0.7 * (x1 - x0)]
    return distinct(heights)
