"""Calibrations: physical values computed in doubles.

A calibration consists of pieces. Each piece has the raw value at which it begins, and
the coefficients of a polynomial in the distance from there, the constant first. A piece
without coefficients gives NaN. Polynomials use Horner's rule, each step rounded.
"""

from __future__ import annotations

import math
import struct
from bisect import bisect_right
from functools import lru_cache

from . import _types
from ._errors import RangeError, span_of
from ._types import FieldInfo


def on_curve(curve: _types.Curve, raw: float) -> float:
    """Return the physical value of a raw value, by the last piece that begins at or
    below it.

    >>> on_curve(((0.0, (-40.0, 0.5, 0.25)),), 2)
    -38.0
    >>> on_curve(((0.0, (7.0,)), (0.0, (7.0, 0.5)), (10.0, (12.0,))), 3)
    8.5
    """
    x = float(raw)
    place = bisect_right(_starts(curve), x) - 1 if len(curve) > 1 else 0
    start, terms = curve[max(place, 0)]
    if not terms or math.isnan(x):
        return math.nan
    above, value = x - start, terms[-1]
    for term in terms[-2::-1]:
        value = value * above + term
    # Sign and payload of a computed NaN differ between processors.
    return math.nan if math.isnan(value) else value


@lru_cache(maxsize=256)
def _starts(curve: _types.Curve) -> tuple[float, ...]:
    return tuple(start for start, _ in curve)


def columns_on_curve(
    numpy: _types.Any, curve: _types.Curve, raw: _types.Any
) -> _types.Any:
    """Return the physical values of a column of raw values."""
    with numpy.errstate(all="ignore"):  # the conversion warns of a signalling NaN
        x = raw.astype(numpy.float64)
    place = numpy.searchsorted(_starts(curve), x, side="right") - 1
    place = numpy.clip(place, 0, None)
    sizes = numpy.array([len(terms) for _, terms in curve])[place]
    most = max(len(terms) for _, terms in curve)
    padded = [(*terms, *(0.0,) * (most - len(terms))) for _, terms in curve]
    table, column = numpy.array(padded), numpy.full(len(x), numpy.nan)
    with numpy.errstate(all="ignore"):
        above = x - numpy.array(_starts(curve))[place]
        for power in range(most - 1, -1, -1):
            term = table[place, power]
            is_highest = sizes == power + 1
            column = numpy.where(is_highest, term, column * above + term)
    column[numpy.isnan(column) | numpy.isnan(x)] = numpy.nan
    return column


def from_curve(value: _types.Any, info: FieldInfo, field: str) -> _types.Any:
    """Return the nearest raw value, the even one of two.

    Raise `RangeError` that names ``field``, the attribute that is set.
    """
    try:
        top, bottom = value.as_integer_ratio()
        wanted = value if isinstance(value, float) else top / bottom
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise RangeError(field, "a finite number", value) from None
    if not info.leads_back:
        raise RangeError(
            field,
            f"no value, as it does not lead back: set {info.attribute}",
            value,
        )
    if info.type == "float":
        return _number(wanted, info, field)
    return _nearest(wanted, info, field)


def _number(value: float, info: FieldInfo, field: str) -> float:
    ((_, (constant, slope)),) = info.curve
    inverse = (value - constant) / slope
    try:
        form = "<f" if info.bits == 32 else "<d"
        (narrow,) = struct.unpack(form, struct.pack(form, inverse))
    except OverflowError:
        narrow = math.inf
    if not math.isfinite(narrow):
        raise RangeError(field, f"what {info.bits} bits of a float hold", value)
    return float(narrow)


def _nearest(value: float, info: FieldInfo, field: str) -> int:
    low, high = info.ends or info.raw_range
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
