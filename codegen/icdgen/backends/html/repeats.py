"""Arrays that a page represents by one element: repeated structs, variable-length
arrays and long arrays.

`Repeats` lists the fields that the page of a message shows, with the numbers that they
have among all scalars. Drawing, table and decoder use the same numbers.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass

from icdgen.frame_bits import reserved_bits_between
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace, places_in

_LONG = 16  # longer arrays of numbers are represented by one element


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


@dataclass(frozen=True, slots=True)
class ShownField:
    """Field that the page of a message shows: of a represented array, a field of its
    first element.
    """

    key: int  # number among all scalars of the longest frame, from 1
    place: NodePlace
    name: str  # ``satellites[].elev``
    short: str  # name within its represented array: ``elev``


class Repeats:
    """Arrays of a message, and the fields and reserved bits that its page shows."""

    def __init__(self, message: Message, node: Node) -> None:
        # In the order of the longest frame
        self.fields: list[ShownField] = []
        self.arrays: list[Repeat] = []
        # Names of the represented arrays, in the first element of their owners:
        # ``satellites[0].signals``
        self.names: set[str] = set()
        # A composite message has a section for each part instead.
        self._can_represent = not message.contains
        self._parts = {id(part.node): part for part in message.layout.counted_parts}
        self._add(places_in(message.layout), 1, "", "", False)
        self.arrays.sort(key=lambda repeat: (repeat.first, -repeat.end))
        self.gaps = reserved_bits_between(
            (field.place for field in self.fields),
            (
                range(8 * (array.first + array.step), 8 * array.end)
                for array in self.arrays
            ),
            message.length,
            node,
        )
        self._starts = sorted((shown.place.at, shown.key) for shown in self.fields)

    def keys_between(self, first: int, end: int) -> list[int]:
        """Return the numbers of the shown fields that start at the bits from ``first``
        to before ``end``, in order.
        """
        inside = slice(
            bisect_left(self._starts, (first, 0)), bisect_left(self._starts, (end, 0))
        )
        return sorted(key for _, key in self._starts[inside])

    def _add(
        self,
        places: tuple[NodePlace, ...],
        key: int,
        owner: str,
        outer: str,
        is_overlapped: bool,
    ) -> None:
        """Add the fields of the places of one layout, the first of which is ``key``.

        ``owner``: start of their labels, and ``outer`` the part of it up to the
        innermost represented array. ``is_overlapped``: other fields have bits of it.
        """
        overlapped = _overlapped(places)
        for place in places:
            shares_bits = is_overlapped or id(place) in overlapped
            is_represented = not shares_bits and self._can_be_represented(place)
            if is_represented:
                self._add_array(place, owner + place.node.name)
            elements = (place.first_element,) if is_represented else place.elements()
            # Elements that the page does not show keep their numbers: keys are the same
            # in the drawing, the table and the decoder.
            size = place.scalar_count // (place.count or 1)
            for index, element in enumerate(elements):
                text = element.steps[-1].with_index(place.node.name)
                label = owner + (f"{place.node.name}[]" if is_represented else text)
                first_key = key + index * size
                if element.struct is not None:
                    inner_owner = f"{label}."
                    self._add(
                        element.inner(),
                        first_key,
                        inner_owner,
                        inner_owner if is_represented else outer,
                        shares_bits,
                    )
                else:
                    name = label.removesuffix("[]")
                    short = name.removeprefix(outer)
                    self.fields.append(ShownField(first_key, element, name, short))
            key += place.scalar_count

    def _can_be_represented(self, place: NodePlace) -> bool:
        """Return whether one element represents a place: a repeated struct, a
        variable-length array or a long array, of whole bytes.
        """
        # Short arrays of numbers are clearer with all elements.
        is_repeated = (
            id(place.node) in self._parts
            or place.struct is not None
            or place.count > _LONG
        )
        return (
            self._can_represent
            and is_repeated
            and place.count > 1
            and place.at % 8 == place.bits % 8 == 0
        )

    def _add_array(self, place: NodePlace, label: str) -> None:
        part = self._parts.get(id(place.node))
        times = f"{part.fewest} to {part.most}" if part else str(place.count)
        self.names.add(place.name)
        self.arrays.append(
            Repeat(label, place.at // 8, place.bits // 8, place.count, times)
        )


def _overlapped(places: tuple[NodePlace, ...]) -> set[int]:
    """Return the identities of the places that have bits of others: alternatives and
    overlays. Every element of such an array is shown.
    """
    overlapped: set[int] = set()
    before: NodePlace | None = None  # the place with the largest end up to now
    for place in sorted(places, key=lambda place: place.at):
        if place.is_count or place.derived is not None:
            continue
        if before is not None and place.at < before.at + before.width:
            overlapped |= {id(before), id(place)}
        if before is None or place.at + place.width > before.at + before.width:
            before = place
    return overlapped
