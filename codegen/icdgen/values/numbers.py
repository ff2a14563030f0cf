"""Numbers as people write them, taken exactly."""

from __future__ import annotations

import math
import re
import struct
from fractions import Fraction

LONGEST = 400

_DECIMAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
_RATIO = re.compile(r"[+-]?[0-9]+/0*[1-9][0-9]*")
_INTEGER = re.compile(r"[+-]?[0-9]+")
_HEX = re.compile(r"([+-]?)0[xX]([0-9A-Fa-f]+)")
_SPECIAL = {"nan": "nan", "inf": "inf", "infinity": "inf"}


def integer(text: str) -> int | None:
    """``12``, ``-3``, ``0x5A``; None if it is none of these."""
    if len(text) > LONGEST:
        return None
    if match := _HEX.fullmatch(text):
        return int(match[1] + match[2], 16)
    return int(text) if _INTEGER.fullmatch(text) else None


def rational(text: str) -> Fraction | None:
    """``12``, ``-0.5``, ``1e-3``, ``1/3``, exactly; None if it is none of these."""
    if len(text) > LONGEST:
        return None
    return Fraction(text) if _DECIMAL.fullmatch(text) or _RATIO.fullmatch(text) else None


def float_bits(text: str, bits: int) -> int | None:
    """IEEE 754 bits of the nearest float of 32 or 64 bits; also of ``nan`` and ``inf``. None if it is not a number.

    Raises `OverflowError`.
    """
    sign, word = text.startswith("-"), text.lstrip("+-").lower()
    if word in _SPECIAL and len(text) - len(word) <= 1:
        return _pack(float(_SPECIAL[word]), bits) | sign << bits - 1
    exact = rational(text)
    return None if exact is None else _nearest(abs(exact), bits) | sign << bits - 1


def _nearest(value: Fraction, bits: int) -> int:
    """Bits of the nearest float, ties to even, from the exact value: going through a double would round twice."""
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
    return _pack(math.ldexp(digits, exponent), bits)


def _pack(value: float, bits: int) -> int:
    return int.from_bytes(struct.pack("<f" if bits == 32 else "<d", value), "little")


def float_text(value: float, bits: int) -> str:
    """The shortest decimal that is read back as the same float of that width."""
    if bits == 64 or value != value or value in (float("inf"), float("-inf")):
        return repr(value)
    wanted = _pack(value, 32)
    return next(repr(float(text)) for d in range(1, 10) if _reads_as(text := f"{value:.{d}g}", wanted))


def _reads_as(text: str, wanted: int) -> bool:
    try:
        return float_bits(text, 32) == wanted
    except OverflowError:
        return False
