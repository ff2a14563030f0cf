"""Positions of the bits of fields within the bytes of a frame. All backends use them.

A field consists of pieces, each a run of bits of one byte: see `icdgen.icd.pieces`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from icdgen.frozen import NamedTuple
from icdgen.icd.frames import FrameField
from icdgen.icd.model import Message, Node, Struct
from icdgen.icd.pieces import Piece, pieces_at
from icdgen.icd.places import NodePlace, places_in
from icdgen.icd.variants import Variant


def pieces(field: FrameField | NodePlace, node: Node) -> tuple[Piece, ...]:
    """Return the pieces of a number; an empty tuple for a derived value.

    For bytes and text see `byte_range`.

    `node` is the ICD node with the default orders.
    """
    if field.derived:
        return ()
    return pieces_at(
        field.at,
        field.bits,
        field.byte_order or node.byte_order,
        field.bit_order or node.bit_order,
    )


def mask(field: FrameField | NodePlace, node: Node) -> int:
    """Return a mask of the bits of a field in the frame; bit w of byte b is bit 8 * b +
    w.
    """
    if field.is_bytes:
        return ((1 << field.bits) - 1) << field.at
    return sum(piece.mask << 8 * piece.byte for piece in pieces(field, node))


class ConstantByte(NamedTuple):
    """A byte of the frame with bits of constants: frames of the message have ``value``
    in the bits of ``mask``.
    """

    byte: int
    mask: int
    value: int


def constant_bytes(variant: Variant) -> tuple[ConstantByte, ...]:
    """Return the bytes that identify a frame of the message among frames of the same
    length, in order.
    """
    masks: dict[int, tuple[int, int]] = {}
    for field in variant.constants:
        for piece in pieces(field, variant.node):
            mask, value = masks.get(piece.byte, (0, 0))
            bits = (field.const or 0) >> piece.at & piece.low_mask
            masks[piece.byte] = mask | piece.mask, value | bits << piece.shift
    return tuple(
        ConstantByte(byte, mask, value) for byte, (mask, value) in sorted(masks.items())
    )


def byte_range(field: FrameField | NodePlace) -> range:
    """Return the indices of the bytes with bits of a field."""
    return range(field.at // 8, (field.at + field.bits + 7) // 8)


class ReservedBits(NamedTuple):
    """A run of reserved bits, from bit ``at`` of the frame on, counted in the bit order
    of the ICD node.
    """

    at: int
    bits: int


def reserved_bits(message: Message | Struct, node: Node) -> tuple[ReservedBits, ...]:
    """Return the runs of reserved bits, in the order of the frame.

    In an array of structs, only the first element is considered.
    """
    fields: list[NodePlace] = []
    omitted: list[range] = []
    places = list(places_in(message.layout))
    # The loop appends the fields of structs to the list that it visits.
    for place in places:
        if place.struct is None:
            fields.append(place)
        else:
            first = place.first_element
            omitted.append(range(first.at + first.bits, place.at + place.width))
            places += first.inner()
    return reserved_bits_between(fields, omitted, message.length, node)


def reserved_bits_between(
    fields: Iterable[FrameField | NodePlace],
    omitted: Iterable[range],
    length: int,
    node: Node,
) -> tuple[ReservedBits, ...]:
    """Return the runs of bits of a frame of `length` bytes that are neither in a field
    nor in an omitted range, in order.
    """
    # One byte per bit of the frame, in the bit order of the node; 1 if no field has the
    # bit.
    free = bytearray(b"\1" * (8 * length))
    for bits in omitted:
        free[bits.start : bits.stop] = bytes(len(bits))
    for field in fields:
        if field.role != "field":
            continue
        end = field.at + field.width
        # Whole bytes are the same bits in either bit order.
        if field.bit_order in ("", node.bit_order) or field.at % 8 == end % 8 == 0:
            free[field.at : end] = bytes(field.width)
            continue
        for at in range(field.at, end, field.bits):
            # The byte order has no effect here. It changes the significance of the bits
            # of a value, but not their positions.
            for piece in pieces_at(at, field.bits, "little", field.bit_order):
                first = 8 * piece.byte + (
                    piece.shift
                    if node.bit_order == "lsb0"
                    else 8 - piece.shift - piece.bits
                )
                free[first : first + piece.bits] = bytes(piece.bits)
    return tuple(
        ReservedBits(run.start(), len(run.group())) for run in re.finditer(b"\1+", free)
    )
