"""Values for people, for all outputs: in the display format of a field, or with the
digits that its resolution justifies.

A value whose decimal ends soon is shown in full. Others, such as values of polynomials,
are rounded: their further digits come from the arithmetic in doubles. JSON and logs
have the full precision, whatever the display format is.
"""

from __future__ import annotations

import math
from decimal import ROUND_HALF_UP, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache

from icdgen.describe.numbers import exact_text
from icdgen.frozen import NamedTuple
from icdgen.icd.curve import Curve
from icdgen.icd.display import BINARY, DECIMALS, HEX, OF_BITS
from icdgen.icd.formula import Scale
from icdgen.icd.frames import FrameField
from icdgen.icd.places import AnyScalar, NodePlace

_MOST_EXACT = 6
"""Decimals of a factor up to which values are shown in full, however fine the
resolution is.
"""
_MOST_DECIMALS = 20
_DIGITS = {32: 8, 64: 15}  # significant digits of a number computed from a float
_SAMPLES = 64
"""Number of raw values at which the slope of a calibration is sampled."""
_STEEP = 100
"""Ratio of the mean to the smallest resolution that counts: near an extremum the
resolution approaches 0.
"""
_LARGE = 1e15
_PRECISION = 800
"""Enough digits for the exact decimal of any double, which has up to 767."""


class Digits(NamedTuple):
    """Rounding of a number: to ``decimals`` after the point, or to ``significant``
    digits.
    """

    decimals: int | None = None
    significant: int | None = None
    is_fixed: bool = False  # whether trailing zeros are shown


class BitNotation(NamedTuple):
    """Notation of a raw value that is displayed as a bit pattern, such as ``0x`` and 4
    digits of base 16.
    """

    prefix: str
    base: int
    width: int


def base_of(field: AnyScalar) -> BitNotation | None:
    """Return how the raw values of a field are written if the ICD displays them in
    hexadecimal or binary; else None.
    """
    kind = field.display.kind if field.display else ""
    if kind == HEX:
        return BitNotation("0x", 16, -(-field.bits // 4))
    return BitNotation("0b", 2, field.bits) if kind == BINARY else None


def integer_text(field: AnyScalar, raw: int) -> str:
    """Return the raw value of an integer field: ``18``, or ``0x12`` in its display
    format.
    """
    base = base_of(field)
    if base is None:
        return str(raw)
    return f"{base.prefix}{raw:0{base.width}{'X' if base.base == 16 else 'b'}}"


def digits_of(field: FrameField | NodePlace) -> Digits | None:
    """Return how physical values of a field are rounded; None if they are shown in
    full.
    """
    if field.display is not None and field.display.kind not in OF_BITS:
        places = field.display.places
        return (
            Digits(decimals=places, is_fixed=True)
            if field.display.kind == DECIMALS
            else Digits(significant=places)
        )
    if field.type == "float":
        computed = field.curve is not None or field.derived is not None
        return Digits(significant=_DIGITS[field.bits]) if computed else None
    if field.curve is not None:
        return _by_resolution(_resolution(field.curve, field.raw_min, field.raw_max))
    return None if field.scale is None else _of_scale(field.scale)


@lru_cache(maxsize=1024)
def _of_scale(scale: Scale) -> Digits | None:
    rounded = _by_resolution(abs(scale.factor))
    exact = max(_decimals(scale.factor), _decimals(scale.offset))
    return None if exact <= max(_MOST_EXACT, (rounded.decimals or 0) + 1) else rounded


def number_text(field: FrameField | NodePlace, value: float | Fraction) -> str:
    """Return a physical value of a field as text: ``21.35``."""
    digits = digits_of(field)
    if digits is None:
        return exact_text(value) if isinstance(value, Fraction) else _plain(repr(value))
    number = float(value)
    if not math.isfinite(number):
        return repr(number)
    with localcontext() as context:
        # Rounding half up of the exact binary value is what `toFixed` and `toPrecision`
        # of JavaScript do.
        context.prec, context.rounding = _PRECISION, ROUND_HALF_UP
        exact = Decimal(number)
        # A double has no further digits.
        if digits.decimals is not None and abs(number) >= _LARGE:
            return _plain(repr(number))
        if digits.decimals is not None:
            text = f"{exact.quantize(Decimal(1).scaleb(-digits.decimals)):f}"
            if not digits.is_fixed and "." in text:
                text = text.rstrip("0").rstrip(".")
            # A small negative number must not become `-0.00`.
            return text if text.strip("-0.") else text.removeprefix("-")
        context.prec = digits.significant or 1
        # Unary plus rounds to the precision of the context.
        return _plain(repr(float(+exact)))


def _plain(text: str) -> str:
    return text.removesuffix(".0")


def _by_resolution(step: float | Fraction) -> Digits:
    """Return the fewest decimals from which the raw value can be recovered: a rounding
    error below half a step.
    """
    decimals = 0
    while decimals < _MOST_DECIMALS and Fraction(1, 10**decimals) * 2 > Fraction(step):
        decimals += 1
    return Digits(decimals)


def _decimals(value: Fraction) -> int:
    """Return the number of decimals of a fraction; more than can be shown if they do
    not end.
    """
    return next(
        (n for n in range(_MOST_DECIMALS + 1) if 10**n % value.denominator == 0),
        _MOST_DECIMALS + 1,
    )


@lru_cache(maxsize=1024)
def _resolution(curve: Curve, low: int, high: int) -> float:
    """Return the smallest difference between physical values of neighbouring raw values
    of a calibrated integer.

    It approaches 0 near the extremum of a polynomial; differences far below the mean do
    not count.
    """
    if curve.points:
        # Beyond its points a lookup table is constant, extrapolated or without a value,
        # so only raw values between them count.
        low = max(low, math.ceil(curve.points[0][0]))
        high = min(high, math.floor(curve.points[-1][0]))
    every = max(1, (high - low) // _SAMPLES)
    starts = range(low, max(high, low + 1), every)
    steps = [abs(curve.double(raw + 1) - curve.double(raw)) for raw in starts]
    finite = [step for step in steps if 0 < step < math.inf]
    if not finite:
        return 1.0
    return max(min(finite), math.fsum(finite) / len(finite) / _STEEP)
