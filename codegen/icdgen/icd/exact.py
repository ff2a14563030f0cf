"""The exact integer form of a scale, in which every language computes: physical = (raw*p + c) / q."""

from __future__ import annotations

from math import lcm
from typing import NamedTuple

from icdgen.icd.formula import Scale

# What 128-bit arithmetic holds with room to spare, for every raw value of 64 bits.
MAX_FACTOR = 1 << 32
MAX_OFFSET = 1 << 63


class Terms(NamedTuple):
    """physical = (raw*p + c) / q in lowest terms; q > 0, p != 0."""

    p: int
    c: int
    q: int


def terms(scale: Scale) -> Terms:
    """The terms of a scale over its common denominator."""
    factor, offset = scale
    q = lcm(factor.denominator, offset.denominator)
    return Terms(factor.numerator * (q // factor.denominator), offset.numerator * (q // offset.denominator), q)


def is_too_large(scale: Scale) -> bool:
    """Whether the terms leave the range in which all languages compute exactly."""
    p, c, q = terms(scale)
    return abs(p) > MAX_FACTOR or q > MAX_FACTOR or abs(c) > MAX_OFFSET
