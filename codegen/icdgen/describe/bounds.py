"""Limits of a field, one by one, with their keys, signs and words.

`bounds_of_limits` lists the limits that an ICD states; `allowed_ends` and `range_text`
combine them with the range that the type of the field allows. Values are exact
fractions: physical values, or raw values of a field without a scale.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Final

from icdgen.describe.numbers import exact_text
from icdgen.describe.steps import steps_of_scale
from icdgen.frozen import NamedTuple
from icdgen.icd.curve import Curve
from icdgen.icd.model import Limits
from icdgen.icd.places import AnyScalar


class LimitKind(NamedTuple):
    """Kind of limit.

    ``holds(value, limit)`` returns whether a value is within the limit.
    """

    key: str  # as in the ICD
    sign: str
    words: str  # before the number: "at least 0"
    title: str  # of the constant with the number
    refusal: str  # before the number, for a value beyond the limit
    holds: Callable[[Fraction | float, Fraction], bool]


KINDS: Final = (
    LimitKind("min", ">=", "at least", "least value", "below the minimum", operator.ge),
    LimitKind(
        "above", ">", "above", "must be above this", "must be above", operator.gt
    ),
    LimitKind(
        "max", "<=", "at most", "largest value", "above the maximum", operator.le
    ),
    LimitKind(
        "below", "<", "below", "must be below this", "must be below", operator.lt
    ),
)
KEYS: Final = tuple(kind.key for kind in KINDS)


class Bound(NamedTuple):
    """Limit of the physical value, or of the raw value without a scale."""

    kind: LimitKind
    value: Fraction

    @property
    def key(self) -> str:
        """Key in the ICD: ``min``, ``above``, ``max`` or ``below``."""
        return self.kind.key

    @property
    def double(self) -> float:
        """Double nearest to the limit."""
        return self.value.numerator / self.value.denominator

    def holds(self, value: Fraction | float) -> bool:
        """Return whether a value is within the limit. NaN is not."""
        # Python compares a `Fraction` and a float exactly, without rounding either.
        return self.kind.holds(value, self.value)


def bounds_of_limits(limits: Limits | None) -> tuple[Bound, ...]:
    """Return the limits of a field, lower ones first."""
    if limits is None:
        return ()
    values = ((kind, getattr(limits, kind.key)) for kind in KINDS)
    return tuple(Bound(kind, value) for kind, value in values if value is not None)


def settable_span(curve: Curve, field: AnyScalar) -> tuple[Fraction, Fraction] | None:
    """Return the smallest and largest physical value that can be set; None if a
    calibration has no inverse, and for floats.
    """
    if field.type == "float" or not field.is_invertible:
        return None
    # The calibration can fall, so the first value can be the larger one.
    first, last = (Fraction(curve.double(raw)) for raw in field.settable_raws)
    return min(first, last), max(first, last)


def allowed_ends(field: AnyScalar) -> tuple[Fraction | None, Fraction | None]:
    """Return the smallest and largest physical value by type and inclusive limits; None
    for an end without a bound.
    """
    least, most = _type_ends(field)
    low, high = (field.limits.min, field.limits.max) if field.limits else (None, None)
    return least if low is None else low, most if high is None else high


def _type_ends(field: AnyScalar) -> tuple[Fraction | None, Fraction | None]:
    """Return the smallest and largest physical value by type alone; None for floats,
    flags, enumerations and bytes.
    """
    if field.curve is not None:
        return settable_span(field.curve, field) or (None, None)
    if field.type not in ("uint", "int"):
        return None, None
    scaled = steps_of_scale(field)
    if scaled is not None:
        return scaled.span
    return Fraction(field.raw_min), Fraction(field.raw_max)


def range_text(field: AnyScalar) -> str:
    """Return the values that can be set, by type and limits together: ``0 to 6000
    rpm``; empty if a float has no limits.

    An end that is excluded itself reads ``above 0`` or ``below 125``.
    """
    low, high = _lower_end(field), _upper_end(field)
    if low is None and high is None:
        return ""
    if low is not None and high is not None:
        text = f"{_end_text(low, 'above ')} to {_end_text(high, 'below ')}"
    elif low is not None:
        text = _end_text(low, "above ", "at least ")
    else:
        assert high is not None
        text = _end_text(high, "below ", "at most ")
    return f"{text} {field.unit.symbol}" if field.unit else text


_End = tuple[Fraction, bool]  # a value, and whether it is excluded itself


def _lower_end(field: AnyScalar) -> _End | None:
    """Return the narrowest lower end of type and limits."""
    limits = field.limits or Limits()
    values = (_type_ends(field)[0], limits.min)
    ends = [(value, False) for value in values if value is not None]
    if limits.above is not None:
        ends.append((limits.above, True))
    # Of equal values, the excluded one is the narrower limit: True is above False.
    return max(ends, default=None)


def _upper_end(field: AnyScalar) -> _End | None:
    """Return the narrowest upper end of type and limits."""
    limits = field.limits or Limits()
    values = (_type_ends(field)[1], limits.max)
    ends = [(value, False) for value in values if value is not None]
    if limits.below is not None:
        ends.append((limits.below, True))
    # Of equal values, the excluded one is the narrower limit.
    return min(ends, key=lambda end: (end[0], not end[1]), default=None)


def _end_text(end: _End, excluded: str, included: str = "") -> str:
    """Return an end after the word for its kind."""
    value, is_excluded = end
    return f"{excluded if is_excluded else included}{exact_text(value)}"
