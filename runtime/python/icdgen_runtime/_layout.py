"""Bits of a field in the bytes of a frame."""

from __future__ import annotations

from ._types import FieldInfo, MessageFacts


class Piece:
    """A part of a field within one byte.

    ``bits`` bits of byte ``byte``, from its bit ``shift`` up, are the bits of the value
    from ``at`` up.
    """

    __slots__ = ("at", "bits", "byte", "shift")

    def __init__(self, byte: int, shift: int, bits: int, at: int) -> None:
        self.byte, self.shift, self.bits, self.at = byte, shift, bits, at


def byte_order(info: FieldInfo, message: type[MessageFacts]) -> str:
    """Return ``little`` or ``big``: the byte order of the field, or else of the
    message.
    """
    return info.byte_order or message.BYTE_ORDER


def pieces(info: FieldInfo, message: type[MessageFacts]) -> list[Piece]:
    """Return the parts of a field in single bytes, in the order of the bytes."""
    result = []
    at, end, below = info.at, info.at + info.bits, 0
    is_little = byte_order(info, message) == "little"
    is_lsb0 = (info.bit_order or message.BIT_ORDER) == "lsb0"
    while at < end:
        byte, first = divmod(at, 8)
        bits = min(8 - first, end - at)
        shift = first if is_lsb0 else 8 - first - bits
        # In big-endian order, the first piece has the most significant bits.
        weight = below if is_little else info.bits - below - bits
        result.append(Piece(byte, shift, bits, weight))
        at += bits
        below += bits
    return result
