"""Where each bit of each field lies in the bytes: the plan that all backends share.

A field is a row of pieces, each a run of bits of one byte. See 'Bits' in ``docs/reference/icd-format.md`` for the numbering.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import NamedTuple

from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.model import Message, Node, Struct
from icdgen.icd.places import NodePlace
from icdgen.icd.variants import Variant


class Piece(NamedTuple):
    """``bits`` bits of byte ``byte``, from its bit ``shift`` (0: least significant) up, are bits ``at`` and up of the value."""

    byte: int
    shift: int
    bits: int
    at: int

    @property
    def mask(self) -> int:
        """Mask of the run within its byte."""
        return ((1 << self.bits) - 1) << self.shift


@lru_cache(maxsize=65536)
def pieces_at(at: int, bits: int, byte_order: str, bit_order: str) -> tuple[Piece, ...]:
    """The pieces of a value, in the order of their bytes."""
    runs = []
    start, end = at, at + bits
    while start < end:
        byte, first = divmod(start, 8)
        count = min(8 - first, end - start)
        shift = first if bit_order == "lsb0" else 8 - first - count
        runs.append((byte, shift, count))
        start += count
    pieces, below = [], 0
    for byte, shift, count in runs if byte_order == "little" else reversed(runs):
        pieces.append(Piece(byte, shift, count, below))
        below += count
    return tuple(pieces if byte_order == "little" else reversed(pieces))


def pieces(field: FrameField | NodePlace, node: Node) -> tuple[Piece, ...]:
    """Return the pieces of a number, none of a derived one. Bytes are whole bytes in order: see `byte_range`.

    `node` is the ICD node whose orders a field has that declares none.
    """
    if field.derived:
        return ()
    return pieces_at(field.at, field.bits, field.byte_order or node.byte_order, field.bit_order or node.bit_order)


def mask(field: FrameField | NodePlace, node: Node) -> int:
    """The bits of the frame that the field has; bit w of byte b is bit 8 * b + w."""
    if field.is_bytes:
        return ((1 << field.bits) - 1) << field.at
    return sum(piece.mask << 8 * piece.byte for piece in pieces(field, node))


class Sign(NamedTuple):
    """What a byte of the frame holds, in the bits of ``mask``, where a constant is in it."""

    byte: int
    mask: int
    value: int


def signs(variant: Variant) -> tuple[Sign, ...]:
    """The bytes by which a frame of the right length is known to be the message, in their order; none without constants."""
    masks: dict[int, tuple[int, int]] = {}
    for field in variant.constants:
        for piece in pieces(field, variant.node):
            mask, value = masks.get(piece.byte, (0, 0))
            here = (field.const or 0) >> piece.at & (1 << piece.bits) - 1
            masks[piece.byte] = mask | piece.mask, value | here << piece.shift
    return tuple(Sign(byte, *found) for byte, found in sorted(masks.items()))


def byte_range(field: FrameField | NodePlace) -> range:
    """The bytes that the field touches."""
    return range(field.at // 8, (field.at + field.bits + 7) // 8)


class Gap(NamedTuple):
    """Reserved bits: ``bits`` bits from bit ``at`` of the frame, counted as the node counts them."""

    at: int
    bits: int


def gaps(message: Message | Struct, node: Node) -> tuple[Gap, ...]:
    """Bits of the frame that no field covers, in order."""
    free = bytearray(b"\1" * (message.length * 8))  # a byte for each bit, in the order in which the node counts them
    for field in frame_fields(message.layout, node.orders):
        if not field.has_bits:
            continue
        if field.bit_order == node.bit_order:
            free[field.at : field.at + field.bits] = bytes(field.bits)
            continue
        for piece in pieces(field, node):
            first = 8 * piece.byte + (piece.shift if node.bit_order == "lsb0" else 8 - piece.shift - piece.bits)
            free[first : first + piece.bits] = bytes(piece.bits)
    return tuple(Gap(run.start(), len(run.group())) for run in re.finditer(b"\1+", free))
