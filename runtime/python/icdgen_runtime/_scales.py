"""Physical values from raw ones, and back."""

from __future__ import annotations

# Itself: what annotations name is loaded when they are evaluated.
from . import _lazy
from ._errors import RangeError

Terms = tuple[int, int, int]


def nearest_raw(value: float, info: _lazy.FieldInfo, field: str, terms: Terms) -> int:
    """The raw value whose physical value is nearest; of two, the even one.

    The physical value is ``(raw * p + c) / q``. ``value`` is taken exactly: a float,
    an integer, or anything else that has ``as_integer_ratio``. Raises `RangeError`
    that names ``field``, the attribute that is set.
    """
    (p, c, q), (low, high) = terms, info.raw_range
    try:
        over, under = value.as_integer_ratio()
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise RangeError(field, _allowed(info, terms), value) from None
    over, under = over * q - c * under, under * p
    if under < 0:
        over, under = -over, -under
    raw, rest = divmod(over, under)
    if 2 * rest > under or (2 * rest == under and raw % 2):
        raw += 1
    if not low <= raw <= high:
        raise RangeError(field, _allowed(info, terms), value)
    return raw


def _allowed(info: _lazy.FieldInfo, terms: Terms) -> str:
    """``0 to 6553.5 m/s``; of whole parts of the unit these, and then the same."""
    least, most = _ends(info, info.scale)
    span = span_of(least, most, info.unit)
    if terms == info.scale:
        return span
    least, most = _ends(info, terms)
    return f"{span_of(least, most)} ({span})"


def _ends(info: _lazy.FieldInfo, terms: Terms) -> list[float]:
    p, c, q = terms
    return sorted(
        (raw * p + c) / q if q != 1 else raw * p + c for raw in info.raw_range
    )


def span_of(least: float, most: float, unit: str = "") -> str:
    """What is allowed, in a unit.

    >>> span_of(0.0, 6553.5, "m/s")
    '0 to 6553.5 m/s'
    """
    ends = (repr(end).removesuffix(".0") for end in (least, most))
    return f"{' to '.join(ends)} {unit}".rstrip()
