"""Limits of physical values: their order, and the range of the field.

The rules take fields with `min`, `above`, `max` or `below` and compute with exact
fractions. ICD033 reports limits that exclude every value, ICD034 limits that no raw
value of the field satisfies, and constants outside them. ICD034 does not check floats
and nonlinear calibrations.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import ceil, floor

from icdgen.frozen import NamedTuple
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Scalar
from icdgen.icd.meanings import Limits
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.values import NUMBERS
from icdgen.wording import quote

LIMITS = ("min", "above", "max", "below")


# Exact numbers: with floats, `max: 0.3` would exclude the raw value 3 of the formula
# `raw*0.1`, because 3 * 0.1 is greater than 0.3 in binary64.
class Bounds(NamedTuple):
    """An interval of physical values."""

    low: Fraction | None  # None without a lower limit
    high: Fraction | None
    above: bool  # the interval excludes `low`
    below: bool  # the interval excludes `high`

    @property
    def is_empty(self) -> bool:
        """Whether no value is in the interval."""
        if self.low is None or self.high is None:
            return False
        return self.low > self.high or (
            self.low == self.high and (self.above or self.below)
        )


def bounds(field: Scalar) -> Bounds:
    """Return the interval that satisfies all limits of a field."""
    limits = field.limits or Limits()
    # Of equal limits, the tuples sort the open one as the higher lower limit and as the
    # lower upper limit.
    lows = (
        (value, is_open)
        for value, is_open in ((limits.min, False), (limits.above, True))
        if value is not None
    )
    highs = (
        (value, is_closed)
        for value, is_closed in ((limits.max, True), (limits.below, False))
        if value is not None
    )
    low, above = max(lows, default=(None, False))
    high, inside = min(highs, default=(None, True))
    return Bounds(low, high, above, not inside)


def _limited(ctx: Context) -> Iterator[Scalar]:
    """Return the fields with limits."""
    return (field for field, _ in ctx.fields if field.limits is not None)


def _shown(field: Scalar, *keys: str) -> str:
    """Return the limits of a field with these keys, as the ICD declares them."""
    return " and ".join(
        f"`{key}: {field.source[key]}`" for key in keys if key in field.source
    )


def _first(field: Scalar, *keys: str) -> str:
    """Return the first of these keys that a field has."""
    return next(key for key in keys if key in field.source)


@rule("ICD033")
def limits_leave_a_value(ctx: Context) -> Iterator[Fault]:
    for field in _limited(ctx):
        source = field.source
        if field.type == "bool" or field.is_bytes:
            key = _first(field, *LIMITS)
            yield Fault.at(
                source,
                key,
                f"`{key}` has no meaning for type `{field.type}`",
                f"remove `{key}`",
            )
        elif bounds(field).is_empty:
            message = f"{_shown(field, *LIMITS)} leave no value for {quote(field.name)}"
            help = "correct them: `min` and `above` are lower limits, `max` and `below` are upper limits"
            yield Fault.at(source, _first(field, "max", "below"), message, help)


@rule("ICD034")
def limits_are_in_the_range_of_the_field(ctx: Context) -> Iterator[Fault]:
    for field in _limited(ctx):
        # Floats and curves are not checked. Other rules report invalid formulas.
        if field.type not in NUMBERS or (
            ("points" in field.source or field.formula) and field.scale is None
        ):
            continue
        within, source = bounds(field), field.source
        if within.is_empty:
            continue
        allowed = _raw_values(field, within)
        if not allowed:
            key = _first(
                field,
                *(("min", "above") if within.low is not None else ("max", "below")),
            )
            message = (
                f"no value of {quote(field.name)} is within {_shown(field, *LIMITS)}"
            )
            low, high = sorted(
                _physical(field, raw) for raw in (field.raw_min, field.raw_max)
            )
            yield Fault.at(
                source,
                key,
                message,
                f"its values go from {_number(low)} to {_number(high)}",
            )
        elif (
            field.const is not None
            and field.raw_min <= field.const <= field.raw_max
            and field.const not in allowed
        ):
            message = f"`const: {field.const}` of {quote(field.name)} is outside {_shown(field, *LIMITS)}"
            value = _number(_physical(field, field.const))
            help = (
                f"its physical value is {value}"
                if field.scale
                else "correct one of them"
            )
            yield Fault.at(source, "const", message, help)


def _physical(field: Scalar, raw: int) -> Fraction:
    """Return the physical value of a raw value; without a formula the raw value."""
    return field.scale.physical(raw) if field.scale else Fraction(raw)


def _raw_values(field: Scalar, within: Bounds) -> range:
    """Return the raw values of a field whose physical values are within the bounds."""
    low, high, above, below = within
    if field.scale:
        low = None if low is None else field.scale.raw(low)
        high = None if high is None else field.scale.raw(high)
        # A negative factor exchanges the lower and the upper limit.
        if field.scale.factor < 0:
            low, high, above, below = high, low, below, above
    first, last = field.raw_min, field.raw_max
    # The smallest integer above an open limit, or at or above a closed one.
    if low is not None:
        first = max(first, floor(low) + 1 if above else ceil(low))
    if high is not None:
        last = min(last, ceil(high) - 1 if below else floor(high))
    return range(first, last + 1)


def _number(value: Fraction) -> str:
    return str(value.numerator) if value.denominator == 1 else f"{float(value):g}"
