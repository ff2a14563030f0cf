"""The integers of usual machines that hold raw values."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple


class Storage(NamedTuple):
    """An integer of 8, 16, 32 or 64 bits."""

    bits: int
    signed: bool = False

    @property
    def min(self) -> int:
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def max(self) -> int:
        return (1 << (self.bits - self.signed)) - 1


def holding(bits: int) -> int:
    """The smallest of 8, 16, 32 and 64 that is not below ``bits``."""
    return 8 if bits <= 8 else 16 if bits <= 16 else 32 if bits <= 32 else 64


@cache
def storage_of(bits: int, signed: bool) -> Storage:
    """The smallest integer that holds ``bits``."""
    return Storage(holding(bits), signed)
