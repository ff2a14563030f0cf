"""Positions of the bits of fields within the bytes of a frame. All backends use them.

A field consists of pieces, each a run of bits of one byte: see `icdgen.icd.pieces`.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.model import Message, Node, Struct
from icdgen.icd.pieces import Piece, pieces_at
from icdgen.icd.places import NodePlace
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


class Gap(NamedTuple):
    """A run of reserved bits, from bit ``at`` of the frame on, counted in the bit order
    of the ICD node.
    """

    at: int
    bits: int


def gaps(message: Message | Struct, node: Node) -> tuple[Gap, ...]:
    """Return the runs of bits of the longest frame that no field covers, in order."""
    # One byte per bit of the frame, in the bit order of the node; 1 if no field has the
    # bit.
    free = bytearray(b"\1" * (message.length * 8))
    for field in frame_fields(message.layout, node.orders):
        if not field.has_bits:
            continue
        if field.bit_order == node.bit_order:
            free[field.at : field.at + field.bits] = bytes(field.bits)
            continue
        for piece in pieces(field, node):
            first = 8 * piece.byte + (
                piece.shift
                if node.bit_order == "lsb0"
                else 8 - piece.shift - piece.bits
            )
            free[first : first + piece.bits] = bytes(piece.bits)
    return tuple(
        Gap(run.start(), len(run.group())) for run in re.finditer(b"\1+", free)
    )
