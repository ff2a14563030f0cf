"""Physical values from raw ones, and back."""

from __future__ import annotations

from ._errors import RangeError

Terms = tuple[int, int, int]


def nearest_raw(value: float, field: str, terms: Terms, limits: tuple[int, int]) -> int:
    """The raw value whose physical value is nearest; of two, the even one.

    The physical value is ``(raw * p + c) / q``. ``value`` is taken exactly: a float,
    an integer, or anything else that has ``as_integer_ratio``. Raises `RangeError`.

    >>> nearest_raw(0.5, "angle", (1, 0, 100), (-32768, 32767))
    50
    """
    (p, c, q), (low, high) = terms, limits
    try:
        over, under = value.as_integer_ratio()
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise RangeError(field, _span(terms, limits), value) from None
    over, under = over * q - c * under, under * p
    if under < 0:
        over, under = -over, -under
    raw, rest = divmod(over, under)
    if 2 * rest > under or (2 * rest == under and raw % 2):
        raw += 1
    if not low <= raw <= high:
        raise RangeError(field, _span(terms, limits), value)
    return raw


def _span(terms: Terms, limits: tuple[int, int]) -> str:
    p, c, q = terms
    least, most = sorted((raw * p + c) / q for raw in limits)
    return f"{least!r} to {most!r}"
