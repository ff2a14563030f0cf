"""Derived values: converts a formula over several fields of a message to steps in
doubles.

This module defines the result to the last bit for all languages. Subexpressions without
fields are computed exactly and rounded once to a double. Each step takes two doubles,
which can be results of earlier steps, and rounds its result to a double.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from icdgen.frozen import NamedTuple
from icdgen.icd.expression import Arithmetic, FormulaError, Token, evaluate
from icdgen.icd.formula import MAX_DEGREE, MAX_EXPONENT, power_of_number
from icdgen.suggest import close_to

# Text that looks like the name of a field, for an error message.
_WORDS = re.compile(r"[^\W\d](?:[\w .\[\]]*[\w\]])?")


class Operation(NamedTuple):
    """Step ``left operator right``. Its result is appended to the row of values."""

    operator: str  # one of + - * / ^
    left: int  # index in the row of values
    right: int


class Derivation(NamedTuple):
    """Computation of a derived value.

    It works on a row of values, which begins with the values of the fields and the
    numbers. Each step appends a value. The last value is the result.
    """

    # Names of the operands: physical values, or raw values without a formula, as
    # doubles.
    fields: tuple[str, ...]
    numbers: tuple[float, ...]
    steps: tuple[Operation, ...]

    def double(self, values: Sequence[float]) -> float:
        """Return the result for the values of `fields`. All NaNs are `math.nan`."""
        row = [*values, *self.numbers]
        for operator, left, right in self.steps:
            # One rounded operation per step. A compiler that fuses a product and a sum
            # (FMA, C99 7.12.2 FP_CONTRACT) would differ in the last bit.
            row.append(_OPERATORS[operator](row[left], row[right]))
        return row[-1] if row[-1] == row[-1] else math.nan

    def sense(self, names: Mapping[str, str]) -> str:
        """Return a canonical text, equal for formulas that differ only in the order of
        terms or factors.

        ``names`` has new names of fields that were renamed.
        """
        row = [f"`{names.get(name, name)}`" for name in self.fields] + list(
            map(repr, self.numbers)
        )
        for operator, *places in self.steps:
            sides = [row[place] for place in places]
            # Sums and products of two doubles commute.
            sides = sorted(sides) if operator in "+*" else sides
            row.append(f"({operator.join(sides)})")
        return row[-1]


def quotient(dividend: float, divisor: float) -> float:
    """Return a quotient as IEEE 754 defines it, also for a divisor of zero, for which
    Python raises.
    """
    if divisor:
        return dividend / divisor
    if not dividend or dividend != dividend:
        return math.nan
    return math.copysign(math.inf, dividend) * math.copysign(1.0, divisor)


def power(base: float, exponent: float) -> float:
    """Return a power with an integer exponent, by repeated squaring from the lowest bit
    of the exponent on.

    Every language uses this algorithm, because the `pow` of C libraries is not
    correctly rounded. A negative exponent gives the reciprocal of the power with the
    positive exponent.
    """
    bits, result = abs(int(exponent)), 1.0
    while bits:
        if bits & 1:
            result *= base
        base *= base
        bits >>= 1
    return quotient(1.0, result) if exponent < 0 else result


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
    """Return the derivation of a formula over fields of these names.

    Raises `icdgen.icd.formula.FormulaError`.

    Examples: ``Lon + Lon HP*1e-2``, ``W*10^W_SF``.
    """
    tree = evaluate(text, _Trees(frozenset(names)))
    if isinstance(tree, Fraction):
        raise FormulaError("it does not depend on a field")
    return _in_steps(tree)


class _Trees(Arithmetic[_Tree]):
    """Arithmetic that builds a tree of the operations on fields, and computes
    operations on numbers exactly.
    """

    def __init__(self, names: frozenset[str]) -> None:
        # The longest name first, because names can contain spaces and operators, and
        # one can be the start of another. A faulty ICD can have an empty name.
        self.names = sorted(sorted(filter(None, names)), key=len, reverse=True)

    def name_at(self, text: str, at: int) -> str:
        """Return the longest name of a field that begins at an index of the text; empty
        if none does.
        """
        matches = (name for name in self.names if text.startswith(name, at))
        return next(
            (name for name in matches if not _continues(text, at + len(name), name)), ""
        )

    def unreadable(self, text: str, at: int) -> FormulaError:
        """Return the error for an unknown name, or for a character that is not part of
        a formula.
        """
        words = _WORDS.match(text, at)
        if words is None:
            return FormulaError(f"`{text[at]}` is not part of a formula")
        close = close_to(words.group(), sorted(self.names))
        return FormulaError(
            f"there is no field `{words.group()}`"
            + (f"; did you mean `{close}`?" if close else "")
        )

    def number(self, number: Fraction) -> _Tree:
        """Return the number."""
        return number

    def variable(self, name: str) -> _Tree:
        """Return the name of the field."""
        return name

    def operation(self, operator: str, left: _Tree, right: _Tree) -> _Tree:
        """Return the operation, or its result if both operands are numbers."""
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
        """Return a power; the exponent is an integer or the name of a field."""
        if exponent.is_name:
            if is_negative:
                raise FormulaError(
                    f"`^-{exponent.text}` has a sign before a field; divide by the power instead"
                )
            return "^", base, exponent.text
        most = MAX_EXPONENT if isinstance(base, Fraction) else MAX_DEGREE
        if not exponent.text.isdigit() or int(exponent.text) > most:
            raise FormulaError(
                f"the exponent after `^` is neither a field nor a whole number up to {most}"
            )
        number = -int(exponent.text) if is_negative else int(exponent.text)
        return (
            power_of_number(base, number)
            if isinstance(base, Fraction)
            else ("^", base, Fraction(number))
        )


def _continues(text: str, end: int, name: str) -> bool:
    """Return whether the text continues the last word of a name, or indexes it:
    ``Volt`` in ``Voltage``, ``V`` in ``V[0]``.
    """
    return (
        _is_of_word(name[-1])
        and end < len(text)
        and (_is_of_word(text[end]) or text[end] == "[")
    )


def _is_of_word(letter: str) -> bool:
    return letter.isalnum() or letter == "_"


def _in_steps(tree: _Tree) -> Derivation:
    """Return the steps that compute a tree.

    The steps of a left operand come before the steps of the right operand.
    """
    fields: dict[str, int] = {}
    numbers: dict[float, int] = {}
    steps: list[tuple[str, Any, Any]] = []

    # An operand is first its kind and its index among operands of that kind. The index
    # in the row of values is known only at the end, when all fields and numbers are
    # collected.
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
    rows = (
        Operation(operator, *(begin[kind] + at for kind, at in sides))
        for operator, *sides in steps
    )
    return Derivation(tuple(fields), tuple(numbers), tuple(rows))


def _double(number: Fraction) -> float:
    """Return the nearest double.

    Raises `FormulaError` if the number overflows or underflows to 0.
    """
    try:
        double = number.numerator / number.denominator
    except OverflowError:
        double = math.inf
    if math.isinf(double) or (number and not double):
        raise FormulaError("a number is too large or too small for a double")
    return double
