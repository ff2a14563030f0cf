"""Numbers of electronic data sheets: arithmetic expressions in attributes, and
encodings of integers.

`evaluate` returns an expression as an exact fraction, and `integer_value` an attribute
that must be an integer. `encoded_value` returns the raw value of a number in an integer
encoding of CCSDS 876.0-B-1, such as BCD. Expressions contain no names: `eds_sheets`
replaces design parameters by their values before.
"""

from __future__ import annotations

import re
from fractions import Fraction

from icdgen.definitions.model import NotSupported
from icdgen.definitions.wording import line
from icdgen.icd.layout import integer_range

UNSIGNED, TWOS = "unsigned", "twosComplement"
CODES = (UNSIGNED, TWOS, "onesComplement", "signMagnitude", "BCD", "packedBCD")
_LONGEST = 500  # characters of a number
_PLAIN = 20  # digits up to which `int` is used directly
_DEEPEST = 20  # parentheses
_MOST_BITS = 256  # of an intermediate result
_MOST_POWER = 128
_TOKEN = re.compile(
    r"\s*(0[xX][0-9A-Fa-f]{1,32}|(?:[0-9]{1,40}(?:\.[0-9]{0,40})?|\.[0-9]{1,40})(?:[eE][-+]?[0-9]{1,2})?|[-+*/^()])"
)


def evaluate(text: str) -> Fraction:
    """Return the value of an arithmetic expression such as `2 ^ (16) - 1`.

    Operators are `+ - * / ^` and parentheses. Raises `ValueError` for other texts and
    for too large values.
    """
    tokens, at, text = [], 0, text.strip()
    if len(text) > _LONGEST:
        raise ValueError("too long")
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise ValueError("no number")
        tokens.append(match[1])
        at = match.end()
    sum_ = _Sum(tokens[::-1])
    value = sum_.terms(0)
    if sum_.left:
        raise ValueError("more behind it")
    return value


class _Sum:
    """Recursive descent parser of arithmetic expressions.

    ``left`` contains the remaining tokens in reverse order.
    """

    def __init__(self, left: list[str]) -> None:
        self.left = left

    def _next(self, of: str) -> str:
        return self.left.pop() if self.left and self.left[-1] in of else ""

    def terms(self, depth: int) -> Fraction:
        value = self._factors(depth)
        while sign := self._next("+-"):
            other = self._factors(depth)
            value = _bounded(value + other if sign == "+" else value - other)
        return value

    def _factors(self, depth: int) -> Fraction:
        value = self._power(depth)
        while sign := self._next("*/"):
            other = self._power(depth)
            if sign == "/" and not other:
                raise ValueError("divided by 0")
            value = _bounded(value * other if sign == "*" else value / other)
        return value

    def _power(self, depth: int) -> Fraction:
        if self._next("-"):
            return -self._power(depth + 1)
        if self._next("+"):
            return self._power(depth + 1)
        value = self._single(depth)
        if not self._next("^"):
            return value
        # Right associative: 2 ^ 3 ^ 2 is 2 ^ 9.
        power = self._power(depth + 1)
        if power.denominator != 1 or not 0 <= power <= _MOST_POWER:
            raise ValueError("an exponent that is not a small number")
        return _bounded(Fraction(value ** int(power)))

    def _single(self, depth: int) -> Fraction:
        if depth > _DEEPEST or not self.left:
            raise ValueError("no number")
        token = self.left.pop()
        if token == "(":
            value = self.terms(depth + 1)
            if not self._next(")"):
                raise ValueError("a parenthesis is not closed")
            return value
        if token in "+-*/^)":
            raise ValueError("no number")
        return (
            Fraction(int(token, 16)) if token[:2].lower() == "0x" else Fraction(token)
        )


def _bounded(value: Fraction) -> Fraction:
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > _MOST_BITS:
        raise ValueError("too large")
    return value


def integer_value(
    text: str, what: str, least: int | None = None, most: int | None = None
) -> int:
    """Return the integer value of a text.

    Raises `NotSupported` if it is not an integer from ``least`` to ``most``; ``what``
    names it.
    """
    plain = (
        int(text)
        if text.isascii() and text.isdigit() and len(text) < _PLAIN
        else _integer(text)
    )
    if (
        plain is None
        or (least is not None and plain < least)
        or (most is not None and plain > most)
    ):
        raise NotSupported(f"{what} is `{line(text, 60)}`")
    return plain


def _integer(text: str) -> int | None:
    try:
        value = evaluate(text)
    except ValueError:
        return None
    return int(value) if value.denominator == 1 else None


def encoded_value(value: int, code: str, bits: int) -> int | None:
    """Return the raw value of a number in an integer encoding, or None if it does not
    fit.

    The raw value is signed for two's complement. For other encodings it consists of the
    transmitted bits.
    """
    if code in (TWOS, UNSIGNED):
        low, high = integer_range(bits, code == TWOS)
        return value if low <= value <= high else None
    if code in ("BCD", "packedBCD"):
        width = 8 if code == "BCD" else 4
        if value < 0 or len(str(value)) > bits // width:
            return None
        return sum(
            int(digit) << width * place
            for place, digit in enumerate(reversed(str(value)))
        )
    # One's complement and sign-magnitude have symmetric ranges.
    if abs(value) >= 1 << bits - 1:
        return None
    if value >= 0:
        return value
    # One's complement: the inverted bits of the magnitude.
    return (
        (1 << bits - 1 | -value) if code == "signMagnitude" else (1 << bits) - 1 + value
    )
