"""Scale formulas in Rust: exact in doubles where every step is, else through 128-bit integers of the support module."""

from __future__ import annotations

from functools import lru_cache
from math import lcm
from typing import NamedTuple

from icdgen.backends.rust.names import storage
from icdgen.backends.rust.text import decimal, whole_double
from icdgen.icd.formula import Scale
from icdgen.icd.model import Field

EXACT = 1 << 53  # below this every whole number is a double


class Linear(NamedTuple):
    """physical = (raw * factor + offset) / divisor, all whole; the divisor is positive."""

    factor: int
    offset: int
    divisor: int


IDENTITY = Linear(1, 0, 1)


def linear(scale: Scale | None) -> Linear:
    """The scale over its common denominator."""
    if scale is None:
        return IDENTITY
    known = _LINEAR.get(id(scale))  # fields of one formula share their scale, and to hash its fractions takes long
    if known is None or known[0] is not scale:
        known = _LINEAR[id(scale)] = (scale, _over_common_denominator(scale))
    return known[1]


_LINEAR: dict[int, tuple[Scale, Linear]] = {}


def _over_common_denominator(scale: Scale) -> Linear:
    divisor = lcm(scale.factor.denominator, scale.offset.denominator)
    factor = scale.factor.numerator * (divisor // scale.factor.denominator)
    return Linear(factor, scale.offset.numerator * (divisor // scale.offset.denominator), divisor)


def getter(field: Field, source: str, constant: str) -> str:
    """Expression of the physical value; ``source`` is the raw value, ``constant`` the field's entry of the support module."""
    line = linear(field.scale)
    biggest = max(abs(field.raw_min), field.raw_max) * abs(line.factor)
    if storage(field.bits) > 32 or max(biggest, abs(line.offset), biggest + abs(line.offset), line.divisor) >= EXACT:
        return f"{constant}.physical({source})"
    return in_doubles(line, f"f64::from({source})")


@lru_cache(maxsize=4096)
def in_doubles(line: Linear, raw: str) -> str:
    """The one division that rounds; a zero comes out positive whatever the signs."""
    size = abs(line.factor)
    value = raw if size == 1 else f"{raw} * {whole_double(size)}"
    if line.factor < 0:
        value = f"{whole_double(line.offset)} - {value}"
    elif line.offset:
        value = f"{value} {'+' if line.offset > 0 else '-'} {whole_double(abs(line.offset))}"
    if line.divisor == 1:
        return value
    return f"{value if value == raw else f'({value})'} / {whole_double(line.divisor)}"


def physical_range(scale: Scale, low: int, high: int) -> str:
    """Smallest and largest physical value, for people."""
    return _range(linear(scale), low, high)


@lru_cache(maxsize=4096)
def _range(line: Linear, low: int, high: int) -> str:
    first, last = sorted((raw * line.factor + line.offset) / line.divisor for raw in (low, high))
    return f"{decimal(first)} to {decimal(last)}"
