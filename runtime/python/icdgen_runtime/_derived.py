"""Values derived from several fields, computed in doubles.

A derivation has three parts: attributes of physical values (raw, if a field has none),
numbers, and steps. The values, the numbers and the result of each step form a row. A
step names its operands by their index in this row. The last entry is the result.
"""

from __future__ import annotations

import math

from . import _types


def derived(derivation: _types.Derivation, values: list[float]) -> float:
    """Return the derived value for the values of the fields.

    >>> derived((("volts", "amperes"), (1000.0,), (("*", 0, 1), ("/", 3, 2))), [2.0, 250.0])
    0.5
    """
    _, numbers, steps = derivation
    row = [*map(float, values), *numbers]
    for operator, left, right in steps:
        row.append(_OPERATORS[operator](row[left], row[right]))
    return math.nan if math.isnan(row[-1]) else row[-1]


def quotient(one: float, other: float) -> float:
    """Divide as IEEE 754 specifies, also by zero."""
    if other:
        return one / other
    if not one or math.isnan(one):
        return math.nan
    return math.copysign(math.inf, one) * math.copysign(1.0, other)


def power(base: float, exponent: float) -> float:
    """Raise to an integer exponent by squaring, from its lowest bit on.

    A negative exponent gives the reciprocal of the positive power.
    """
    left, found = abs(int(exponent)), 1.0
    while left:
        if left & 1:
            found *= base
        base *= base
        left >>= 1
    return quotient(1.0, found) if exponent < 0 else found


_OPERATORS = {
    "+": float.__add__,
    "-": float.__sub__,
    "*": float.__mul__,
    "/": quotient,
    "^": power,
}


def column(
    numpy: _types.Any, derivation: _types.Derivation, columns: list[_types.Any]
) -> _types.Any:
    """Return the derived values for columns of values."""
    _, numbers, steps = derivation
    with numpy.errstate(all="ignore"):
        row = [one.astype(numpy.float64) for one in columns]
        row += [numpy.full(len(row[0]), number) for number in numbers]
        for operator, left, right in steps:
            row.append(_on_columns(numpy, operator, row[left], row[right]))
    found = row[-1].copy()
    found[numpy.isnan(found)] = numpy.nan
    return found


def _on_columns(
    numpy: _types.Any, operator: str, one: _types.Any, other: _types.Any
) -> _types.Any:
    if operator == "^":
        return _powers(numpy, one, other)
    name = {"+": "add", "-": "subtract", "*": "multiply", "/": "divide"}[operator]
    return getattr(numpy, name)(one, other)


def _powers(numpy: _types.Any, base: _types.Any, exponent: _types.Any) -> _types.Any:
    left = numpy.abs(exponent).astype(numpy.int64)
    found = numpy.ones(len(base))
    while left.any():
        found = numpy.where(left & 1, found * base, found)
        base = base * base
        left = left >> 1
    return numpy.where(exponent < 0, 1.0 / found, found)
