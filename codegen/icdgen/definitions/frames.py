"""Fields over the bits of a frame: which order of bits it has, and who owns what several read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from icdgen.definitions.model import Definitions, Item

OVERLAPPING = "IMP071"
LITTLE, BIG = "little", "big"
ORDERS = {LITTLE: {"byte_order": "little", "bit_order": "lsb0"}, BIG: {"byte_order": "big", "bit_order": "msb0"}}


class Place(NamedTuple):
    """Bits of a frame, counted from the least significant of each byte (`LITTLE`) or the most significant (`BIG`)."""

    at: int
    bits: int
    order: str

    @property
    def is_within_byte(self) -> bool:
        """Whether it can as well be counted in the other order."""
        return self.at // 8 == (self.at + self.bits - 1) // 8

    @property
    def mask(self) -> int:
        """The bits: bit w of byte b is bit 8 * b + w."""
        if self.order == LITTLE:
            return (1 << self.bits) - 1 << self.at
        return sum(1 << at // 8 * 8 + 7 - at % 8 for at in range(self.at, self.at + self.bits))

    def counted(self, order: str) -> Place:
        """The same bits, counted in the order if they can be."""
        if order == self.order or not self.is_within_byte:
            return self
        return Place(self.at // 8 * 8 + 8 - self.at % 8 - self.bits, self.bits, order)


def usual(places: Iterable[Place]) -> str:
    """The order of most that have one."""
    orders = [place.order for place in places if not place.is_within_byte]
    return BIG if 2 * orders.count(BIG) > len(orders) else LITTLE


def laid_out(message: Item, placed: list[tuple[Item, Place]], order: str, to: Definitions) -> Item:
    """The message with its fields, in the order of the node unless all that have one have another. Raises `NotHeld`."""
    own = {place.order for _, place in placed if not place.is_within_byte}
    if len(own) == 1 and own != {order}:
        order = own.pop()
        message |= ORDERS[order]
    fields, covered = [], 0
    for field, place in _owned(message["name"], placed, order, to):
        place = place if "count" in field else place.counted(order)  # which would turn the order of elements round
        said = dict(field)
        field.clear()  # the same mapping goes on: an enumeration is named in it later
        field |= {"at": place.at, "bits": place.bits, **said, **(ORDERS[place.order] if place.order != order else {})}
        fields.append(field)
        covered = max(covered, place.mask.bit_length())
    fields.sort(key=lambda field: (field["at"] // 8, field["at"]))
    if (rest := message["length"] - -(-covered // 8)) > 0:
        message["reserved"] = rest
    return {**message, "fields": fields} if fields else message


def _owned(name: str, placed: list[tuple[Item, Place]], order: str, to: Definitions) -> Iterator[tuple[Item, Place]]:
    """The fields, those that overlap larger ones as views; bits of these that nothing has by itself become fields."""
    owners: list[tuple[Item, int]] = []
    left, pairs = 0, []
    left_out: list[Item] = []
    for field, place in sorted(placed, key=lambda one: -one[1].bits):
        mask = place.mask
        if "view" in field:  # it is said to be one
            left |= mask
            continue
        over = next((one for one, other in owners if mask & other and not _exclude(one, field)), None)
        if over is None:
            owners.append((field, mask))
            continue
        if "when" in field:
            to.without_field(name, field["name"], f"it is optional, and overlaps `{over['name']}`")
            left_out.append(field)
            continue
        pairs.append(f"`{field['name']}` and `{over['name']}`")
        field["view"] = True
        left |= mask
    if pairs:
        shown = ", ".join(pairs[:3]) + (f" and {len(pairs) - 3} more" if len(pairs) > 3 else "")
        help = "the smaller ones are imported as overlay fields, which can be read but not set"
        to.warn(OVERLAPPING, f"message `{name}`: {shown} overlap", help)
    yield from ((field, place) for field, place in placed if not any(field is one for one in left_out))
    owned = 0
    for _, mask in owners:
        owned |= mask
    yield from _remaining(left & ~owned)


def _exclude(one: Item, other: Item) -> bool:
    """Whether two fields are never there together."""
    first, second = one.get("when", {}), other.get("when", {})
    return any(not set(listed(first[key])) & set(listed(second[key])) for key in first if key in second)


def listed(said: object) -> list[object]:
    """The values of a condition, which may be one."""
    return said if isinstance(said, list) else [said]


def _remaining(mask: int) -> Iterator[tuple[Item, Place]]:
    """A field for each run of bits within a byte."""
    at = 0
    while mask >> at:
        start = at
        while mask >> at & 1 and (at == start or at % 8):
            at += 1
        if at > start:
            yield {"name": f"Bits from {start}", "type": "uint"}, Place(start, at - start, LITTLE)
        else:
            at += 1
