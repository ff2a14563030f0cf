"""Where the bits of a field lie in the bytes of a frame."""

from __future__ import annotations

from ._types import FieldInfo, MessageFacts


class Piece:
    """``bits`` bits of byte ``byte`` from its bit ``shift`` up are bits ``at`` and up of the value."""

    __slots__ = ("at", "bits", "byte", "shift")

    def __init__(self, byte: int, shift: int, bits: int, at: int) -> None:
        self.byte, self.shift, self.bits, self.at = byte, shift, bits, at


def byte_order(info: FieldInfo, message: type[MessageFacts]) -> str:
    """``little`` or ``big``: the field's own, or the message's."""
    return info.byte_order or message.BYTE_ORDER


def pieces(info: FieldInfo, message: type[MessageFacts]) -> list[Piece]:
    """The runs of bits of a field's number, in the order of their bytes."""
    found = []
    at, end, below = info.at, info.at + info.bits, 0
    is_little = byte_order(info, message) == "little"
    is_lsb0 = (info.bit_order or message.BIT_ORDER) == "lsb0"
    while at < end:
        byte, first = divmod(at, 8)
        bits = min(8 - first, end - at)
        shift = first if is_lsb0 else 8 - first - bits
        weight = below if is_little else info.bits - below - bits
        found.append(Piece(byte, shift, bits, weight))
        at += bits
        below += bits
    return found
