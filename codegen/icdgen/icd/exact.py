"""The exact integer form of a scale, in which every language computes: physical = (raw*p + c) / q."""

from __future__ import annotations

from math import lcm
from typing import NamedTuple

from icdgen.icd.formula import Scale

# What arithmetic of 256 bits holds with room to spare, for every raw value of 64 bits and twice every double's significand.
MAX_FACTOR = 1 << 180
MAX_OFFSET = 1 << 240

# The same of 128 bits, which is quicker and holds nearly every formula.
USUAL_FACTOR = 1 << 32
USUAL_OFFSET = 1 << 63


class Terms(NamedTuple):
    """physical = (raw*p + c) / q in lowest terms; q > 0, p != 0."""

    p: int
    c: int
    q: int

    @property
    def are_usual(self) -> bool:
        """Whether 128 bits are enough."""
        return abs(self.p) <= USUAL_FACTOR and self.q <= USUAL_FACTOR and abs(self.c) <= USUAL_OFFSET


def terms(scale: Scale) -> Terms:
    """The terms of a scale over its common denominator."""
    factor, offset = scale
    q = lcm(factor.denominator, offset.denominator)
    return Terms(factor.numerator * (q // factor.denominator), offset.numerator * (q // offset.denominator), q)


def is_too_large(scale: Scale) -> bool:
    """Whether the terms leave the range in which all languages compute exactly."""
    p, c, q = terms(scale)
    return abs(p) > MAX_FACTOR or q > MAX_FACTOR or abs(c) > MAX_OFFSET
