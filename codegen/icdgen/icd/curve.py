"""Calibrations that are computed in doubles: polynomials, linear formulas of floats,
and lookup tables.

This module defines the result to the last bit for all languages. A curve consists of
pieces. A raw value belongs to the last piece that begins at or below it, or else to the
first piece. The physical value is a polynomial in the difference of the raw value and
the start of the piece, by Horner's rule. The difference, each product and each sum are
rounded to a double.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from operator import itemgetter
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd import formula

# Up to this width all raw values are tried, to see whether a curve is invertible. Wider
# fields with a curve are read-only.
MOST_BITS = 16
MOST_POINTS = 1024
CLAMP, EXTRAPOLATE, REFUSE = "clamp", "extrapolate", "refuse"
OUTSIDE = (CLAMP, EXTRAPOLATE, REFUSE)

Points = tuple[tuple[float, float], ...]


class CurvePiece(NamedTuple):
    """Polynomial from raw value ``start`` on: terms[0] + t*(terms[1] + t*(...)), where
    t = raw - start.

    Without terms, the physical value is NaN.
    """

    start: float
    terms: tuple[float, ...]


class Curve(NamedTuple):
    """Conversion of raw values to physical values in doubles."""

    pieces: tuple[CurvePiece, ...]
    points: Points = ()  # of a lookup table: (raw, physical)
    # Of a lookup table: CLAMP, EXTRAPOLATE, REFUSE, or empty if no raw value is
    # outside.
    outside: str = ""

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Coefficients of a polynomial, the constant first; empty for a lookup table."""
        return () if self.points else self.pieces[0].terms

    @property
    def plain(self) -> dict[str, Any]:
        """All attributes as values for JSON; `curve_of_plain` converts them back."""
        if self.points:
            return {"points": list(map(list, self.points))} | (
                {"outside": self.outside} if self.outside else {}
            )
        return {"coefficients": list(self.coefficients)}

    def double(self, raw: int | float) -> float:
        """Return the physical value of a raw value, or of the number of a float field.

        All NaNs are `math.nan`.
        """
        x, pieces = float(raw), self.pieces
        start, terms = (
            pieces[max(0, bisect_right(pieces, x, key=_START) - 1)]
            if len(pieces) > 1
            else pieces[0]
        )
        if x != x or not terms:
            return math.nan
        # Horner's rule. Every language rounds each of these steps to a double.
        above, value = x - start, terms[-1]
        for term in terms[-2::-1]:
            value = value * above + term
        return value if value == value else math.nan

    def inverse(self, physical: float) -> float:
        """Return the number of a float field for a physical value.

        The curve is a linear polynomial.
        """
        constant, slope = self.coefficients
        return (physical - constant) / slope

    def covers(self, low: int, high: int) -> bool:
        """Return whether the points cover all raw values from ``low`` to ``high``."""
        return not self.points or (
            self.points[0][0] <= low and high <= self.points[-1][0]
        )

    def invertible_raws(self, low: int, high: int) -> tuple[int, int]:
        """Return the smallest and largest raw value from ``low`` to ``high`` that a
        physical value can be converted to.
        """
        if self.outside not in (CLAMP, REFUSE):
            return low, high
        return max(low, math.ceil(self.points[0][0])), min(
            high, math.floor(self.points[-1][0])
        )

    def nearest(self, physical: float, low: int, high: int) -> int | None:
        """Return the raw value from ``low`` to ``high`` whose physical value is
        nearest, ties to even; None beyond both ends.

        The curve must be strictly monotonic between them.
        """
        first, last = self.double(low), self.double(high)
        rises = first < last
        if not (first <= physical <= last if rises else last <= physical <= first):
            return None
        # Bisection, which is possible because the curve is monotonic.
        while high - low > 1:
            middle = (low + high) // 2
            value = self.double(middle)
            if value <= physical if rises else value >= physical:
                low = middle
            else:
                high = middle
        # Doubles, not fractions: all languages round both differences, and so agree on
        # ties.
        below = abs(physical - self.double(low))
        above = abs(self.double(high) - physical)
        return low if below < above or (below == above and low % 2 == 0) else high


_START = itemgetter(0)


def polynomial(coefficients: Sequence[float]) -> Curve:
    """Return the curve of a polynomial with these coefficients, the constant first."""
    return Curve((CurvePiece(0.0, tuple(coefficients)),))


def table(points: Sequence[tuple[float, float]], outside: str) -> Curve:
    """Return the piecewise-linear curve through points (raw, physical).

    ``outside`` is empty if no raw value is outside of the points. The slope of a piece
    is the exact slope of its points, rounded once to a double. Raises
    `icdgen.icd.formula.FormulaError`.
    """
    if len(points) < 2:
        raise formula.FormulaError("a table has at least two points")
    for (before, _), (raw, _) in pairwise(points):
        if not before < raw:
            text, text_before = (
                repr(number).removesuffix(".0") for number in (raw, before)
            )
            problem = (
                f"raw value {text} occurs twice"
                if text == text_before
                else f"{text} follows {text_before}"
            )
            raise formula.FormulaError(
                f"{problem}: list points in the order of their raw values, each once"
            )
    lines = [
        CurvePiece(x0, (y0, _slope(x0, y0, x1, y1)))
        for (x0, y0), (x1, y1) in pairwise(points)
    ]
    # The pieces outside of the points are a constant (clamp), nothing (refuse), or
    # continue the nearest line.
    # The piece in front of the points begins at the first point, as the first line
    # does: a raw value below all pieces belongs to the first piece, and at the first
    # point itself the later piece applies. The last point is valid itself, so refused
    # values begin at the next double.
    (first, low), (last, high) = points[0], points[-1]
    before_first: dict[str, list[CurvePiece]] = {
        CLAMP: [CurvePiece(first, (low,))],
        REFUSE: [CurvePiece(first, ())],
    }
    behind_last = {
        CLAMP: [CurvePiece(last, (high,))],
        REFUSE: [
            CurvePiece(last, (high,)),
            CurvePiece(math.nextafter(last, math.inf), ()),
        ],
    }
    end = behind_last.get(outside, [CurvePiece(last, (high, lines[-1].terms[1]))])
    return Curve((*before_first.get(outside, []), *lines, *end), tuple(points), outside)


def curve_of_plain(plain: Mapping[str, Any]) -> Curve | None:
    """Return the curve from the result of `Curve.plain`; None if it has no curve.

    Raises `icdgen.icd.formula.FormulaError`.
    """
    if "points" in plain:
        return table(doubles(plain["points"]), plain.get("outside", ""))
    return (
        polynomial(list(map(float, plain["coefficients"])))
        if "coefficients" in plain
        else None
    )


def doubles(points: Iterable[Sequence[int | float | str]]) -> Points:
    """Return points as doubles.

    Raises `icdgen.icd.formula.FormulaError` if a number is too large.
    """
    try:
        # Adding 0.0 converts -0.0 to 0.0.
        converted = tuple(
            (float(raw) + 0.0, float(physical) + 0.0) for raw, physical in points
        )
    except OverflowError:
        converted = ((math.inf, 0.0),)
    if not all(math.isfinite(number) for point in converted for number in point):
        raise formula.FormulaError("a number is too large for a double")
    return converted


def _slope(x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the slope of the line through two points, rounded once.

    Raises `icdgen.icd.formula.FormulaError`.
    """
    try:
        exact = (Fraction(y1) - Fraction(y0)) / (Fraction(x1) - Fraction(x0))
        return exact.numerator / exact.denominator
    except OverflowError:
        raise formula.FormulaError(
            f"from raw value {x0:g} to {x1:g} it is too steep for a double"
        ) from None


def parse(text: str) -> Curve:
    """Return the polynomial of a formula, with coefficients rounded to doubles.

    Raises `icdgen.icd.formula.FormulaError`.
    """
    exact = formula.coefficients(text)
    try:
        rounded = tuple(
            coefficient.numerator / coefficient.denominator for coefficient in exact
        )
    except OverflowError:
        # Reported below, with the coefficients that are too small. A highest
        # coefficient of 0 would change the degree of the polynomial.
        rounded = (0.0,)
    if rounded[-1] == 0.0:
        raise formula.FormulaError(
            "a coefficient is too large or too small for a double"
        )
    return polynomial(rounded)


def is_finite(curve: Curve, low: int, high: int) -> bool:
    """Return whether no intermediate result overflows a double, for raw values from
    ``low`` to ``high``.
    """
    largest = max(abs(low), abs(high))
    for start, terms in curve.pieces:
        difference = largest + abs(Fraction(start))
        bound = sum(
            abs(Fraction(term)) * difference**power for power, term in enumerate(terms)
        )
        # The sum of the absolute values bounds each step. Rounding errors are far below
        # 2^24, the margin to overflow.
        if bound >= 1 << 1000:
            return False
    return True


@lru_cache(maxsize=1024)
def has_inverse(curve: Curve, is_float: bool, low: int, high: int) -> bool:
    """Return whether a curve is strictly monotonic for the raw values from ``low`` to
    ``high``, so that it has an inverse.

    Returns False if there are more than 2^MOST_BITS raw values. Of floats only linear
    curves have an inverse. Raw values outside of the points of a lookup table are not
    counted, unless the table extrapolates.
    """
    if is_float:
        return len(curve.coefficients) == 2
    if high - low >= 1 << MOST_BITS:
        return False
    low, high = curve.invertible_raws(low, high)
    if low >= high:
        return False
    # A sample of 64 raw values is enough to reject most curves that are not monotonic.
    for step in (max(1, (high - low) // 64), 1):
        values = [curve.double(raw) for raw in range(low, high + 1, step)]
        pairs = list(pairwise(values))
        if not (all(a < b for a, b in pairs) or all(a > b for a, b in pairs)):
            return False
    return True
