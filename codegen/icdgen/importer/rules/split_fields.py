"""Bits of fields in the frame, from fields as printed.

Parts of split fields are put together, and bit numbers are converted to the bit order
of the node.
"""

from __future__ import annotations

from itertools import pairwise

from icdgen.importer.rules import bit_order
from icdgen.importer.rules.bit_order import Bit, Order
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rule import TableRule


def joined_parts(
    drafts: list[FieldDraft],
    order: Order,
    is_register: bool,
    length: int,
    notes: Notes,
    rule: TableRule,
) -> list[FieldDraft]:
    """Join parts of one name with consecutive bit numbers to fields (``CB5`` to
    ``CB1``, ``D15`` to ``D0``).

    Each field gets the number of its first bit in the node's order, or an order of its
    own if it is no run of bits there.
    """
    fields: list[FieldDraft] = []
    pieces: dict[str, list[FieldDraft]] = {}
    for draft in drafts:
        if draft.part is None:
            fields.append(draft)
            continue
        # The first part keeps the place of the field in the list.
        if draft.name not in pieces:
            fields.append(draft)
        pieces.setdefault(draft.name, []).append(draft)
    for name, split in pieces.items():
        split.sort(key=lambda piece: piece.part or (0, 0))
        ends = [piece.part for piece in split if piece.part is not None]
        # Parts are sorted by their bit numbers: each must begin where the one before
        # ends.
        if any(before[1] + 1 != after[0] for before, after in pairwise(ends)):
            numbers = ", ".join(
                str(first) if first == last else f"{last}:{first}"
                for first, last in ends
            )
            notes.error(
                "IMP105",
                f"the parts {numbers} of `{name}` are not consecutive",
                split[0].spot,
                "a part is missing, or two have the same number: compare with the table",
                rule.place,
            )
            fields = [
                draft for draft in fields if draft.name != name or draft.part is None
            ]
    placed = []
    for draft in fields:
        parts = pieces[draft.name] if draft.part is not None else [draft]
        bits = [
            bit for piece in parts for bit in _bits(piece, order, is_register, length)
        ]
        if draft.count and draft.frame_bits:
            notes.error(
                "IMP105",
                f"the elements of the array `{draft.name}` have bit numbers in a range of bytes",
                draft.spot,
                "give the position of an array by its first byte only",
                rule.place,
            )
            continue
        # The order of an array's elements is that of the frame, whatever the order of
        # their bits.
        if draft.count or draft.size == 0:
            # Elements stand one after the other: their first bit is as printed.
            placed.append(draft)
            continue
        run = bit_order.run_of(bits, order)
        if run is None:
            notes.error(
                "IMP105",
                f"the bits of `{draft.name}` are not consecutive in any order",
                draft.spot,
                "state the byte order of the node, or read the parts as fields of their own",
                rule.place,
            )
            continue
        draft.at, draft.bits = run[0], len(bits)
        draft.order = run[1] if run[1] != order else None
        placed.append(draft)
    return sorted(placed, key=lambda draft: draft.at)


def _bits(piece: FieldDraft, order: Order, is_register: bool, length: int) -> list[Bit]:
    if is_register:
        return bit_order.bits_of_register(
            piece.at, piece.size, length, order.byte_order
        )
    return piece.frame_bits or bit_order.bits_of(piece.at, piece.size, order)
