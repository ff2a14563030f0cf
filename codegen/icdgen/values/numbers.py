"""Exact conversion of numbers that users type."""

from __future__ import annotations

import re
from fractions import Fraction

from icdgen.icd import floats

LONGEST = 400  # characters; int() takes quadratic time for longer texts

_DECIMAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
# The divisor has a digit other than 0, so it is not zero.
_RATIO = re.compile(r"[+-]?[0-9]+/0*[1-9][0-9]*")
_INTEGER = re.compile(r"[+-]?[0-9]+")
_HEX = re.compile(r"([+-]?)0[xX]([0-9A-Fa-f]+)")
_BINARY = re.compile(r"0[bB][01]+")
_SPECIAL = {"nan": "nan", "inf": "inf", "infinity": "inf"}


def integer(text: str) -> int | None:
    """Return the integer that a text states: ``12``, ``-3``, ``0x5A``, ``0b101``; None
    for any other text.
    """
    if len(text) > LONGEST:
        return None
    if match := _HEX.fullmatch(text):
        return int(match[1] + match[2], 16)
    if _BINARY.fullmatch(text):
        return int(text, 2)
    return int(text) if _INTEGER.fullmatch(text) else None


def rational(text: str) -> Fraction | None:
    """Return the exact value of ``12``, ``-0.5``, ``1e-3`` or ``1/3``; None for any
    other text.
    """
    if len(text) > LONGEST:
        return None
    return (
        Fraction(text) if _DECIMAL.fullmatch(text) or _RATIO.fullmatch(text) else None
    )


def float_bits(text: str, bits: int) -> int | None:
    """Return the bits of the nearest 32-bit or 64-bit float of a text, which can also
    be ``nan`` or ``inf``.

    Returns None if the text is not a number. Raises `OverflowError`.
    """
    sign, word = text.startswith("-"), text.lstrip("+-").lower()
    if word in _SPECIAL and len(text) - len(word) <= 1:
        return floats.bits_of(float(_SPECIAL[word]), bits) | sign << bits - 1
    # The sign is set separately: a Fraction has no negative zero.
    exact = rational(text)
    return (
        None if exact is None else floats.nearest(abs(exact), bits) | sign << bits - 1
    )
