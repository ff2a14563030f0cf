"""Exact linear scale formulas: text -> rational factor and offset. No float ever enters."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

MAX_LENGTH = 200
MAX_DIGITS = 40
MAX_EXPONENT = 999
MAX_POWER_BITS = 4000

_TOKEN = re.compile(
    r"\s*(?:(?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]{1,2})?)|(?P<name>[A-Za-z]+)|(?P<op>[-+*/^()=]))"
)


class FormulaError(ValueError):
    """The text is not an exact linear formula; the message says why in a user's words."""


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


class _Linear(NamedTuple):
    slope: Fraction
    constant: Fraction


def parse(text: str) -> Scale:
    """``raw*0.01``, ``raw*2^-19``, ``(raw - 32)*5/9`` or, solved for raw, ``raw = value*1000.0``. Raises `FormulaError`."""
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
    line = parser.sum()
    if parser.rest:
        raise FormulaError(f"`{parser.rest[0]}` is not expected there")
    if line.slope == 0:
        raise FormulaError(f"it does not depend on `{variable}`")
    if variable == "raw":
        return Scale(line.slope, line.constant)
    return Scale(1 / line.slope, -line.constant / line.slope)


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


class _Parser:
    """Recursive descent over + - * / ^ and parentheses; every value is a linear function of the variable."""

    def __init__(self, tokens: list[str], variable: str) -> None:
        self.rest, self.variable = tokens, variable
        self.depth = 0

    def take(self) -> str:
        if not self.rest:
            raise FormulaError("it ends too early")
        token, self.rest = self.rest[0], self.rest[1:]
        return token

    def sum(self) -> _Linear:
        left = self.product()
        while self.rest and self.rest[0] in "+-":
            sign = 1 if self.take() == "+" else -1
            right = self.product()
            left = _Linear(left.slope + sign * right.slope, left.constant + sign * right.constant)
        return left

    def product(self) -> _Linear:
        left = self.unary()
        while self.rest and self.rest[0] in "*/":
            if self.take() == "*":
                right = self.unary()
                if left.slope and right.slope:
                    raise FormulaError(f"it is not linear in `{self.variable}`")
                by, line = (left.constant, right) if right.slope else (right.constant, left)
            else:
                right = self.unary()
                if right.slope:
                    raise FormulaError(f"it divides by `{self.variable}`, so it is not linear")
                if right.constant == 0:
                    raise FormulaError("it divides by zero")
                by, line = 1 / right.constant, left
            left = _Linear(line.slope * by, line.constant * by)
        return left

    def unary(self) -> _Linear:
        token = self.take()
        if token == "-":
            line = self.unary()
            return _Linear(-line.slope, -line.constant)
        return self.power(self.primary(token))

    def power(self, base: _Linear) -> _Linear:
        """What ``base`` is raised to follows, if anything: a whole number."""
        if not self.rest or self.rest[0] != "^":
            return base
        self.take()
        sign = self.take() if self.rest[:1] == ["-"] else ""
        token = self.take()
        if base.slope:
            raise FormulaError(f"it is not linear in `{self.variable}`")
        if not token.isdigit() or int(token) > MAX_EXPONENT:
            raise FormulaError(f"what stands behind `^` is not a whole number up to {MAX_EXPONENT}")
        if sign and not base.constant:
            raise FormulaError("it divides by zero")
        if self.rest[:1] == ["^"]:
            raise FormulaError("`^` stands twice in a row; use parentheses")
        size = max(abs(base.constant.numerator), base.constant.denominator).bit_length()
        if size * int(token) > MAX_POWER_BITS:
            raise FormulaError("a power is too large to be meant")
        return _Linear(Fraction(0), base.constant ** int(sign + token))

    def primary(self, token: str) -> _Linear:
        if token == "(":
            line = self.sum()
            if self.take() != ")":
                raise FormulaError("a parenthesis is not closed")
            return line
        if token == self.variable:
            return _Linear(Fraction(1), Fraction(0))
        if token[0].isdigit():
            return _Linear(Fraction(0), Fraction(token))
        if token.isalpha():
            raise FormulaError(f"`{token}` is unknown; the variable is `{self.variable}`")
        raise FormulaError(f"`{token}` is not expected there")


parse_cached = lru_cache(maxsize=1024)(parse)
