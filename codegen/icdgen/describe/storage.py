"""Integers of usual machines in which raw values are stored.

A raw value of 12 bits is stored in 16. `storage_bits` chooses the width, and `Storage`
knows the range of the type.
"""

from __future__ import annotations

from functools import cache

from icdgen.frozen import NamedTuple


class Storage(NamedTuple):
    """Integer type of 8, 16, 32 or 64 bits."""

    bits: int
    signed: bool = False

    @property
    def min(self) -> int:
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def max(self) -> int:
        return (1 << (self.bits - self.signed)) - 1


def storage_bits(bits: int) -> int:
    """Return the width of the smallest integer type of at least ``bits`` bits: 8, 16,
    32 or 64.
    """
    return next((width for width in (8, 16, 32) if bits <= width), 64)


@cache
def storage_of(bits: int, signed: bool) -> Storage:
    """Return the smallest integer type of at least ``bits`` bits."""
    return Storage(storage_bits(bits), signed)
