"""Ids as they are written: a number, or the bytes that are sent."""

from __future__ import annotations

from collections.abc import Sequence

DEFAULT_BITS = 8
MOST_BITS = 32


def number(written: int | Sequence[int]) -> int:
    """The id that is written so: of bytes the first is the most significant."""
    return written if isinstance(written, int) else int.from_bytes(bytes(written), "big")


def size(bits: int) -> int:
    """Bytes of an id of that many bits where it is sent as bytes."""
    return (bits + 7) // 8
