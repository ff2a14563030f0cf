"""Ids as they are written: a number, or the bytes that are sent."""

from __future__ import annotations

from collections.abc import Sequence

DEFAULT_BITS = 8
MOST_BITS = 32
CAN_STANDARD, CAN_EXTENDED, CAN_BOTH = 11, 29, 32  # bits of ids of networks with frames of these formats
CAN_EXTENDED_FLAG = 1 << 31  # marks the id of an extended frame where there are both, as in a DBC and in SocketCAN


def number(written: int | Sequence[int]) -> int:
    """The id that is written so: of bytes the first is the most significant."""
    return written if isinstance(written, int) else int.from_bytes(bytes(written), "big")


def size(bits: int) -> int:
    """Bytes of an id of that many bits where it is sent as bytes."""
    return (bits + 7) // 8


def of_can(identifier: int, is_extended: bool, bits: int) -> int | None:
    """The id of a CAN frame in a node whose ids have so many bits; None if the node has no frames of this format.

    With 32 bits a node has frames of both formats, and bit 31 marks the extended ones. With 11 bits it has no extended
    frames. Otherwise the identifier is the id.
    """
    if bits == CAN_BOTH:
        return identifier | CAN_EXTENDED_FLAG if is_extended else identifier
    return None if bits == CAN_STANDARD and is_extended else identifier
