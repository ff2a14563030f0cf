"""Fields by bit position in a frame: byte and bit order, and overlay fields for
overlapping bits.

`laid_out` gets fields with their `FrameBits`, in any order, and returns the message.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from icdgen.definitions.model import Definitions, Item
from icdgen.frozen import NamedTuple

OVERLAPPING = "IMP071"
LITTLE, BIG = "little", "big"
# In these pairs of orders the numbers of the bits of a field follow each other, also
# across bytes, so that the first bit and the width place any field.
ORDERS = {
    LITTLE: {"byte_order": "little", "bit_order": "lsb0"},
    BIG: {"byte_order": "big", "bit_order": "msb0"},
}


class FrameBits(NamedTuple):
    """Bits of a frame: position of the first bit, number of bits and order.

    `LITTLE` counts from the least significant bit of each byte, `BIG` from the most
    significant bit.
    """

    at: int
    bits: int
    order: str

    @property
    def is_within_byte(self) -> bool:
        """Return whether all bits are in one byte, so that either order can describe
        them.
        """
        return self.at // 8 == (self.at + self.bits - 1) // 8

    @property
    def mask(self) -> int:
        """Bits as an integer: bit w of byte b is bit 8 * b + w."""
        if self.order == LITTLE:
            return (1 << self.bits) - 1 << self.at
        return sum(
            1 << at // 8 * 8 + 7 - at % 8 for at in range(self.at, self.at + self.bits)
        )

    def counted(self, order: str) -> FrameBits:
        """Return these bits in another order, or unchanged if they span several bytes."""
        if order == self.order or not self.is_within_byte:
            return self
        return FrameBits(
            self.at // 8 * 8 + 8 - self.at % 8 - self.bits, self.bits, order
        )


def usual_order(places: Iterable[FrameBits]) -> str:
    """Return the order of most fields that span bytes; `LITTLE` if there is no majority
    for `BIG`.
    """
    orders = [place.order for place in places if not place.is_within_byte]
    return BIG if 2 * orders.count(BIG) > len(orders) else LITTLE


def laid_out(
    message: Item, placed: list[tuple[Item, FrameBits]], order: str, to: Definitions
) -> Item:
    """Return the message with its fields.

    Its order is ``order``, unless all fields that span bytes have the other one.
    """
    own = {place.order for _, place in placed if not place.is_within_byte}
    if len(own) == 1 and own != {order}:
        order = own.pop()
        message |= ORDERS[order]
    fields, covered = [], 0
    for field, place in _with_overlays(message["name"], placed, to):
        # Another order would reverse the elements of an array.
        place = place if "count" in field else place.counted(order)
        keys = dict(field)
        # Keep the mapping: `Enumerations.declared` sets `enum` in it later.
        field.clear()
        field |= {
            "at": place.at,
            "bits": place.bits,
            **keys,
            **(ORDERS[place.order] if place.order != order else {}),
        }
        fields.append(field)
        covered = max(covered, place.mask.bit_length())
    fields.sort(key=lambda field: field["at"])
    if (unused := message["length"] - -(-covered // 8)) > 0:
        message["reserved"] = unused
    return {**message, "fields": fields} if fields else message


def _with_overlays(
    name: str, placed: list[tuple[Item, FrameBits]], to: Definitions
) -> Iterator[tuple[Item, FrameBits]]:
    """Yield the fields, with overlapping smaller fields as overlay fields (IMP071).

    Bits that only overlay fields cover become fields. Optional fields that overlap
    others are left out.
    """
    owners: list[tuple[Item, int]] = []
    left, pairs = 0, []
    left_out: list[Item] = []
    # Larger fields first: a smaller field becomes the overlay of a larger one.
    for field, place in sorted(placed, key=lambda pair: -pair[1].bits):
        mask = place.mask
        if "view" in field:  # declared as overlay by the source
            left |= mask
            continue
        over = next(
            (
                owner
                for owner, owner_mask in owners
                if mask & owner_mask and not _are_exclusive(owner, field)
            ),
            None,
        )
        if over is None:
            owners.append((field, mask))
            continue
        if "when" in field:
            to.without_field(
                name, field["name"], f"it is optional, and overlaps `{over['name']}`"
            )
            left_out.append(field)
            continue
        pairs.append(f"`{field['name']}` and `{over['name']}`")
        field["view"] = True
        left |= mask
    if pairs:
        shown = ", ".join(pairs[:3]) + (
            f" and {len(pairs) - 3} more" if len(pairs) > 3 else ""
        )
        help = "the smaller ones are imported as overlay fields, which can be read but not set"
        to.warn(OVERLAPPING, f"message `{name}`: {shown} overlap", help)
    yield from (
        (field, place)
        for field, place in placed
        if not any(field is removed for removed in left_out)
    )
    owned = 0
    for _, mask in owners:
        owned |= mask
    # An overlay field only reads bits that another field owns.
    yield from _fields_of_bits(left & ~owned)


def _are_exclusive(field: Item, other: Item) -> bool:
    """Return whether the conditions of two fields exclude each other."""
    first, second = field.get("when", {}), other.get("when", {})
    return any(
        not set(values_of_condition(first[key])) & set(values_of_condition(second[key]))
        for key in first
        if key in second
    )


def values_of_condition(condition: object) -> list[object]:
    """Return the values of a condition, which are a single value or a list, as a list."""
    return condition if isinstance(condition, list) else [condition]


def _fields_of_bits(mask: int) -> Iterator[tuple[Item, FrameBits]]:
    """Yield a field for each run of bits, at most one byte long."""
    at = 0
    while mask >> at:
        start = at
        while mask >> at & 1 and (at == start or at % 8):
            at += 1
        if at > start:
            yield (
                {"name": f"Bits from {start}", "type": "uint"},
                FrameBits(start, at - start, LITTLE),
            )
        else:
            at += 1
