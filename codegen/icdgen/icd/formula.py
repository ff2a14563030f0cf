"""Exact formulas: text -> rational coefficients; of a line, factor and offset. No float ever enters."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from itertools import product, zip_longest
from typing import NamedTuple

MAX_LENGTH = 1000
MAX_DEGREE = 15
MAX_DEPTH = 50
MAX_DIGITS = 40
MAX_EXPONENT = 999
MAX_POWER_BITS = 4000

_TOKEN = re.compile(
    r"\s*(?:(?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]{1,2})?)|(?P<name>[A-Za-z]+)|(?P<op>[-+*/^()=]))"
)


class FormulaError(ValueError):
    """The text is not such a formula; the message says why in a user's words."""


class Scale(NamedTuple):
    """physical = raw * factor + offset; factor is never zero."""

    factor: Fraction
    offset: Fraction = Fraction(0)

    def __hash__(self) -> int:
        return hash(self[0].as_integer_ratio())  # few differ by the offset alone; a fraction's own is a modular inverse

    def physical(self, raw: int | Fraction) -> Fraction:
        a, b = self.factor, self.offset  # put together in one step: it is done for each value of each vector
        top = raw.numerator * a.numerator * b.denominator + b.numerator * a.denominator * raw.denominator
        return Fraction(top, raw.denominator * a.denominator * b.denominator)

    def raw(self, physical: Fraction) -> Fraction:
        return (physical - self.offset) / self.factor


RAW = Scale(Fraction(1))  # the raw value is the physical one


_Polynomial = tuple[Fraction, ...]  # its coefficients, the constant first; the last one is not 0, but for a constant


def parse(text: str) -> Scale:
    """``raw*0.01``, ``raw*2^-19``, ``(raw - 32)*5/9`` or, solved for raw, ``raw = value*1000.0``. Raises `FormulaError`."""
    found = coefficients(text)
    if len(found) > 2:
        raise FormulaError("it is not linear in `raw`")
    return Scale(found[1], found[0])


def coefficients(text: str) -> tuple[Fraction, ...]:
    """Those of the physical value as a polynomial in ``raw``, the constant first; two or more. Raises `FormulaError`."""
    if len(text) > MAX_LENGTH:
        raise FormulaError(f"it is longer than {MAX_LENGTH} characters")
    tokens = _tokens(text)
    variable = "raw"
    if tokens[:2] == ["raw", "="]:
        tokens, variable = tokens[2:], "value"
    elif tokens[:2] == ["value", "="]:
        tokens = tokens[2:]
    if "=" in tokens:
        raise FormulaError("`=` may only follow a leading `raw` or `value`")
    parser = _Parser(tokens, variable)
    found = parser.sum()
    if parser.rest:
        raise FormulaError(f"`{parser.rest[0]}` is not expected there")
    if len(found) == 1:
        raise FormulaError(f"it does not depend on `{variable}`")
    if variable == "raw":
        return found
    if len(found) > 2:
        raise FormulaError("it is not linear in `value`, so it cannot be solved for it")
    constant, slope = found
    return -constant / slope, 1 / slope


def is_inverse(text: str) -> bool:
    """Whether the formula gives the raw value from the physical one."""
    return re.match(r"\s*raw\s*=", text) is not None


def _tokens(text: str) -> list[str]:
    tokens, at = [], 0
    text = text.rstrip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise FormulaError(f"`{text[at:].strip()[0]}` is not part of a formula")
        token = match.group().strip()
        if match["number"] and len(token) > MAX_DIGITS:
            raise FormulaError(f"a number has more than {MAX_DIGITS} digits")
        tokens.append(token)
        at = match.end()
    if not tokens:
        raise FormulaError("it is empty")
    return tokens


class Tokens:
    """What a parser has not read yet."""

    def __init__(self, tokens: list[str]) -> None:
        self.rest = tokens
        self.depth = 0  # of parentheses and signs

    def take(self) -> str:
        """The next one. Raises `FormulaError` at the end."""
        if not self.rest:
            raise FormulaError("it ends too early")
        token, self.rest = self.rest[0], self.rest[1:]
        return token


class _Parser(Tokens):
    """Recursive descent over + - * / ^ and parentheses; every value is a polynomial in the variable."""

    def __init__(self, tokens: list[str], variable: str) -> None:
        super().__init__(tokens)
        self.variable = variable

    def sum(self) -> _Polynomial:
        left = self.product()
        while self.rest and self.rest[0] in "+-":
            sign = 1 if self.take() == "+" else -1
            right = self.product()
            both = zip_longest(left, right, fillvalue=Fraction(0))
            left = _shortened([one + sign * other for one, other in both])
        return left

    def product(self) -> _Polynomial:
        left = self.unary()
        while self.rest and self.rest[0] in "*/":
            if self.take() == "*":
                left = self.times(left, self.unary())
            else:
                right = self.unary()
                if len(right) > 1:
                    raise FormulaError(f"it divides by `{self.variable}`")
                if right[0] == 0:
                    raise FormulaError("it divides by zero")
                left = self.times(left, (1 / right[0],))
        return left

    def times(self, left: _Polynomial, right: _Polynomial) -> _Polynomial:
        if len(left) + len(right) - 2 > MAX_DEGREE:
            raise FormulaError(f"a power of `{self.variable}` is above {MAX_DEGREE}")
        found = [Fraction(0)] * (len(left) + len(right) - 1)
        for (i, one), (j, other) in product(enumerate(left), enumerate(right)):
            found[i + j] += one * other
        if any(max(abs(one.numerator), one.denominator).bit_length() > MAX_POWER_BITS for one in found):
            raise FormulaError("a coefficient is too large to be meant")
        return _shortened(found)

    def unary(self) -> _Polynomial:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise FormulaError(f"more than {MAX_DEPTH} parentheses or signs are open at once")
        token = self.take()
        found = tuple(-one for one in self.unary()) if token == "-" else self.power(self.primary(token))
        self.depth -= 1
        return found

    def power(self, base: _Polynomial) -> _Polynomial:
        """What ``base`` is raised to follows, if anything: a whole number."""
        if not self.rest or self.rest[0] != "^":
            return base
        self.take()
        sign = self.take() if self.rest[:1] == ["-"] else ""
        token = self.take()
        if not token.isdigit() or int(token) > MAX_EXPONENT:
            raise FormulaError(f"what stands behind `^` is not a whole number up to {MAX_EXPONENT}")
        if self.rest[:1] == ["^"]:
            raise FormulaError("`^` stands twice in a row; use parentheses")
        if len(base) > 1:
            if sign:
                raise FormulaError(f"it divides by `{self.variable}`")
            found: _Polynomial = (Fraction(1),)
            for _ in range(int(token)):
                found = self.times(found, base)
            return found
        if sign and not base[0]:
            raise FormulaError("it divides by zero")
        size = max(abs(base[0].numerator), base[0].denominator).bit_length()
        if size * int(token) > MAX_POWER_BITS:
            raise FormulaError("a power is too large to be meant")
        return (base[0] ** int(sign + token),)

    def primary(self, token: str) -> _Polynomial:
        if token == "(":
            inner = self.sum()
            if self.take() != ")":
                raise FormulaError("a parenthesis is not closed")
            return inner
        if token == self.variable:
            return Fraction(0), Fraction(1)
        if token[0].isdigit():
            return (Fraction(token),)
        if token.isalpha():
            raise FormulaError(f"`{token}` is unknown; the variable is `{self.variable}`")
        raise FormulaError(f"`{token}` is not expected there")


def _shortened(found: list[Fraction]) -> _Polynomial:
    while len(found) > 1 and not found[-1]:
        found.pop()
    return tuple(found)


parse_cached = lru_cache(maxsize=1024)(parse)
