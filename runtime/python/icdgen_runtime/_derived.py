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
    # Sign and payload of a computed NaN differ between processors.
    return math.nan if math.isnan(row[-1]) else row[-1]


def quotient(dividend: float, divisor: float) -> float:
    """Divide as IEEE 754 specifies, also by zero."""
    if divisor:
        return dividend / divisor
    if not dividend or math.isnan(dividend):
        return math.nan
    return math.copysign(math.inf, dividend) * math.copysign(1.0, divisor)


def power(base: float, exponent: float) -> float:
    """Raise to an integer exponent by squaring, from its lowest bit on.

    A negative exponent gives the reciprocal of the positive power.
    """
    remaining, result = abs(int(exponent)), 1.0
    while remaining:
        if remaining & 1:
            result *= base
        base *= base
        remaining >>= 1
    return quotient(1.0, result) if exponent < 0 else result


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
        row = [values.astype(numpy.float64) for values in columns]
        row += [numpy.full(len(row[0]), number) for number in numbers]
        for operator, left, right in steps:
            row.append(_on_columns(numpy, operator, row[left], row[right]))
    result = row[-1].copy()
    result[numpy.isnan(result)] = numpy.nan
    return result


def _on_columns(
    numpy: _types.Any, operator: str, left: _types.Any, right: _types.Any
) -> _types.Any:
    if operator == "^":
        return _powers(numpy, left, right)
    name = {"+": "add", "-": "subtract", "*": "multiply", "/": "divide"}[operator]
    return getattr(numpy, name)(left, right)


def _powers(numpy: _types.Any, base: _types.Any, exponent: _types.Any) -> _types.Any:
    remaining = numpy.abs(exponent).astype(numpy.int64)
    result = numpy.ones(len(base))
    while remaining.any():
        result = numpy.where(remaining & 1, result * base, result)
        base = base * base
        remaining = remaining >> 1
    return numpy.where(exponent < 0, 1.0 / result, result)
