"""Physical values by polynomials, computed in doubles: Horner's rule."""

from __future__ import annotations

import math
import struct

from . import _lazy
from ._errors import RangeError
from ._scales import span_of


def on_curve(coefficients: tuple[float, ...], raw: float) -> float:
    """The physical value of a raw one; the constant stands first.

    >>> on_curve((-40.0, 0.5, 0.25), 2)
    -38.0
    """
    x, value = float(raw), coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return math.nan if math.isnan(value) else value


def from_curve(value: _lazy.Any, info: _lazy.FieldInfo, field: str) -> _lazy.Any:
    """The nearest raw value, of two the even one. Raises `RangeError` that names ``field``, the attribute that is set."""
    try:
        top, bottom = value.as_integer_ratio()
        wanted = value if isinstance(value, float) else top / bottom
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise RangeError(field, "a finite number", value) from None
    if not info.leads_back:
        raise RangeError(
            field,
            f"no value, for its formula does not lead back: set {info.attribute}",
            value,
        )
    if info.type == "float":
        return _number(wanted, info, field)
    return _nearest(wanted, info, field)


def _number(value: float, info: _lazy.FieldInfo, field: str) -> float:
    constant, slope = info.curve
    inverse = (value - constant) / slope
    try:
        form = "<f" if info.bits == 32 else "<d"
        (narrow,) = struct.unpack(form, struct.pack(form, inverse))
    except OverflowError:
        narrow = math.inf
    if not math.isfinite(narrow):
        raise RangeError(field, f"what {info.bits} bits of a float hold", value)
    return float(narrow)


def _nearest(value: float, info: _lazy.FieldInfo, field: str) -> int:
    low, high = info.raw_range
    first, last = on_curve(info.curve, low), on_curve(info.curve, high)
    rises = first < last
    least, most = (first, last) if rises else (last, first)
    if not least <= value <= most:
        raise RangeError(field, span_of(least, most, info.unit), value)
    while high - low > 1:
        middle = (low + high) // 2
        here = on_curve(info.curve, middle)
        if here <= value if rises else here >= value:
            low = middle
        else:
            high = middle
    below = abs(value - on_curve(info.curve, low))
    above = abs(on_curve(info.curve, high) - value)
    return low if below < above or (below == above and low % 2 == 0) else high
