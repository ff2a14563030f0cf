"""The lines of an ICD where they stand in a message: a field of a struct once, however many elements have it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from math import prod

from icdgen.frozen import dataclass
from icdgen.icd.frames import PathStep
from icdgen.icd.layout import Layout, LayoutNode
from icdgen.icd.places import NodePlace, places_in


@dataclass(frozen=True)
class Level:
    """A node on the way to a line: an array with its elements, a struct, or the field itself."""

    node: LayoutNode
    count: int  # elements; 0 if it is no array
    stride: int  # bits from one element to the next
    struct: Layout | None  # whose fields the next level has


@dataclass(frozen=True, eq=False)
class Line(NodePlace):
    """A line at the place that it has in the first element of all arrays around it."""

    levels: tuple[Level, ...] = ()  # the outermost first, the line itself last

    @cached_property
    def name(self) -> str:
        """``Satellites[].GNSS``"""
        owners = (f"{one.node.name}[]" if one.count else one.node.name for one in self.levels[:-1])
        return ".".join((*owners, self.node.name))

    @property
    def own_count(self) -> int:
        """Elements of the array that the line itself is; 0 if it is none. `count` is over all structs around it."""
        return self.levels[-1].count

    @property
    def is_of_struct(self) -> bool:
        """Whether a struct declares it."""
        return len(self.levels) > 1

    @property
    def content(self) -> tuple[object, ...]:
        """All that the ICD says about it, for comparison."""
        around = tuple((one.node.name, one.node.identifier, one.count, one.stride) for one in self.levels)
        return self.node, self.at, self.bits, self.declared_orders, self.smallest_raw, around

    def starts(self, first_only: bool = False) -> list[int]:
        """Return the bits at which its elements begin; with `first_only` those of the outermost array's first element."""
        starts = [self.at]
        for level in self.levels[1:] if first_only else self.levels:
            steps = range(0, level.stride * level.count, level.stride) if level.count else (0,)
            starts = [start + step for start in starts for step in steps]
        return starts


def lines(layout: Layout) -> tuple[Line, ...]:
    """Return the lines of a message, or of a struct, in the order in which code declares them."""
    return tuple(line for place in places_in(layout) for line in _lines(place, ()))


def _lines(place: NodePlace, around: tuple[Level, ...]) -> Iterator[Line]:
    levels = (*around, Level(place.node, place.count, place.bits if place.count else 0, place.struct))
    if place.struct is not None:
        steps = (*place.steps[:-1], PathStep(place.node, 0 if place.count else None))
        for inner in replace(place, steps=steps, count=0).inner():
            yield from _lines(inner, levels)
        return
    counts = [level.count for level in levels if level.count]
    yield Line(
        place.steps,
        place.scalar,
        None,
        place.at,
        place.bits,
        place.declared_orders,
        prod(counts) if counts else 0,
        place.smallest_raw,
        place.is_count,
        levels,
    )
