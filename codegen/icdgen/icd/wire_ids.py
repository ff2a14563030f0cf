"""Message ids, which an ICD gives as a number or as the bytes that are sent."""

from __future__ import annotations

from collections.abc import Sequence

DEFAULT_BITS = 8
MOST_BITS = 32
# `id_bits` of a node whose CAN frames have 11-bit ids, 29-bit ids, or both.
CAN_STANDARD, CAN_EXTENDED, CAN_BOTH = 11, 29, 32
# Marks 29-bit ids if a node has both kinds, as in DBC files and in SocketCAN
# (CAN_EFF_FLAG).
CAN_EXTENDED_FLAG = 1 << 31


def number(written: int | Sequence[int]) -> int:
    """Return an id as a number.

    In a list of bytes, the first is the most significant.
    """
    return (
        written if isinstance(written, int) else int.from_bytes(bytes(written), "big")
    )


def size(bits: int) -> int:
    """Return the number of bytes of an id of ``bits`` bits."""
    return (bits + 7) // 8


def of_can(identifier: int, is_extended: bool, bits: int) -> int | None:
    """Return the id of a CAN frame in a node whose ids have ``bits`` bits; None if the
    node has no frames of this format.

    With 32 bits, a node has frames of both formats, and bit 31 marks extended frames.
    With 11 bits, it has no extended frames. Otherwise the identifier is the id.
    """
    if bits == CAN_BOTH:
        return identifier | CAN_EXTENDED_FLAG if is_extended else identifier
    return None if bits == CAN_STANDARD and is_extended else identifier
