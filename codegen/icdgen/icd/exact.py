"""Integer form of a scale, with which every language computes exactly: physical =
(raw*p + c) / q.
"""

from __future__ import annotations

from math import lcm

from icdgen.frozen import NamedTuple
from icdgen.icd.formula import Scale

# Limits for arithmetic of 256 bits: with them no product with a 64-bit raw value or a
# double's significand overflows.
MAX_FACTOR = 1 << 180
MAX_OFFSET = 1 << 240

# Limits for arithmetic of 128 bits, which is faster and sufficient for nearly every
# formula.
USUAL_FACTOR = 1 << 32
USUAL_OFFSET = 1 << 63


class Terms(NamedTuple):
    """physical = (raw*p + c) / q in lowest terms; q > 0, p != 0."""

    p: int
    c: int
    q: int

    @property
    def are_usual(self) -> bool:
        """Whether arithmetic of 128 bits is sufficient."""
        return (
            abs(self.p) <= USUAL_FACTOR
            and self.q <= USUAL_FACTOR
            and abs(self.c) <= USUAL_OFFSET
        )


def terms(scale: Scale) -> Terms:
    """Return the terms of a scale over the common denominator of factor and offset."""
    factor, offset = scale
    q = lcm(factor.denominator, offset.denominator)
    return Terms(
        factor.numerator * (q // factor.denominator),
        offset.numerator * (q // offset.denominator),
        q,
    )


def is_too_large(scale: Scale) -> bool:
    """Return whether the terms exceed the range in which all languages compute exactly."""
    p, c, q = terms(scale)
    return abs(p) > MAX_FACTOR or q > MAX_FACTOR or abs(c) > MAX_OFFSET
