"""The limits of a field, one by one: each with its key, its sign, and in words."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Final, NamedTuple

from icdgen.describe.numbers import exact_text
from icdgen.describe.steps import steps
from icdgen.icd.curve import Curve
from icdgen.icd.model import Limits
from icdgen.icd.places import AnyScalar


class Kind(NamedTuple):
    """A kind of limit. ``holds(value, limit)`` tells whether a value keeps it."""

    key: str  # as in the ICD
    sign: str
    words: str  # before the number: "at least 0"
    title: str  # of the number by itself
    refusal: str  # before the number, of a value that does not keep it
    holds: Callable[[Fraction | float, Fraction], bool]


KINDS: Final = (
    Kind("min", ">=", "at least", "least value", "below the minimum", operator.ge),
    Kind("above", ">", "above", "must be above this", "must be above", operator.gt),
    Kind("max", "<=", "at most", "largest value", "above the maximum", operator.le),
    Kind("below", "<", "below", "must be below this", "must be below", operator.lt),
)
KEYS: Final = tuple(kind.key for kind in KINDS)


class Bound(NamedTuple):
    """A limit of the physical value (of the raw value where there is no scale)."""

    kind: Kind
    value: Fraction

    @property
    def key(self) -> str:
        return self.kind.key

    @property
    def double(self) -> float:
        """The double nearest to the limit."""
        return self.value.numerator / self.value.denominator

    def holds(self, value: Fraction | float) -> bool:
        """Whether the value keeps the limit; NaN keeps none."""
        return self.kind.holds(value, self.value)


def bounds(limits: Limits | None) -> tuple[Bound, ...]:
    """The limits that there are: from below, then from above."""
    if limits is None:
        return ()
    found = ((kind, getattr(limits, kind.key)) for kind in KINDS)
    return tuple(Bound(kind, value) for kind, value in found if value is not None)


def span(curve: Curve, field: AnyScalar) -> tuple[Fraction, Fraction] | None:
    """The smallest and the largest value that leads back to a raw value; None where none does, and of a float."""
    if field.type == "float" or not field.is_invertible:
        return None
    first, last = (Fraction(curve.double(raw)) for raw in field.settable_raws)
    return min(first, last), max(first, last)


def allowed_ends(field: AnyScalar) -> tuple[Fraction | None, Fraction | None]:
    """Smallest and largest physical value, as far as the type and inclusive limits tell."""
    least, most = _type_ends(field)
    low, high = (field.limits.min, field.limits.max) if field.limits else (None, None)
    return least if low is None else low, most if high is None else high


def _type_ends(field: AnyScalar) -> tuple[Fraction | None, Fraction | None]:
    """Smallest and largest physical value of the type; None for floats, and for what is no number."""
    ends = None
    if field.curve is not None:
        ends = span(field.curve, field)
    elif field.type in ("uint", "int"):
        scaled = steps(field)
        ends = scaled.span if scaled else (Fraction(field.raw_min), Fraction(field.raw_max))
    return ends or (None, None)


def range_text(field: AnyScalar) -> str:
    """Return the values that can be set, by type and limits together: ``0 to 6000 rpm``; empty if a float has no limits.

    An end that is excluded itself reads ``above 0`` or ``below 125``.
    """
    low, high = _least(field), _most(field)
    unit = f" {field.unit.symbol}" if field.unit else ""
    if low is not None and high is not None:
        return f"{_end(*low, 'above ')} to {_end(*high, 'below ')}{unit}"
    if low is not None:
        return f"{_end(*low, 'above ') if low[1] else 'at least ' + exact_text(low[0])}{unit}"
    if high is not None:
        return f"{_end(*high, 'below ') if high[1] else 'at most ' + exact_text(high[0])}{unit}"
    return ""


_End = tuple[Fraction, bool]  # a value, and whether it is excluded itself


def _least(field: AnyScalar) -> _End | None:
    limits = field.limits or Limits()
    ends = [(value, False) for value in (_type_ends(field)[0], limits.min) if value is not None]
    return max([*ends, *([(limits.above, True)] if limits.above is not None else [])], default=None)


def _most(field: AnyScalar) -> _End | None:
    limits = field.limits or Limits()
    ends = [(value, False) for value in (_type_ends(field)[1], limits.max) if value is not None]
    ends += [(limits.below, True)] if limits.below is not None else []
    return min(ends, key=lambda end: (end[0], not end[1]), default=None)


def _end(value: Fraction, is_excluded: bool, word: str) -> str:
    return f"{word if is_excluded else ''}{exact_text(value)}"
