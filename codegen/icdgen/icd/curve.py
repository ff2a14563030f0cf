"""Formulas that are computed in doubles: polynomials in the raw value, and lines in floats.

What each language computes is defined here to the last bit: Horner's rule, every product and every sum rounded to a double.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from icdgen.icd import formula

MOST_BITS = 16
"""Up to this width all raw values are tried to see whether a polynomial leads back; wider fields are only read."""


class Curve(NamedTuple):
    """physical = coefficients[0] + raw*(coefficients[1] + raw*(...)), in doubles."""

    coefficients: tuple[float, ...]

    def double(self, raw: int | float) -> float:
        """The physical value of a raw one, of a float the number; NaN is always the same."""
        x = float(raw)
        value = self.coefficients[-1]
        for coefficient in self.coefficients[-2::-1]:
            value = value * x + coefficient
        return value if value == value else math.nan

    def inverse(self, physical: float) -> float:
        """The number of a float field, of a line."""
        return (physical - self.coefficients[0]) / self.coefficients[1]

    def nearest(self, physical: float, low: int, high: int) -> int | None:
        """The raw value from ``low`` to ``high`` whose physical one is nearest, of two the even one; None beyond both ends.

        The physical values rise or fall from each raw value to the next.
        """
        first, last = self.double(low), self.double(high)
        rises = first < last
        if not (first <= physical <= last if rises else last <= physical <= first):
            return None
        while high - low > 1:
            middle = (low + high) // 2
            value = self.double(middle)
            if value <= physical if rises else value >= physical:
                low = middle
            else:
                high = middle
        below, above = abs(physical - self.double(low)), abs(self.double(high) - physical)
        return low if below < above or (below == above and low % 2 == 0) else high


def parse(text: str) -> Curve:
    """The curve of a formula. Raises `icdgen.icd.formula.FormulaError`."""
    exact = formula.coefficients(text)
    try:
        rounded = tuple(one.numerator / one.denominator for one in exact)
    except OverflowError:
        rounded = (0.0,)
    if rounded[-1] == 0.0:
        raise formula.FormulaError("a coefficient is too large or too small for a double")
    return Curve(rounded)


parse_cached = lru_cache(maxsize=1024)(parse)


def is_finite(curve: Curve, low: int, high: int) -> bool:
    """Whether no step leaves the doubles, for raw values from ``low`` to ``high``."""
    most = max(abs(low), abs(high))
    return bool(sum(abs(Fraction(one)) * most**power for power, one in enumerate(curve.coefficients)) < 1 << 1000)


@lru_cache(maxsize=1024)
def leads_back(curve: Curve, is_float: bool, low: int, high: int) -> bool:
    """Whether the physical values rise, or fall, from each raw value to the next; False where these are too many to try.

    In floats a line does.
    """
    if is_float:
        return len(curve.coefficients) == 2
    if high - low >= 1 << MOST_BITS:
        return False
    for step in (max(1, (high - low) // 64), 1):  # a look at few of them tells most
        values = [curve.double(raw) for raw in range(low, high + 1, step)]
        pairs = list(pairwise(values))
        if not (all(a < b for a, b in pairs) or all(a > b for a, b in pairs)):
            return False
    return True
