"""Conversion of 32-bit and 64-bit floats between IEEE 754 bits, numbers and their
shortest decimal text.
"""

from __future__ import annotations

import math
import struct
from fractions import Fraction

NAMED = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}
"""Spellings of floats that are not numbers."""

WIDTHS = (32, 64)

_FORMATS = {32: ("<f", "<I"), 64: ("<d", "<Q")}


def bits_of(value: float, bits: int) -> int:
    """Return the bits of a number that a float of this width represents exactly, or of
    NaN or infinity.
    """
    float_format, int_format = _FORMATS[bits]
    raw: int = struct.unpack(int_format, struct.pack(float_format, value))[0]
    return raw


def value_of(raw: int, bits: int) -> float:
    """Return the number that the bits represent."""
    float_format, int_format = _FORMATS[bits]
    value: float = struct.unpack(float_format, struct.pack(int_format, raw))[0]
    return value


def nearest(value: Fraction, bits: int) -> int:
    """Return the bits of the nearest float, ties to even. Raises `OverflowError`.

    Computes them from the exact value, because a conversion by way of a double would
    round twice.
    """
    sign, value = value < 0, abs(value)
    # Bits of the significand, and the exponents of its lowest bit in the smallest and
    # in the largest float.
    precision, lowest, highest = (24, -149, 104) if bits == 32 else (53, -1074, 971)
    if not value:
        return 0
    # The bit lengths give the exponent or one less. Subnormal numbers have the lowest
    # exponent and fewer digits.
    exponent = value.numerator.bit_length() - value.denominator.bit_length() - precision
    exponent = max(exponent, lowest)
    digits = round(value / Fraction(2) ** exponent)
    # The estimate was one too small, or rounding carried into one more bit.
    while digits.bit_length() > precision:
        exponent += 1
        digits = round(value / Fraction(2) ** exponent)
    if exponent > highest:
        raise OverflowError
    return bits_of(math.ldexp(digits, exponent), bits) | sign << bits - 1


def text_of(value: float, bits: int) -> str:
    """Return the shortest decimal that converts back to the same float of this width."""
    if bits == 64 or not math.isfinite(value):
        return repr(value)
    raw = bits_of(value, 32)
    # Nine significant digits identify every 32-bit float.
    for digits in range(1, 10):
        text = f"{value:.{digits}g}"
        if _reads_as(text, raw):
            break
    return repr(float(text))


def _reads_as(text: str, raw: int) -> bool:
    """Return whether the nearest 32-bit float of a decimal has these bits."""
    try:
        nearest_raw = nearest(Fraction(text), 32)
    except OverflowError:
        return False
    # The Fraction of "-0" has no sign.
    return nearest_raw | text.startswith("-") << 31 == raw
