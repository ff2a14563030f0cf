"""Expressions of Kaitai Struct: conditions that select a message, counts of elements,
and linear formulas.

Other expressions are not supported.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from icdgen.definitions.kaitai_yaml import integer
from icdgen.definitions.model import NotSupported
from icdgen.definitions.wording import line
from icdgen.frozen import NamedTuple
from icdgen.icd.formula import FormulaError, coefficients

_PATH = r"[a-z_][a-z0-9_]*(?:\.[a-z_][a-z0-9_]*)*"
_NUMBER = r"[-+]?0[xXbBoO][0-9A-Fa-f_]+|[-+]?[0-9][0-9_]*"
_MASKED = re.compile(rf"\(?\s*(?P<path>{_PATH})\s*(?:&\s*(?P<mask>{_NUMBER})\s*)?\)?\Z")
_COMPARED = re.compile(r"(?P<left>[^=!<>]+?)\s*(?P<sign>==|!=)\s*(?P<right>[^=!<>]+)\Z")
_ENUM = re.compile(
    r"(?P<enum>[a-z_][a-z0-9_]*(?:::[a-z_][a-z0-9_]*)*)::(?P<member>[a-z_][a-z0-9_]*)\Z"
)
_REFERENCE = re.compile(rf"(?<![\w.]){_PATH}")
_WHOLE_DIVISION = re.compile(r"/(?!\s*[0-9]+(?:\.[0-9]+|[eE]))")
# Characters of an expression; limits the time that the regular expressions take.
_LONGEST = 400


# From the name of an enumeration to its members, by value.
Members = Callable[[str], dict[int, str]]


class Masked(NamedTuple):
    """Operand of a comparison: a field, or the bits of it that ``mask`` selects."""

    path: str
    mask: int | None


class Equality(NamedTuple):
    """Comparison of bits of a field with ``value``, a number or a member of an
    enumeration.
    """

    of: Masked
    value: str
    is_negated: bool


def masked(text: object) -> Masked:
    """Parse an operand such as ``header.flags & 0x13``.

    Raises `NotSupported` for any other expression.
    """
    match = _MASKED.match(str(text).strip()) if len(str(text)) <= _LONGEST else None
    if match is None:
        raise NotSupported(
            f"`{line(str(text), 80)}` is neither a field nor bits of a field"
        )
    # `.to_i` converts an enumeration to its integer.
    return Masked(
        match["path"].removesuffix(".to_i"),
        None if match["mask"] is None else integer(match["mask"]),
    )


def equalities(text: object) -> list[Equality]:
    """Parse a conjunction of comparisons such as ``a == 1 and flag``.

    Raises `NotSupported` for any other expression.
    """
    condition = str(text).strip()
    result = []
    for part in re.split(r"\band\b", condition) if len(condition) <= _LONGEST else [""]:
        term = part.strip()
        while term.startswith("(") and term.endswith(")") and term.count("(") == 1:
            term = term[1:-1].strip()
        is_negated = term.startswith("not ")
        term = term.removeprefix("not ").strip()
        if (compared := _COMPARED.match(term)) is not None:
            left, right = compared["left"].strip(), compared["right"].strip()
            left, right = (right, left) if integer(left) is not None else (left, right)
            result.append(
                Equality(
                    _operand(left, condition),
                    right,
                    is_negated != (compared["sign"] == "!="),
                )
            )
        else:
            result.append(Equality(_operand(term, condition), "true", is_negated))
    return result


def _operand(text: str, condition: str) -> Masked:
    """Parse the operand of a comparison.

    Raises `NotSupported` with the text of the complete condition, ``whole``.
    """
    try:
        return masked(text)
    except NotSupported:
        raise NotSupported(
            f"it depends on `{line(condition, 80)}`, which is more than equalities of fields"
        ) from None


def number(text: str, members: Members) -> int:
    """Return the raw value of a literal or of a member of an enumeration.

    Raises `NotSupported` for any other text.
    """
    if (
        literal := {"true": 1, "false": 0}.get(text.lower(), integer(text))
    ) is not None:
        return literal
    if (member := _ENUM.match(text)) is not None:
        for value, name in members(member["enum"]).items():
            if name == member["member"]:
                return value
    raise NotSupported(f"it depends on whether a field is `{line(text, 60)}`")


def linear_function(text: object, is_integer: bool) -> tuple[str, str] | None:
    """Return the field that an expression depends on, and its formula.

    None if it is not a linear function of one field.

    ``is_integer``: the field is an integer, so that a division by an integer drops the
    remainder and is not linear.
    """
    expression = str(text)
    paths = (
        set(_REFERENCE.findall(expression)) if len(expression) <= _LONGEST else set()
    )
    # `^` is the exclusive or in Kaitai Struct.
    if (
        len(paths) != 1
        or "^" in expression
        or (is_integer and _WHOLE_DIVISION.search(expression))
    ):
        return None
    plain = re.sub(
        r"\s*([*/])\s*", r"\1", " ".join(_REFERENCE.sub("raw", expression).split())
    )
    try:
        terms = coefficients(plain)
    except FormulaError:
        return None
    return (paths.pop(), plain) if len(terms) == 2 and terms[1] else None


def counted(text: object) -> tuple[str, int] | None:
    """Return the field and the constant of an expression such as ``length - 4``.

    None for any other expression.
    """
    linear = linear_function(text, is_integer=True)
    if linear is None:
        return None
    plus, slope = coefficients(linear[1])
    return (linear[0], int(plus)) if slope == 1 and plus.denominator == 1 else None
