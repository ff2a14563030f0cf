"""Steps of a scale in whole numbers, for all languages: physical = (raw*p + c) / q.

`steps_of_scale` returns the terms of a field. Generated code and the reference codec
compute with them, so that both get the same bits. `icdgen.describe.arithmetic` says in
which types a step is exact.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from icdgen.frozen import NamedTuple
from icdgen.icd import exact
from icdgen.icd.formula import Scale
from icdgen.icd.places import AnyScalar

EXACT_DOUBLE = 1 << 53
"""Largest number up to which every whole number is a double."""
EXACT_SINGLE = 1 << 24
"""Largest number up to which every whole number is a float of 32 bits."""


def wide_parts(value: int, bits: int) -> list[int]:
    """Return a term in 256 bits of two's complement as unsigned parts of ``bits`` bits,
    the least significant first.
    """
    # `>>` of a negative number in Python extends its sign without end, as if in two's
    # complement, so this is right for negative terms, too.
    return [value >> shift & (1 << bits) - 1 for shift in range(0, 256, bits)]


class Steps(NamedTuple):
    """Terms of physical = (raw*p + c) / q for raw values from ``raw_min`` to
    ``raw_max``; q > 0, p != 0.
    """

    p: int
    c: int
    q: int
    raw_min: int
    raw_max: int

    @property
    def terms(self) -> tuple[int, int, int]:
        """The numbers p, c and q."""
        return self[:3]

    @property
    def is_wide(self) -> bool:
        """Whether p, c or q is too large for arithmetic in 128 bits."""
        return not exact.Terms(*self.terms).are_usual

    def physical(self, raw: int) -> Fraction:
        """Return the exact physical value."""
        return Fraction(raw * self.p + self.c, self.q)

    def double(self, raw: int) -> float:
        """Return the double nearest to the physical value."""
        # Python divides whole numbers of any size with a single rounding.
        return (raw * self.p + self.c) / self.q

    @property
    def span(self) -> tuple[Fraction, Fraction]:
        """Smallest and largest physical value."""
        first, last = self.physical(self.raw_min), self.physical(self.raw_max)
        return (first, last) if first <= last else (last, first)

    @property
    def exact_in_doubles(self) -> bool:
        """Whether every step before the division is exact in doubles, so that only the
        division rounds.
        """
        return self.exact_up_to(EXACT_DOUBLE)

    def exact_up_to(self, most: int) -> bool:
        """Return whether every step before the division is a whole number of this size
        at most.
        """
        # p needs no test of its own: one of the products is at least as large.
        products = self.raw_min * self.p, self.raw_max * self.p
        return all(
            abs(n) <= most
            for n in (*products, *(n + self.c for n in products), self.c, self.q)
        )


def steps_of_scale(field: AnyScalar) -> Steps | None:
    """Return the steps of the scale of a field; None without a scale."""
    return (
        None
        if field.scale is None
        else _steps(field.scale, field.raw_min, field.raw_max)
    )


@lru_cache(maxsize=4096)
def _steps(scale: Scale, raw_min: int, raw_max: int) -> Steps:
    return Steps(*exact.terms(scale), raw_min, raw_max)
