"""Parser of arithmetic expressions, such as ``(raw - 32)*5/9`` or ``W*10^W_SF``, for
formulas and derived values.

`evaluate` splits a text into tokens and parses them by recursive descent. An
`Arithmetic` defines the valid names and the meaning of the operators:
`icdgen.icd.formula` computes polynomials of fractions, `icdgen.icd.derived` the steps
of a computation in doubles.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator
from fractions import Fraction
from typing import Generic, TypeVar

from icdgen.frozen import NamedTuple

# Limits on input that an ICD never needs, so that a hostile text cannot exhaust the
# stack or the memory.
MAX_DEPTH = 50
MAX_DIGITS = 40

# Two digits of an exponent limit the size of the exact fraction to about 10^139.
_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]{1,2})?")
_OPERATORS = "+-*/^()"

Value = TypeVar("Value")


class FormulaError(ValueError):
    """A text is not a valid formula.

    The message is the end of a sentence, such as "it divides by zero".
    """


class Token(NamedTuple):
    """A number, a name, or an operator or parenthesis."""

    text: str
    is_name: bool = False

    @property
    def is_number(self) -> bool:
        """Whether the token is a number; names can begin with a digit."""
        return not self.is_name and self.text[0].isdigit()

    def is_operator(self, operators: str) -> bool:
        """Return whether the token is one of these operators; names can look like
        operators.
        """
        return not self.is_name and self.text in operators


class Arithmetic(ABC, Generic[Value]):
    """Meaning of the parts of an expression. All methods raise `FormulaError`."""

    @abstractmethod
    def name_at(self, text: str, at: int) -> str:
        """Return the longest name that begins at an index of the text; empty if no name
        begins there.
        """

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
        """Return a power; `exponent` is the token after `^` and the sign, of any kind."""


def evaluate(text: str, arithmetic: Arithmetic[Value]) -> Value:
    """Return the value of an expression. Raises `FormulaError`."""
    parser = _Parser(list(_tokens(text, arithmetic)), arithmetic)
    value = parser.sum()
    if parser.tokens:
        raise FormulaError(f"`{parser.tokens[0].text}` is not expected there")
    return value


def _tokens(text: str, arithmetic: Arithmetic[Value]) -> Iterator[Token]:
    """Yield numbers, operators and names.

    If both a number and a name begin at a character, the longer one is used.
    """
    at = 0
    while at < len(text):
        if text[at].isspace():
            at += 1
            continue
        number = _NUMBER.match(text, at)
        if number:
            plain = number.group()
        else:
            plain = text[at] if text[at] in _OPERATORS else ""
        name = arithmetic.name_at(text, at)
        token = Token(name, is_name=True) if len(name) > len(plain) else Token(plain)
        if not token.text:
            raise arithmetic.unreadable(text, at)
        if token.is_number and len(plain) > MAX_DIGITS:
            raise FormulaError(f"a number has more than {MAX_DIGITS} digits")
        yield token
        at += len(token.text)


class _Parser(Generic[Value]):
    """Recursive-descent parser.

    A minus sign has a lower precedence than `^` and a higher one than `*`.
    """

    def __init__(self, tokens: list[Token], arithmetic: Arithmetic[Value]) -> None:
        self.tokens = tokens  # not yet consumed
        self.arithmetic = arithmetic
        self.depth = 0  # open parentheses and signs

    def take(self) -> Token:
        """Consume and return the next token."""
        if not self.tokens:
            raise FormulaError("it ends too early")
        return self.tokens.pop(0)

    def is_next(self, operators: str) -> bool:
        """Return whether the next token is one of these operators."""
        return bool(self.tokens) and self.tokens[0].is_operator(operators)

    def sum(self) -> Value:
        """Parse terms separated by + and -."""
        left = self.product()
        while self.is_next("+-"):
            left = self.arithmetic.operation(self.take().text, left, self.product())
        return left

    def product(self) -> Value:
        """Parse factors separated by * and /."""
        left = self.signed()
        while self.is_next("*/"):
            left = self.arithmetic.operation(self.take().text, left, self.signed())
        return left

    def signed(self) -> Value:
        """Parse minus signs and a power."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise FormulaError(
                f"more than {MAX_DEPTH} parentheses or signs are open at once"
            )
        token = self.take()
        if token.is_operator("-"):
            # 0 - x, not a negation of its own: for x = 0.0 it gives +0.0 in all
            # languages.
            value = self.arithmetic.operation(
                "-", self.arithmetic.number(Fraction(0)), self.signed()
            )
        else:
            value = self.power(self.primary(token))
        self.depth -= 1
        return value

    def power(self, base: Value) -> Value:
        """Parse the exponent of a base, if `^` follows."""
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
        """Parse a number, a name, or an expression in parentheses."""
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
