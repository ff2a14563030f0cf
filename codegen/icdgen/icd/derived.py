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
from typing import Any, NamedTuple, TypeAlias

from icdgen.icd.expression import Arithmetic, FormulaError, Token, evaluate
from icdgen.icd.formula import MAX_DEGREE, MAX_EXPONENT, power_of_number
from icdgen.suggest import close_to

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

_Tree: TypeAlias = "Fraction | str | tuple[str, _Tree, _Tree]"
"""A number, the name of a field, or an operator with its two operands."""


def parse(text: str, names: Collection[str]) -> Derivation:
    """``Lon + Lon HP*1e-2``, ``W*10^W_SF``, over fields of these names. Raises `icdgen.icd.formula.FormulaError`."""
    return _parse_cached(text, frozenset(names))


@lru_cache(maxsize=1024)
def _parse_cached(text: str, names: frozenset[str]) -> Derivation:
    tree = evaluate(text, _Trees(names))
    if isinstance(tree, Fraction):
        raise FormulaError("it does not depend on a field")
    return _in_steps(tree)


class _Trees(Arithmetic[_Tree]):
    """Arithmetic that keeps the operations on fields for later and computes the others at once, exactly."""

    def __init__(self, names: frozenset[str]) -> None:
        self.names = sorted(sorted(names), key=len, reverse=True)

    def name_at(self, text: str, at: int) -> str:
        """Return the longest name of a field, whatever characters it has."""
        matches = (name for name in self.names if text.startswith(name, at))
        return next((name for name in matches if not _continues(text, at + len(name), name)), "")

    def unreadable(self, text: str, at: int) -> FormulaError:
        """Return the error for a word that is no name of a field, or for a character that no formula has."""
        words = _WORDS.match(text, at)
        if words is None:
            return FormulaError(f"`{text[at]}` is not part of a formula")
        close = close_to(words.group(), sorted(self.names))
        return FormulaError(f"there is no field `{words.group()}`" + (f"; did you mean `{close}`?" if close else ""))

    def number(self, number: Fraction) -> _Tree:
        """Return the number."""
        return number

    def variable(self, name: str) -> _Tree:
        """Return the name of the field."""
        return name

    def operation(self, operator: str, left: _Tree, right: _Tree) -> _Tree:
        """Return the operation, or its result if no field has part in it."""
        if operator == "/" and isinstance(right, Fraction) and not right:
            raise FormulaError("it divides by zero")
        if not isinstance(left, Fraction) or not isinstance(right, Fraction):
            return operator, left, right
        match operator:
            case "+":
                return left + right
            case "-":
                return left - right
            case "*":
                return left * right
        return left / right

    def power(self, base: _Tree, exponent: Token, is_negative: bool) -> _Tree:
        """Return a power; the exponent is a whole number or a field."""
        if exponent.is_name:
            if is_negative:
                raise FormulaError(f"`^-{exponent.text}` has a sign before a field; divide by the power instead")
            return "^", base, exponent.text
        most = MAX_EXPONENT if isinstance(base, Fraction) else MAX_DEGREE
        if not exponent.text.isdigit() or int(exponent.text) > most:
            raise FormulaError(f"the exponent behind `^` is neither a field nor a whole number up to {most}")
        number = -int(exponent.text) if is_negative else int(exponent.text)
        return power_of_number(base, number) if isinstance(base, Fraction) else ("^", base, Fraction(number))


def _continues(text: str, end: int, name: str) -> bool:
    """Return whether the word in which a name ends continues behind it."""
    return _is_of_word(name[-1]) and end < len(text) and (_is_of_word(text[end]) or text[end] == "[")


def _is_of_word(letter: str) -> bool:
    return letter.isalnum() or letter == "_"


def _in_steps(tree: _Tree) -> Derivation:
    """Return the steps that compute a tree; those of the left operand of an operator come first."""
    fields: dict[str, int] = {}
    numbers: dict[float, int] = {}
    steps: list[tuple[str, Any, Any]] = []

    def place(node: _Tree) -> tuple[str, int]:
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
    """Return the nearest double."""
    try:
        double = number.numerator / number.denominator
    except OverflowError:
        double = math.inf
    if math.isinf(double) or (number and not double):
        raise FormulaError("a number is too large or too small for a double")
    return double
