"""Arithmetic expressions in text: the grammar that formulas of fields and derived values share.

In: a text such as ``(raw - 32)*5/9`` or ``W*10^W_SF``. `evaluate` splits it into tokens and reads them by recursive
descent. An `Arithmetic` says which names there are and what operators mean: `icdgen.icd.formula` computes polynomials
of fractions, `icdgen.icd.derived` the steps of a computation in doubles.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator
from fractions import Fraction
from typing import Generic, NamedTuple, TypeVar

MAX_DEPTH = 50
MAX_DIGITS = 40

_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]{1,2})?")
_OPERATORS = "+-*/^()"

Value = TypeVar("Value")


class FormulaError(ValueError):
    """The text is not a formula. The message says why, as the end of a sentence."""


class Token(NamedTuple):
    """A number, a name, or an operator or parenthesis."""

    text: str
    is_name: bool = False

    @property
    def is_number(self) -> bool:
        """Whether it is a number; names can begin with a digit."""
        return not self.is_name and self.text[0].isdigit()

    def is_operator(self, operators: str) -> bool:
        """Return whether it is one of these operators; names can look like operators."""
        return not self.is_name and self.text in operators


class Arithmetic(ABC, Generic[Value]):
    """Meaning of the parts of an expression. All methods raise `FormulaError`."""

    @abstractmethod
    def name_at(self, text: str, at: int) -> str:
        """Return the longest name that begins at a character of the text; empty if none does."""

    @abstractmethod
    def unreadable(self, text: str, at: int) -> FormulaError:
        """Return the error for a character at which no token begins."""

    @abstractmethod
    def number(self, number: Fraction) -> Value:
        """Return the value of a number."""

    @abstractmethod
    def variable(self, name: str) -> Value:
        """Return the value of a name."""

    @abstractmethod
    def operation(self, operator: str, left: Value, right: Value) -> Value:
        """Return a sum, difference, product or quotient."""

    @abstractmethod
    def power(self, base: Value, exponent: Token, is_negative: bool) -> Value:
        """Return a power; `exponent` is the token behind `^` and its sign, whatever it is."""


def evaluate(text: str, arithmetic: Arithmetic[Value]) -> Value:
    """Return the value of an expression. Raises `FormulaError`."""
    parser = _Parser(list(_tokens(text, arithmetic)), arithmetic)
    value = parser.sum()
    if parser.rest:
        raise FormulaError(f"`{parser.rest[0].text}` is not expected there")
    return value


def _tokens(text: str, arithmetic: Arithmetic[Value]) -> Iterator[Token]:
    """Yield numbers, operators and names. Where a name and a number begin, the longer one is meant."""
    at = 0
    while at < len(text):
        if text[at].isspace():
            at += 1
            continue
        number = _NUMBER.match(text, at)
        plain = number.group() if number else text[at] if text[at] in _OPERATORS else ""
        name = arithmetic.name_at(text, at)
        token = Token(name, is_name=True) if len(name) > len(plain) else Token(plain)
        if not token.text:
            raise arithmetic.unreadable(text, at)
        if token.is_number and len(plain) > MAX_DIGITS:
            raise FormulaError(f"a number has more than {MAX_DIGITS} digits")
        yield token
        at += len(token.text)


class _Parser(Generic[Value]):
    """Recursive descent. A minus sign binds less than `^` and more than `*`."""

    def __init__(self, tokens: list[Token], arithmetic: Arithmetic[Value]) -> None:
        self.rest = tokens
        self.arithmetic = arithmetic
        self.depth = 0  # of parentheses and signs

    def take(self) -> Token:
        """Return the next token."""
        if not self.rest:
            raise FormulaError("it ends too early")
        return self.rest.pop(0)

    def is_next(self, operators: str) -> bool:
        """Return whether the next token is one of these operators."""
        return bool(self.rest) and self.rest[0].is_operator(operators)

    def sum(self) -> Value:
        """Read terms with + and - between them."""
        left = self.product()
        while self.is_next("+-"):
            left = self.arithmetic.operation(self.take().text, left, self.product())
        return left

    def product(self) -> Value:
        """Read factors with * and / between them."""
        left = self.signed()
        while self.is_next("*/"):
            left = self.arithmetic.operation(self.take().text, left, self.signed())
        return left

    def signed(self) -> Value:
        """Read minus signs and a power."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise FormulaError(f"more than {MAX_DEPTH} parentheses or signs are open at once")
        token = self.take()
        if token.is_operator("-"):
            value = self.arithmetic.operation("-", self.arithmetic.number(Fraction(0)), self.signed())
        else:
            value = self.power(self.primary(token))
        self.depth -= 1
        return value

    def power(self, base: Value) -> Value:
        """Read what a base is raised to, if `^` follows it."""
        if not self.is_next("^"):
            return base
        self.take()
        is_negative = self.is_next("-")
        if is_negative:
            self.take()
        exponent = self.take()
        if self.is_next("^"):
            raise FormulaError("`^` follows `^`; use parentheses")
        return self.arithmetic.power(base, exponent, is_negative)

    def primary(self, token: Token) -> Value:
        """Read a number, a name, or what parentheses enclose."""
        if token.is_name:
            return self.arithmetic.variable(token.text)
        if token.is_number:
            return self.arithmetic.number(Fraction(token.text))
        if token.text != "(":
            raise FormulaError(f"`{token.text}` is not expected there")
        value = self.sum()
        if not self.take().is_operator(")"):
            raise FormulaError("a parenthesis is not closed")
        return value
