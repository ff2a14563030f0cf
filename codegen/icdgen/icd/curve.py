"""Calibrations that are computed in doubles: polynomials in the raw value, lines in floats, and tables of points.

What each language computes is defined here to the last bit. A curve is made of pieces. A raw value belongs to the last piece
that begins at it or below, or else to the first one; its physical value is that of the piece's polynomial in what the raw value
is above the beginning, by Horner's rule: the difference, each product and each sum are rounded to a double.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from operator import itemgetter
from typing import Any, NamedTuple

from icdgen.icd import formula

MOST_BITS = 16
"""Up to this width all raw values are tried to see whether a curve leads back; wider fields are only read."""

MOST_POINTS = 1024
CLAMP, EXTRAPOLATE, REFUSE = "clamp", "extrapolate", "refuse"
OUTSIDE = (CLAMP, EXTRAPOLATE, REFUSE)

Points = tuple[tuple[float, float], ...]


class Piece(NamedTuple):
    """From raw value ``start`` on: terms[0] + t*(terms[1] + t*(...)), where t = raw - start; without terms, no number."""

    start: float
    terms: tuple[float, ...]


class Curve(NamedTuple):
    """How raw values become physical ones. Of a table also its points, and what is so outside of them."""

    pieces: tuple[Piece, ...]
    points: Points = ()
    outside: str = ""

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Of a polynomial, the constant first; of a table none."""
        return () if self.points else self.pieces[0].terms

    @property
    def plain(self) -> dict[str, Any]:
        """What says all of it, for JSON: see `of_plain`."""
        if self.points:
            return {"points": list(map(list, self.points))} | ({"outside": self.outside} if self.outside else {})
        return {"coefficients": list(self.coefficients)}

    def double(self, raw: int | float) -> float:
        """The physical value of a raw one, of a float the number; NaN is always the same."""
        x, pieces = float(raw), self.pieces
        start, terms = pieces[max(0, bisect_right(pieces, x, key=_START) - 1)] if len(pieces) > 1 else pieces[0]
        if x != x or not terms:
            return math.nan
        above, value = x - start, terms[-1]
        for term in terms[-2::-1]:
            value = value * above + term
        return value if value == value else math.nan

    def inverse(self, physical: float) -> float:
        """The number of a float field, of a line."""
        constant, slope = self.coefficients
        return (physical - constant) / slope

    def holds(self, low: int, high: int) -> bool:
        """Whether no raw value from ``low`` to ``high`` lies outside of the points."""
        return not self.points or (self.points[0][0] <= low and high <= self.points[-1][0])

    def ends(self, low: int, high: int) -> tuple[int, int]:
        """Of the raw values from ``low`` to ``high`` the ends of those that a physical value may lead back to."""
        if self.outside not in (CLAMP, REFUSE):
            return low, high
        return max(low, math.ceil(self.points[0][0])), min(high, math.floor(self.points[-1][0]))

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


_START = itemgetter(0)


def polynomial(coefficients: Sequence[float]) -> Curve:
    """The constant first."""
    return Curve((Piece(0.0, tuple(coefficients)),))


def table(points: Sequence[tuple[float, float]], outside: str) -> Curve:
    """Lines from point to point, which are (raw, physical). Where nothing is outside of them, ``outside`` is empty.

    The slope of a line is the exact one of its points, rounded once. Raises `icdgen.icd.formula.FormulaError`.
    """
    if len(points) < 2:
        raise formula.FormulaError("a table has at least two points")
    for (before, _), (raw, _) in pairwise(points):
        if not before < raw:
            one, other = (repr(number).removesuffix(".0") for number in (raw, before))
            what = f"raw value {one} occurs twice" if one == other else f"{one} follows {other}"
            raise formula.FormulaError(f"{what}: list points in the order of their raw values, each once")
    lines = [Piece(x0, (y0, _slope(x0, y0, x1, y1))) for (x0, y0), (x1, y1) in pairwise(points)]
    (first, low), (last, high) = points[0], points[-1]
    before_first: dict[str, list[Piece]] = {CLAMP: [Piece(first, (low,))], REFUSE: [Piece(first, ())]}
    behind_last = {
        CLAMP: [Piece(last, (high,))],
        REFUSE: [Piece(last, (high,)), Piece(math.nextafter(last, math.inf), ())],
    }
    end = behind_last.get(outside, [Piece(last, (high, lines[-1].terms[1]))])
    return Curve((*before_first.get(outside, []), *lines, *end), tuple(points), outside)


def of_plain(said: Mapping[str, Any]) -> Curve | None:
    """The curve that `Curve.plain` says; None without one. Raises `icdgen.icd.formula.FormulaError`."""
    if "points" in said:
        return table(doubles(said["points"]), said.get("outside", ""))
    return polynomial([float(one) for one in said["coefficients"]]) if "coefficients" in said else None


def doubles(points: Iterable[Sequence[int | float | str]]) -> Points:
    """Points as doubles. Raises `icdgen.icd.formula.FormulaError`."""
    try:
        found = tuple((float(raw) + 0.0, float(physical) + 0.0) for raw, physical in points)  # there is no -0
    except OverflowError:
        found = ((math.inf, 0.0),)
    if not all(math.isfinite(number) for point in found for number in point):
        raise formula.FormulaError("a number is too large for a double")
    return found


def _slope(x0: float, y0: float, x1: float, y1: float) -> float:
    try:
        exact = (Fraction(y1) - Fraction(y0)) / (Fraction(x1) - Fraction(x0))
        return exact.numerator / exact.denominator
    except OverflowError:
        raise formula.FormulaError(f"from raw value {x0:g} to {x1:g} it is too steep for a double") from None


def parse(text: str) -> Curve:
    """The curve of a formula. Raises `icdgen.icd.formula.FormulaError`."""
    exact = formula.coefficients(text)
    try:
        rounded = tuple(one.numerator / one.denominator for one in exact)
    except OverflowError:
        rounded = (0.0,)
    if rounded[-1] == 0.0:
        raise formula.FormulaError("a coefficient is too large or too small for a double")
    return polynomial(rounded)


def is_finite(curve: Curve, low: int, high: int) -> bool:
    """Whether no step leaves the doubles, for raw values from ``low`` to ``high``."""
    return all(
        sum(abs(Fraction(one)) * (most + abs(Fraction(start))) ** power for power, one in enumerate(terms)) < 1 << 1000
        for most in (max(abs(low), abs(high)),)
        for start, terms in curve.pieces
    )


@lru_cache(maxsize=1024)
def leads_back(curve: Curve, is_float: bool, low: int, high: int) -> bool:
    """Whether the physical values rise, or fall, from each raw value to the next; False where these are too many to try.

    In floats a line does. Outside of the points of a table nothing leads back, unless it goes on there.
    """
    if is_float:
        return len(curve.coefficients) == 2
    if high - low >= 1 << MOST_BITS:
        return False
    low, high = curve.ends(low, high)
    if low >= high:
        return False
    for step in (max(1, (high - low) // 64), 1):  # a look at few of them tells most
        values = [curve.double(raw) for raw in range(low, high + 1, step)]
        pairs = list(pairwise(values))
        if not (all(a < b for a, b in pairs) or all(a > b for a, b in pairs)):
            return False
    return True
