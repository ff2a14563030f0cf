"""Arrays that a page represents by one element: repeated structs, variable-length
arrays and long arrays.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from icdgen.icd.frames import PathStep, name_of_steps
from icdgen.icd.model import Message
from icdgen.icd.places import NodePlace, places_in, scalars_in

_LONG = 16  # longer arrays of numbers are represented by one element

_Array: TypeAlias = "tuple[tuple[int, int | None], ...]"
"""Path to an array: identity of each node, and index of the element in each enclosing
array.
"""


@dataclass(frozen=True, slots=True)
class Repeat:
    """Array that starts at byte ``first`` and has elements of ``step`` bytes.

    ``times``: number of elements, for example ``0 to 64``.
    """

    name: str  # ``satellites[].signals``
    first: int
    step: int
    count: int
    times: str

    @property
    def end(self) -> int:
        """Byte after the last element."""
        return self.first + self.step * self.count


class Repeats:
    """Arrays of a message, and the fields that its page shows."""

    def __init__(self, message: Message) -> None:
        self._repeats: dict[_Array, Repeat] = {}
        scalars = scalars_in(message.layout)
        if not message.contains:  # a composite message has a section for each part
            self._add_arrays(message, scalars)
        self.arrays = sorted(
            self._repeats.values(), key=lambda repeat: (repeat.first, -repeat.end)
        )
        firsts = [self._first(scalar.steps) for scalar in scalars]
        keys = {scalar.name: key for key, scalar in enumerate(scalars, 1)}
        # Key of the field of the first element that stands for each field, in the order
        # of the fields.
        self.leaders = [keys[name_of_steps(steps)] for steps in firsts]
        self.names = [self._label(steps).removesuffix("[]") for steps in firsts]
        # Name of the struct of the outermost array that each field is in, or of an
        # array without structs; else empty.
        self.elements = [self._element(scalar.steps) for scalar in scalars]

    def is_shown(self, key: int) -> bool:
        """Return whether the page shows the field itself."""
        return self.leaders[key - 1] == key

    def shown_parts(self, at: int, bits: int) -> list[tuple[int, int]]:
        """Return first bit and length of each part of a run of bits, without omitted
        elements.
        """
        ends = [
            8 * end
            for array in self.arrays
            for end in (array.first + array.step, array.end)
        ]
        cuts = [
            at,
            *sorted(end for end in set(ends) if at < end < at + bits),
            at + bits,
        ]
        return [
            (start, end - start)
            for start, end in pairwise(cuts)
            if not self._is_skipped(start)
        ]

    def _is_skipped(self, bit: int) -> bool:
        return any(
            8 * (array.first + array.step) <= bit < 8 * array.end
            for array in self.arrays
        )

    def short(self, key: int) -> str:
        """Return the name of a field within its array: ``elev`` of
        ``satellites[].elev``.
        """
        name = self.names[key - 1]
        return name.rpartition("[].")[2] if self.elements[key - 1] else name

    def _add_arrays(self, message: Message, scalars: tuple[NodePlace, ...]) -> None:
        """Find the arrays that are represented by one element."""
        starts = sorted(scalar.at for scalar in scalars)
        for place in _arrays(places_in(message.layout)):
            node = place.node
            variable = next(
                (part for part in message.layout.counted_parts if part.node is node),
                None,
            )
            # Short arrays of numbers are clearer with all elements.
            if place.count < 2 or not (
                variable or place.struct is not None or place.count > _LONG
            ):
                continue
            begin, end = place.at, place.at + place.width
            inside = bisect_left(starts, end) - bisect_left(starts, begin)
            # If other fields share the place (alternatives, overlays), every element is
            # shown.
            if begin % 8 == place.bits % 8 == 0 and inside == sum(
                1 for _ in place.scalars()
            ):
                times = (
                    f"{variable.fewest} to {variable.most}"
                    if variable
                    else str(place.count)
                )
                label = ".".join(
                    filter(None, (self._label(place.steps[:-1]), node.name))
                )
                self._repeats[_array(place.steps, len(place.steps) - 1)] = Repeat(
                    label, begin // 8, place.bits // 8, place.count, times
                )

    def _first(self, steps: tuple[PathStep, ...]) -> tuple[PathStep, ...]:
        """Return the corresponding place in the first element of each represented
        array.
        """
        for depth, step in enumerate(steps):
            if step.element and _array(steps, depth) in self._repeats:
                steps = (*steps[:depth], PathStep(step.node, 0), *steps[depth + 1 :])
        return steps

    def _label(self, steps: tuple[PathStep, ...]) -> str:
        """Return the label of a place: ``satellites[].elev``."""
        return ".".join(
            (
                f"{step.node.name}[]"
                if _array(steps, depth) in self._repeats
                else name_of_steps((step,))
            )
            for depth, step in enumerate(steps)
        )

    def _element(self, steps: tuple[PathStep, ...]) -> str:
        for depth in range(len(steps)):
            if _array(steps, depth) in self._repeats:
                is_struct = depth + 1 < len(steps)
                return name_of_steps(
                    steps[: depth + 1]
                    if is_struct
                    else (*steps[:depth], PathStep(steps[depth].node))
                )
        return ""


def _arrays(places: tuple[NodePlace, ...]) -> Iterator[NodePlace]:
    """Yield the arrays among places, and the arrays within their first elements."""
    for place in places:
        if place.count:
            yield place
        if place.struct is not None:
            yield from _arrays(place.elements()[0].inner())


def _array(steps: tuple[PathStep, ...], depth: int) -> _Array:
    """Return the path to the array that a step leads into."""
    return (
        *((id(step.node), step.element) for step in steps[:depth]),
        (id(steps[depth].node), None),
    )
