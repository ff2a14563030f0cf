"""The limits of a field, one by one: each with its key, its sign, and in words."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Final, NamedTuple

from icdgen.describe.steps import steps
from icdgen.icd.curve import Curve
from icdgen.icd.model import Field, Limits


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

    def holds(self, value: Fraction | float) -> bool:
        """Whether the value keeps the limit; NaN keeps none."""
        return self.kind.holds(value, self.value)


def bounds(limits: Limits | None) -> tuple[Bound, ...]:
    """The limits that there are: from below, then from above."""
    if limits is None:
        return ()
    found = ((kind, getattr(limits, kind.key)) for kind in KINDS)
    return tuple(Bound(kind, value) for kind, value in found if value is not None)


def span(curve: Curve, field: Field) -> tuple[Fraction, Fraction] | None:
    """The smallest and the largest value that leads back to a raw value; None where none does, and of a float."""
    if field.type == "float" or not field.leads_back:
        return None
    first, last = (Fraction(curve.double(raw)) for raw in field.ends)
    return min(first, last), max(first, last)


def allowed_ends(field: Field) -> tuple[Fraction | None, Fraction | None]:
    """Smallest and largest physical value, as far as the type and inclusive limits tell."""
    ends = None
    if field.curve is not None:
        ends = span(field.curve, field)
    elif field.type in ("uint", "int"):
        scaled = steps(field)
        ends = scaled.span if scaled else (Fraction(field.raw_min), Fraction(field.raw_max))
    least, most = ends or (None, None)
    low, high = (field.limits.min, field.limits.max) if field.limits else (None, None)
    return least if low is None else low, most if high is None else high
