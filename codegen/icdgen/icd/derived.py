"""Values that are derived from several fields of a message: the text of a formula -> steps in doubles.

What each language computes is defined here to the last bit. Numbers that no field has part in are exact and rounded once, to
a double; each step takes two doubles and rounds its result to one. A step behind another one may take what that gave.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

from icdgen.icd.formula import MAX_DEGREE, MAX_DEPTH, MAX_DIGITS, MAX_EXPONENT, MAX_POWER_BITS, FormulaError, Tokens
from icdgen.suggest import close_to

_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]{1,2})?")
_WORDS = re.compile(r"[^\W\d](?:[\w .\[\]]*[\w\]])?")  # what looks like a name


class Operation(NamedTuple):
    """``left operator right``; both are places in the row of values, to which it adds one."""

    operator: str  # one of + - * / ^
    left: int
    right: int


class Derivation(NamedTuple):
    """How a value is derived. The row of values begins with those of the fields and the numbers; its last one is the result."""

    fields: tuple[str, ...]  # names: of each its physical value, of one without a formula its raw one, as a double
    numbers: tuple[float, ...]
    steps: tuple[Operation, ...]

    def double(self, values: Sequence[float]) -> float:
        """The result for the values of `fields`; NaN is always the same."""
        row = [*values, *self.numbers]
        for operator, left, right in self.steps:
            row.append(_OPERATORS[operator](row[left], row[right]))
        return row[-1] if row[-1] == row[-1] else math.nan

    def sense(self, names: Mapping[str, str]) -> str:
        """The same for formulas whose terms or factors change places; ``names`` has those of fields that are called otherwise."""
        row = [f"`{names.get(name, name)}`" for name in self.fields] + list(map(repr, self.numbers))
        for operator, *places in self.steps:
            sides = [row[place] for place in places]
            sides = sorted(sides) if operator in "+*" else sides  # they commute
            row.append(f"({operator.join(sides)})")
        return row[-1]


def quotient(one: float, other: float) -> float:
    """As IEEE 754 divides: by zero, too."""
    if other:
        return one / other
    return math.nan if not one or one != one else math.copysign(math.inf, one) * math.copysign(1.0, other)


def power(base: float, exponent: float) -> float:
    """By squaring, from the lowest bit of a whole exponent on; of a negative one the reciprocal."""
    left, found = abs(int(exponent)), 1.0
    while left:
        if left & 1:
            found *= base
        base *= base
        left >>= 1
    return quotient(1.0, found) if exponent < 0 else found


_OPERATORS = {
    "+": float.__add__,
    "-": float.__sub__,
    "*": float.__mul__,
    "/": quotient,
    "^": power,
}

_Node = Fraction | str | tuple[str, Any, Any]  # a number, a field, or an operator with what stands on both sides


def parse(text: str, names: Collection[str]) -> Derivation:
    """``Lon + Lon HP*1e-2``, ``W*10^W_SF``, over fields of these names. Raises `icdgen.icd.formula.FormulaError`."""
    return _parse_cached(text, frozenset(names))


@lru_cache(maxsize=1024)
def _parse_cached(text: str, names: frozenset[str]) -> Derivation:
    parser = _Parser(_tokens(text, names))
    found = parser.sum()
    if parser.rest:
        raise FormulaError(f"`{parser.rest[0]}` is not expected there")
    if isinstance(found, Fraction):
        raise FormulaError("it does not depend on a field")
    return _in_steps(found)


class _Name(str):
    """A token that is the name of a field."""


def _tokens(text: str, names: frozenset[str]) -> list[str]:
    """Numbers, operators, and the names of fields: of several the longest, whatever characters it has."""
    tokens: list[str] = []
    known, at, text = sorted(names, key=len, reverse=True), 0, text.rstrip()
    while at < len(text):
        if text[at].isspace():
            at += 1
            continue
        number = _NUMBER.match(text, at)
        plain = number.group() if number else text[at] if text[at] in "+-*/^()" else ""
        name = next((one for one in known if text.startswith(one, at) and not _goes_on(text, at + len(one), one)), "")
        token: str = _Name(name) if len(name) > len(plain) else plain
        if not token:
            raise FormulaError(_unknown(text, at, names))
        if token is plain and len(plain) > MAX_DIGITS:
            raise FormulaError(f"a number has more than {MAX_DIGITS} digits")
        tokens.append(token)
        at += len(token)
    return tokens


def _goes_on(text: str, end: int, name: str) -> bool:
    """Whether the word in which a name ends goes on behind it."""
    return _is_word(name[-1]) and end < len(text) and (_is_word(text[end]) or text[end] == "[")


def _is_word(letter: str) -> bool:
    return letter.isalnum() or letter == "_"


def _unknown(text: str, at: int, names: frozenset[str]) -> str:
    words = _WORDS.match(text, at)
    if words is None:
        return f"`{text[at]}` is not part of a formula"
    close = close_to(words.group(), names)
    return f"there is no field `{words.group()}`" + (f"; did you mean `{close}`?" if close else "")


class _Parser(Tokens):
    """Recursive descent. What no field has part in is computed at once, exactly."""

    def sum(self) -> _Node:
        left = self.product()
        while self.rest and _is_operator(self.rest[0], "+-"):
            left = _joined(self.take(), left, self.product())
        return left

    def product(self) -> _Node:
        left = self.unary()
        while self.rest and _is_operator(self.rest[0], "*/"):
            left = _joined(self.take(), left, self.unary())
        return left

    def unary(self) -> _Node:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise FormulaError(f"more than {MAX_DEPTH} parentheses or signs are open at once")
        token = self.take()
        if _is_operator(token, "-"):
            found = _joined("-", Fraction(0), self.unary())
        else:
            found = self.power(self.primary(token))
        self.depth -= 1
        return found

    def power(self, base: _Node) -> _Node:
        if not self.rest or not _is_operator(self.rest[0], "^"):
            return base
        self.take()
        is_negative = bool(self.rest) and _is_operator(self.rest[0], "-")
        token = self.take() if not is_negative else (self.take(), self.take())[1]
        if self.rest and _is_operator(self.rest[0], "^"):
            raise FormulaError("`^` stands twice in a row; use parentheses")
        if isinstance(token, _Name) and not is_negative:
            return "^", base, str(token)
        if isinstance(token, _Name):
            raise FormulaError(f"`^-{token}` has a sign before a field; divide by the power instead")
        most = MAX_EXPONENT if isinstance(base, Fraction) else MAX_DEGREE
        if not token.isdigit() or int(token) > most:
            raise FormulaError(f"what stands behind `^` is neither a field nor a whole number up to {most}")
        return _joined("^", base, Fraction(-int(token) if is_negative else int(token)))

    def primary(self, token: str) -> _Node:
        if isinstance(token, _Name):
            return str(token)
        if token == "(":
            inner = self.sum()
            if self.take() != ")":
                raise FormulaError("a parenthesis is not closed")
            return inner
        if token[0].isdigit():
            return Fraction(token)
        raise FormulaError(f"`{token}` is not expected there")


def _is_operator(token: str, which: str) -> bool:
    return not isinstance(token, _Name) and token in which


def _joined(operator: str, left: _Node, right: _Node) -> _Node:
    if operator == "/" and isinstance(right, Fraction) and not right:
        raise FormulaError("it divides by zero")
    if not isinstance(left, Fraction) or not isinstance(right, Fraction):
        return operator, left, right
    if operator == "^":
        if right < 0 and not left:
            raise FormulaError("it divides by zero")
        if max(abs(left.numerator), left.denominator).bit_length() * abs(right) > MAX_POWER_BITS:
            raise FormulaError("a power is too large to be meant")
        return left ** int(right)
    found = {"+": left + right, "-": left - right, "*": left * right}.get(operator)
    return left / right if found is None else found


def _in_steps(tree: _Node) -> Derivation:
    """The row of values, and the steps in the order in which they stand: what is left of an operator comes first."""
    fields: dict[str, int] = {}
    numbers: dict[float, int] = {}
    steps: list[tuple[str, Any, Any]] = []

    def place(node: _Node) -> tuple[str, Any]:
        if isinstance(node, str):
            return "field", fields.setdefault(node, len(fields))
        if isinstance(node, Fraction):
            return "number", numbers.setdefault(_double(node), len(numbers))
        operator, left, right = node
        steps.append((operator, place(left), place(right)))
        return "step", len(steps) - 1

    place(tree)
    begin = {"field": 0, "number": len(fields), "step": len(fields) + len(numbers)}
    rows = (Operation(operator, *(begin[kind] + at for kind, at in sides)) for operator, *sides in steps)
    return Derivation(tuple(fields), tuple(numbers), tuple(rows))


def _double(number: Fraction) -> float:
    try:
        found = number.numerator / number.denominator
    except OverflowError:
        found = math.inf
    if math.isinf(found) or (number and not found):
        raise FormulaError("a number is too large or too small for a double")
    return found
