"""Layout of frames as entries in sequence, shared by the readers of XTCE, electronic
data sheets and Kaitai Struct.

A reader walks through its source and adds a part for each entry. This module handles
the positions of parts, variable-length parts with their counters, and constants that
conditions require. If an entry cannot be imported, the remaining bytes become one
field. The module also creates the fields of the ICD.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Definitions, Item, NotSupported, replace_keys
from icdgen.frozen import NamedTuple
from icdgen.icd.variable_length import MOST_BYTES, REST

AS_BYTES = "IMP081"
MOST_FIELDS = 5000  # of a message
_ID_BITS = (8, 16, 24, 32)


@dataclass
class FieldType:
    """Field of a type, without name and position.

    ``bits`` is 0 if the length varies.
    """

    item: Item
    bits: int
    order: str = BIG


@dataclass
class ContainerPart:
    """Entry of a container with its position ``at``, in bits from the start of the
    frame.

    ``path`` contains the names of the enclosing entries and of the entry itself.
    ``item`` has the keys of the ICD field, without name and position. ``bits`` is the
    size of all elements, or 0 if their number varies.
    """

    path: tuple[str, ...]
    item: Item
    at: int
    bits: int
    order: str = BIG
    element: int = 8  # bits of an element, if their number varies
    # Of a variable-length part, which extends to the end of the frame without one.
    counter: Counter | None = None

    @property
    def end(self) -> int:
        """Position of the first bit after the part."""
        return self.at + self.bits

    @property
    def is_message_id(self) -> bool:
        """Return whether a header can use the part as message id.

        An id is a big-endian integer of 1 to 4 bytes at bit 0, without formula.
        """
        is_placed = self.at == 0 and self.bits in _ID_BITS and self.order == BIG
        return (
            is_placed
            and self.item.get("type") in ("uint", "enum")
            and "formula" not in self.item
        )


class Counter(NamedTuple):
    """Part whose value plus ``plus`` is the number of elements, or bytes, of a
    variable-length part.
    """

    part: ContainerPart
    plus: int = 0

    @property
    def most(self) -> int:
        """Largest number that the counter can represent."""
        return (1 << self.part.bits) - 1 + self.plus


class Lost(NamedTuple):
    """First entry that cannot be imported, with the reason.

    The frame is imported as bytes from this entry on.
    """

    name: str
    why: NotSupported

    def report(
        self, message: str, to: Definitions, line: int | None = None, file: str = ""
    ) -> None:
        """Report the entry as an error of a message (IMP081)."""
        text = f"message `{message}`: from `{self.name}` on only bytes are imported: {self.why}"
        help = self.why.help or "describe the rest by hand, or simplify the definition"
        to.warn(AS_BYTES, text, help, "error", line, file)


AnyPart = TypeVar("AnyPart", bound=ContainerPart)


@dataclass(kw_only=True)
class Container(Generic[AnyPart]):
    """Parts of a container in sequence, including inherited and nested parts.

    ``at`` is the position of the next part, in bits.
    """

    parts: list[AnyPart] = field(default_factory=list)
    at: int = 0
    lost: Lost | None = None

    @property
    def is_open(self) -> bool:
        """Return whether the last part has a variable length, so that no part can
        follow.
        """
        return bool(self.parts) and not self.parts[-1].bits

    @property
    def first_variable(self) -> AnyPart | None:
        """The first part of variable length; None without one."""
        return next((part for part in self.parts if not part.bits), None)

    @property
    def length(self) -> int:
        """Bytes in front of the first part of variable length, or of the whole
        container.
        """
        first = self.first_variable
        # Rounded up to whole bytes.
        return -(-(self.at if first is None else first.at) // 8)

    def is_behind(self, part: AnyPart) -> bool:
        """Return whether a part follows a variable-length part."""
        # Both loops share this iterator: the second one begins behind the first
        # variable-length part.
        parts = iter(self.parts)
        return any(not other.bits for other in parts) and any(
            other is part for other in parts
        )

    def add(self, part: AnyPart) -> None:
        """Add a part, and move ``at`` to its end."""
        self.parts.append(part)
        self.at = part.end

    def check_size(self) -> None:
        """Raise `NotSupported` if the container exceeds the fields or bytes that an ICD
        supports.
        """
        if len(self.parts) > MOST_FIELDS or self.at > 8 * MOST_BYTES:
            raise NotSupported(
                f"it has more than {MOST_FIELDS} fields or {MOST_BYTES} bytes"
            )

    def lose(self, remainder: AnyPart, why: NotSupported, before: int) -> None:
        """Replace all but the first ``before`` parts by ``remainder``, the bytes up to
        the end of the frame.

        Raises ``why`` if ``remainder`` does not begin at a byte boundary, or if no part
        is in front of it or one has a variable length. Also raises ``why`` if
        parts were replaced before.
        """
        if (
            self.lost is not None
            or not before
            or remainder.at % 8
            or not all(part.bits for part in self.parts[:before])
        ):
            raise why
        del self.parts[before:]
        remainder.item.update(type="bytes", up_to=MOST_BYTES)
        self.parts.append(remainder)
        self.at, self.lost = remainder.at, Lost(remainder.path[-1], why)

    def missing(self, name: str) -> NotSupported:
        """Return the error for a condition on a part that the container does not
        contain.
        """
        if self.lost is None:
            return NotSupported(f"it depends on `{name}`, which it does not have")
        text = f"it depends on `{name}`, which is in or behind `{self.lost.name}`: {self.lost.why}"
        return NotSupported(text, self.lost.why.help)


def check_only_value(item: Item, raw: int, name: str) -> None:
    """Raise `NotSupported` if a field has a constant that differs from the raw value of
    a condition.
    """
    if item.get("const", raw) != raw:
        raise NotSupported(
            f"it depends on `{name}`, which is both {item['const']} and {raw}"
        )


def fixed_field(part: ContainerPart, name: str, at: int) -> Item:
    """Return the ICD field of a fixed-length part, in a big-endian message.

    ``at`` is its position in the message, in bits.
    """
    if "struct" in part.item:
        return replace_keys(part.item, {"at": at, "name": name, **part.item})
    bits = int(part.item.get("bits", part.bits))
    is_number = part.item["type"] not in ("bytes", "text")
    # Byte order has no meaning for a single byte, bytes and texts.
    order = (
        {"byte_order": LITTLE}
        if part.order == LITTLE and bits > 8 and is_number
        else {}
    )
    return replace_keys(
        part.item, {"at": at, "bits": bits, "name": name, **part.item, **order}
    )


def bits_of_counted(parts: Iterable[ContainerPart]) -> int:
    """Return the maximum number of bits of all parts with a counter.

    A part that extends to the end of the frame must leave room for them.
    """
    counted = (part for part in parts if part.counter is not None)
    return sum(int(part.item["up_to"]) * part.element for part in counted)


def in_sequence(fields: list[Item]) -> list[Item]:
    """Return fields with positions that do not depend on the length of earlier fields.

    ``fields`` are in the order of the frame. Each field behind the first
    variable-length field gets the position of that field as ``at``, and in ``after``
    the name of the field directly in front.
    """
    result: list[Item] = []
    first: Item | None = None
    for field_item in fields:
        if first is not None:
            place = {"at": first["at"], "after": result[-1]["name"]}
            without_place = {
                key: value for key, value in field_item.items() if key != "at"
            }
            field_item = replace_keys(field_item, {**place, **without_place})
        elif "up_to" in field_item:
            first = field_item
        result.append(field_item)
    return result


def variable_field(
    part: ContainerPart, name: str, at: int, names: Mapping[int, str], behind: int = 0
) -> Item:
    """Return the ICD field of a variable-length part.

    ``names`` maps the `id` of each part of the message to its name. ``behind`` is the
    number of bits of the fixed parts that follow.

    Raises `NotSupported` if the field does not begin at a byte boundary, or if its
    counter is not in the message.
    """
    if at % 8:
        raise NotSupported(f"`{name}`, whose length is not fixed, begins within a byte")
    size: object = REST
    if part.counter is not None:
        counter = names.get(id(part.counter.part))
        if counter is None:
            raise NotSupported(f"`{name}` is counted by a field of the header")
        size = (
            {"field": counter, "plus": part.counter.plus}
            if part.counter.plus
            else counter
        )
    # The largest frame leaves room for this number of elements between the other
    # fields.
    room = max(1, (8 * MOST_BYTES - at - behind) // part.element)
    key = "count" if part.item.keys() & {"bits", "struct"} else "size"
    return replace_keys(
        part.item,
        {
            "at": at,
            "name": name,
            **part.item,
            key: size,
            "up_to": min(part.item["up_to"], room),
        },
    )
