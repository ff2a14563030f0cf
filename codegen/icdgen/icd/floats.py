"""Floats of 32 and 64 bits as their IEEE 754 bits: from numbers, and back to the shortest text that says which one it is."""

from __future__ import annotations

import math
import struct
from fractions import Fraction

NAMED = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}
"""Spellings of floats that are not numbers."""

WIDTHS = (32, 64)

_FORMATS = {32: ("<f", "<I"), 64: ("<d", "<Q")}


def bits_of(value: float, bits: int) -> int:
    """The bits of a number that a float of this width holds, or of what is no number."""
    number, whole = _FORMATS[bits]
    found: int = struct.unpack(whole, struct.pack(number, value))[0]
    return found


def value_of(raw: int, bits: int) -> float:
    """The number that the bits stand for."""
    number, whole = _FORMATS[bits]
    value: float = struct.unpack(number, struct.pack(whole, raw))[0]
    return value


def nearest(value: Fraction, bits: int) -> int:
    """Bits of the nearest float, ties to even, from the exact value: going through a double would round twice.

    Raises `OverflowError`.
    """
    sign, value = value < 0, abs(value)
    precision, lowest, highest = (24, -149, 104) if bits == 32 else (53, -1074, 971)
    if not value:
        return 0
    exponent = value.numerator.bit_length() - value.denominator.bit_length() - precision
    exponent = max(exponent, lowest)
    digits = round(value / Fraction(2) ** exponent)
    while digits.bit_length() > precision:
        exponent += 1
        digits = round(value / Fraction(2) ** exponent)
    if exponent > highest:
        raise OverflowError
    return bits_of(math.ldexp(digits, exponent), bits) | sign << bits - 1


def text_of(value: float, bits: int) -> str:
    """The shortest decimal that is read back as the same float of that width."""
    if bits == 64 or not math.isfinite(value):
        return repr(value)
    wanted = bits_of(value, 32)
    return next(repr(float(text)) for d in range(1, 10) if _reads_as(text := f"{value:.{d}g}", wanted))


def _reads_as(text: str, wanted: int) -> bool:
    try:
        found = nearest(Fraction(text), 32)
    except OverflowError:
        return False
    return found | text.startswith("-") << 31 == wanted
