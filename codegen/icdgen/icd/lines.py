"""Lines of the ICD at their positions in a message: the field of a struct in an array
is one line, not one per element.
"""

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
    """A node on the path to a line: an array, a struct, or the field itself."""

    node: LayoutNode
    count: int  # elements; 0 if the node is not an array
    stride: int  # distance of elements in bits
    struct: Layout | None  # of a struct or an array of structs: its layout


@dataclass(frozen=True, eq=False)
class Line(NodePlace):
    """A line of the ICD, at its position in the first element of each array that
    contains it.
    """

    levels: tuple[Level, ...] = ()  # the outermost first, the field last

    @cached_property
    def name(self) -> str:
        """``Satellites[].GNSS``"""
        owners = (
            f"{level.node.name}[]" if level.count else level.node.name
            for level in self.levels[:-1]
        )
        return ".".join((*owners, self.node.name))

    @property
    def own_count(self) -> int:
        """Elements of the field itself; 0 if it is not an array.

        `count` includes the elements of all owners.
        """
        return self.levels[-1].count

    @property
    def is_of_struct(self) -> bool:
        """Whether a struct declares the field."""
        return len(self.levels) > 1

    @property
    def content(self) -> tuple[object, ...]:
        """All attributes of the line in the ICD, to compare two lines."""
        levels = tuple(
            (level.node.name, level.node.identifier, level.count, level.stride)
            for level in self.levels
        )
        return (
            self.node,
            self.at,
            self.bits,
            self.declared_orders,
            self.smallest_raw,
            levels,
        )

    def starts(self, first_only: bool = False) -> list[int]:
        """Return the first bit of each element; with `first_only` only within the first
        element of the outermost array.
        """
        starts = [self.at]
        for level in self.levels[1:] if first_only else self.levels:
            steps = (
                range(0, level.stride * level.count, level.stride)
                if level.count
                else (0,)
            )
            starts = [start + step for start in starts for step in steps]
        return starts


def lines(layout: Layout) -> tuple[Line, ...]:
    """Return the lines of a message or a struct, in the order of their declarations in
    generated code.
    """
    return tuple(line for place in places_in(layout) for line in _lines(place, ()))


def _lines(place: NodePlace, owners: tuple[Level, ...]) -> Iterator[Line]:
    """Yield the lines of a place: one, or for a struct one per field."""
    levels = (
        *owners,
        Level(place.node, place.count, place.bits if place.count else 0, place.struct),
    )
    if place.struct is not None:
        # All elements have the same lines, so take those of the first one.
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
