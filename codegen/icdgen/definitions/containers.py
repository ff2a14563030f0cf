"""Containers of frames: entries in their places, as XTCE, electronic data sheets and Kaitai Struct describe them.

A reader walks its source and adds a part for each entry. This module has what the readers share: the places of parts, parts whose
length varies and what counts them, raw values that conditions fix, the entry from which on only bytes are imported, and the fields
of the ICD.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeVar

from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Definitions, Item, NotHeld, again
from icdgen.icd.variable_length import MOST_BYTES, REST

AS_BYTES = "IMP081"
MOST_FIELDS = 5000  # of a message
_ID_BITS = (8, 16, 24, 32)


@dataclass
class Piece:
    """Field that a type makes, without name and place. ``bits`` is 0 if its length varies."""

    item: Item
    bits: int
    order: str = BIG


@dataclass
class Part:
    """Entry of a container in its place. ``bits`` are those of all elements; 0 if their number varies.

    ``path`` are the names of the entries that lead to it. ``item`` has the keys of the field in the ICD, without name and place.
    """

    path: tuple[str, ...]
    item: Item
    at: int
    bits: int
    order: str = BIG
    element: int = 8  # bits of an element, if their number varies
    counter: Counter | None = None  # of a part whose length varies; without one it goes on to the end of the frame

    @property
    def end(self) -> int:
        """The bit behind the part."""
        return self.at + self.bits

    @property
    def is_message_id(self) -> bool:
        """Whether a header can have the part as the id of the message: a whole number at the beginning of the frame."""
        is_placed = self.at == 0 and self.bits in _ID_BITS and self.order == BIG
        return is_placed and self.item.get("type") in ("uint", "enum") and "formula" not in self.item


class Counter(NamedTuple):
    """Part that gives the number of elements, or bytes, of another one, which has ``plus`` more."""

    part: Part
    plus: int = 0

    @property
    def most(self) -> int:
        """The greatest number that it can give."""
        return (1 << self.part.bits) - 1 + self.plus


class Lost(NamedTuple):
    """Entry from which on only bytes are imported, and the reason."""

    name: str
    why: NotHeld

    def report(self, message: str, to: Definitions, line: int | None = None, file: str = "") -> None:
        """Report the entry as an error of a message (IMP081)."""
        text = f"message `{message}`: from `{self.name}` on only bytes are imported: {self.why}"
        help = self.why.help or "describe the rest by hand, or simplify the definition"
        to.warn(AS_BYTES, text, help, "error", line, file)


AnyPart = TypeVar("AnyPart", bound=Part)


@dataclass(kw_only=True)
class Container(Generic[AnyPart]):
    """Parts of a container one after another, those that it inherits and includes among them. The next part stands at ``at``."""

    parts: list[AnyPart] = field(default_factory=list)
    at: int = 0
    lost: Lost | None = None

    @property
    def is_open(self) -> bool:
        """Whether the length of the last part varies: nothing can stand behind it."""
        return bool(self.parts) and not self.parts[-1].bits

    def add(self, part: AnyPart) -> None:
        """Add a part; the next one stands behind it."""
        self.parts.append(part)
        self.at = part.end

    def check_size(self) -> None:
        """Raise `NotHeld` if the container has more fields or bytes than an ICD can have."""
        if len(self.parts) > MOST_FIELDS or self.at > 8 * MOST_BYTES:
            raise NotHeld(f"it has more than {MOST_FIELDS} fields or {MOST_BYTES} bytes")

    def lose(self, rest: AnyPart, why: NotHeld, before: int) -> None:
        """Replace all but the first ``before`` parts by ``rest``, the bytes up to the end of the frame.

        Raises ``why`` if it does not stand behind whole bytes of a fixed number.
        """
        if self.lost is not None or not before or rest.at % 8 or not self.parts[before - 1].bits:
            raise why
        del self.parts[before:]
        rest.item.update(type="bytes", up_to=MOST_BYTES)
        self.parts.append(rest)
        self.at, self.lost = rest.at, Lost(rest.path[-1], why)

    def missing(self, name: str) -> NotHeld:
        """Return the reason why a condition on a part cannot be imported that the container does not have."""
        if self.lost is None:
            return NotHeld(f"it depends on `{name}`, which it does not have")
        text = f"it depends on `{name}`, which is in or behind `{self.lost.name}`: {self.lost.why}"
        return NotHeld(text, self.lost.why.help)


def check_only_value(item: Item, raw: int, name: str) -> None:
    """Raise `NotHeld` if a field has another constant than the raw value that a condition asks for."""
    if item.get("const", raw) != raw:
        raise NotHeld(f"it depends on `{name}`, which is both {item['const']} and {raw}")


def fixed_field(part: Part, name: str, at: int) -> Item:
    """Return the field of a part in a message whose order is big-endian. ``at``: its bit in the message."""
    if "struct" in part.item:
        return again(part.item, {"at": at, "name": name, **part.item})
    bits = int(part.item.get("bits", part.bits))
    is_number = part.item["type"] not in ("bytes", "text")
    order = {"byte_order": LITTLE} if part.order == LITTLE and bits > 8 and is_number else {}
    return again(part.item, {"at": at, "bits": bits, "name": name, **part.item, **order})


def variable_field(part: Part, name: str, at: int, names: Mapping[int, str]) -> Item:
    """Return the field of a part whose length varies. ``names``: of the parts of the message, by `id`.

    Raises `NotHeld` if it begins within a byte, or a part counts it that is not in the message.
    """
    if at % 8:
        raise NotHeld(f"`{name}`, whose length is not fixed, begins within a byte")
    size: object = REST
    if part.counter is not None:
        counter = names.get(id(part.counter.part))
        if counter is None:
            raise NotHeld(f"`{name}` is counted by a field of the header")
        size = {"field": counter, "plus": part.counter.plus} if part.counter.plus else counter
    room = max(1, (8 * MOST_BYTES - at) // part.element)
    key = "count" if part.item.keys() & {"bits", "struct"} else "size"
    return again(part.item, {"at": at, "name": name, **part.item, key: size, "up_to": min(part.item["up_to"], room)})
