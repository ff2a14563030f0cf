"""Exact formulas: convert text to rational coefficients, or to factor and offset if it
is linear.

Uses no floats. `parse` returns the `Scale` of a linear formula such as ``raw*0.01``,
`coefficients` the coefficients of a polynomial up to degree 15. Both raise
`FormulaError`. A formula for the raw value (``raw = value*1000``) is inverted, so it
must be linear. `expression` has the grammar; `curve` computes in doubles.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from itertools import product, zip_longest
from typing import TypeAlias

from icdgen.frozen import NamedTuple
from icdgen.icd.expression import Arithmetic, Token, evaluate
from icdgen.icd.expression import FormulaError as FormulaError

# Limits on hostile text: `9^999` repeated would otherwise fill the memory. 10^999 has
# 3,319 bits, so the limit of bits admits it.
MAX_LENGTH = 1000
MAX_DEGREE = 15
MAX_EXPONENT = 999
MAX_POWER_BITS = 4000

_SOLVED_FOR = re.compile(r"\s*(raw|value)\s*=")
_WORD = re.compile(r"[A-Za-z]+")


class Scale(NamedTuple):
    """physical = raw * factor + offset; factor is never zero."""

    factor: Fraction
    offset: Fraction = Fraction(0)

    def __hash__(self) -> int:
        # Fraction.__hash__ computes a modular inverse, which is slow. Few scales differ
        # in the offset alone.
        return hash(self[0].as_integer_ratio())

    def physical(self, raw: int | Fraction) -> Fraction:
        """Return the physical value of a raw value."""
        # One division instead of a sum and a product of Fractions: this runs for each
        # value of each vector.
        a, b = self.factor, self.offset
        top = (
            raw.numerator * a.numerator * b.denominator
            + b.numerator * a.denominator * raw.denominator
        )
        return Fraction(top, raw.denominator * a.denominator * b.denominator)

    def raw(self, physical: Fraction) -> Fraction:
        """Return the raw value of a physical value, without rounding."""
        return (physical - self.offset) / self.factor


RAW = Scale(Fraction(1))  # the physical value is the raw value


_Polynomial: TypeAlias = tuple[Fraction, ...]
"""Coefficients, the constant first.

The last coefficient is not 0, except in a constant polynomial.
"""


@lru_cache(maxsize=1024)
def parse(text: str) -> Scale:
    """Return the scale of a linear formula. Raises `FormulaError`.

    Examples: ``raw*0.01``, ``raw*2^-19``, ``(raw - 32)*5/9`` or, solved for raw, ``raw
    = value*1000.0``.
    """
    polynomial = coefficients(text)
    if len(polynomial) > 2:
        raise FormulaError("it is not linear in `raw`")
    return Scale(polynomial[1], polynomial[0])


def coefficients(text: str) -> tuple[Fraction, ...]:
    """Return the coefficients of the physical value as a polynomial in ``raw``, the
    constant first.

    There are two or more. Raises `FormulaError`.
    """
    if len(text) > MAX_LENGTH:
        raise FormulaError(f"it is longer than {MAX_LENGTH} characters")
    if not text.strip():
        raise FormulaError("it is empty")
    prefix = _SOLVED_FOR.match(text)
    variable = "value" if prefix and prefix[1] == "raw" else "raw"
    polynomial = evaluate(
        text[prefix.end() :] if prefix else text, _Polynomials(variable)
    )
    if len(polynomial) == 1:
        raise FormulaError(f"it does not depend on `{variable}`")
    if variable == "raw":
        return polynomial
    if len(polynomial) > 2:
        raise FormulaError("it is not linear in `value`, so it cannot be solved for it")
    # raw = constant + slope * value, solved for value.
    constant, slope = polynomial
    return -constant / slope, 1 / slope


def is_inverse(text: str) -> bool:
    """Return whether the formula computes the raw value from the physical value."""
    prefix = _SOLVED_FOR.match(text)
    return prefix is not None and prefix[1] == "raw"


class _Polynomials(Arithmetic[_Polynomial]):
    """Arithmetic of polynomials in one variable, `raw` or `value`."""

    def __init__(self, variable: str) -> None:
        self.only_variable = variable

    def name_at(self, text: str, at: int) -> str:
        """Return the word at `at`; `variable` reports words other than the variable."""
        word = _WORD.match(text, at)
        return word.group() if word else ""

    def unreadable(self, text: str, at: int) -> FormulaError:
        """Return the error for a character that is not part of a formula."""
        if text[at] == "=":
            return FormulaError("`=` may only follow a leading `raw` or `value`")
        return FormulaError(f"`{text[at]}` is not part of a formula")

    def number(self, number: Fraction) -> _Polynomial:
        """Return a constant."""
        return (number,)

    def variable(self, name: str) -> _Polynomial:
        """Return the variable itself."""
        if name != self.only_variable:
            raise FormulaError(
                f"`{name}` is unknown; the variable is `{self.only_variable}`"
            )
        return Fraction(0), Fraction(1)

    def operation(
        self, operator: str, left: _Polynomial, right: _Polynomial
    ) -> _Polynomial:
        """Return a sum, a difference, a product, or a quotient by a constant."""
        if operator in "+-":
            sign = 1 if operator == "+" else -1
            return _shortened(
                [
                    a + sign * b
                    for a, b in zip_longest(left, right, fillvalue=Fraction(0))
                ]
            )
        if operator == "*":
            return self.times(left, right)
        if len(right) > 1:
            raise FormulaError(f"it divides by `{self.only_variable}`")
        if right[0] == 0:
            raise FormulaError("it divides by zero")
        return self.times(left, (1 / right[0],))

    def times(self, left: _Polynomial, right: _Polynomial) -> _Polynomial:
        """Return a product."""
        if len(left) + len(right) - 2 > MAX_DEGREE:
            raise FormulaError(
                f"a power of `{self.only_variable}` is above {MAX_DEGREE}"
            )
        terms = [Fraction(0)] * (len(left) + len(right) - 1)
        for (i, a), (j, b) in product(enumerate(left), enumerate(right)):
            terms[i + j] += a * b
        if any(
            max(abs(term.numerator), term.denominator).bit_length() > MAX_POWER_BITS
            for term in terms
        ):
            raise FormulaError("a coefficient is too large to be meant")
        return _shortened(terms)

    def power(
        self, base: _Polynomial, exponent: Token, is_negative: bool
    ) -> _Polynomial:
        """Return a power with an integer exponent; only a constant can have a negative
        exponent.
        """
        if not exponent.text.isdigit() or int(exponent.text) > MAX_EXPONENT:
            raise FormulaError(
                f"the exponent after `^` is not a whole number up to {MAX_EXPONENT}"
            )
        number = int(exponent.text)
        if len(base) > 1:
            if is_negative:
                raise FormulaError(f"it divides by `{self.only_variable}`")
            result: _Polynomial = (Fraction(1),)
            for _ in range(number):
                result = self.times(result, base)
            return result
        return (power_of_number(base[0], -number if is_negative else number),)


def power_of_number(base: Fraction, exponent: int) -> Fraction:
    """Return an exact power. Raises `FormulaError` if it has too many digits."""
    if exponent < 0 and not base:
        raise FormulaError("it divides by zero")
    size = max(abs(base.numerator), base.denominator).bit_length()
    if size * abs(exponent) > MAX_POWER_BITS:
        raise FormulaError("a power is too large to be meant")
    return base**exponent


def _shortened(terms: list[Fraction]) -> _Polynomial:
    """Return a polynomial without highest terms that are zero."""
    while len(terms) > 1 and not terms[-1]:
        terms.pop()
    return tuple(terms)
