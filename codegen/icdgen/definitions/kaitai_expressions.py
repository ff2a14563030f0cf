"""Expressions of Kaitai Struct: conditions that select a message, counts of elements, and linear formulas.

Other expressions are not supported.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from icdgen.definitions.kaitai_yaml import integer
from icdgen.definitions.model import NotHeld
from icdgen.definitions.wording import line
from icdgen.icd.formula import FormulaError, coefficients

_PATH = r"[a-z_][a-z0-9_]*(?:\.[a-z_][a-z0-9_]*)*"
_NUMBER = r"[-+]?0[xXbBoO][0-9A-Fa-f_]+|[-+]?[0-9][0-9_]*"
_MASKED = re.compile(rf"\(?\s*(?P<path>{_PATH})\s*(?:&\s*(?P<mask>{_NUMBER})\s*)?\)?\Z")
_COMPARED = re.compile(r"(?P<left>[^=!<>]+?)\s*(?P<sign>==|!=)\s*(?P<right>[^=!<>]+)\Z")
_ENUM = re.compile(r"(?P<enum>[a-z_][a-z0-9_]*(?:::[a-z_][a-z0-9_]*)*)::(?P<member>[a-z_][a-z0-9_]*)\Z")
_REFERENCE = re.compile(rf"(?<![\w.]){_PATH}")
_WHOLE_DIVISION = re.compile(r"/(?!\s*[0-9]+(?:\.[0-9]+|[eE]))")
_LONGEST = 400  # characters of an expression; limits the time that the regular expressions take


Members = Callable[[str], dict[int, str]]  # from the name of an enumeration to its members, by value


class Masked(NamedTuple):
    """Operand of a comparison: a field, or the bits of it that ``mask`` selects."""

    path: str
    mask: int | None


class Equality(NamedTuple):
    """Comparison of bits of a field with ``value``, a number or a member of an enumeration."""

    of: Masked
    value: str
    is_negated: bool


def masked(text: object) -> Masked:
    """Parse an operand such as ``header.flags & 0x13``. Raises `NotHeld` for any other expression."""
    found = _MASKED.match(str(text).strip()) if len(str(text)) <= _LONGEST else None
    if found is None:
        raise NotHeld(f"`{line(str(text), 80)}` is neither a field nor bits of a field")
    # `.to_i` converts an enumeration to its integer.
    return Masked(found["path"].removesuffix(".to_i"), None if found["mask"] is None else integer(found["mask"]))


def equalities(text: object) -> list[Equality]:
    """Parse a conjunction of comparisons such as ``a == 1 and flag``. Raises `NotHeld` for any other expression."""
    said = str(text).strip()
    found = []
    for part in re.split(r"\band\b", said) if len(said) <= _LONGEST else [""]:
        one = part.strip()
        while one.startswith("(") and one.endswith(")") and one.count("(") == 1:
            one = one[1:-1].strip()
        is_negated = one.startswith("not ")
        one = one.removeprefix("not ").strip()
        if (compared := _COMPARED.match(one)) is not None:
            left, right = compared["left"].strip(), compared["right"].strip()
            left, right = (right, left) if integer(left) is not None else (left, right)
            found.append(Equality(_of(left, said), right, is_negated != (compared["sign"] == "!=")))
        else:
            found.append(Equality(_of(one, said), "true", is_negated))
    return found


def _of(text: str, whole: str) -> Masked:
    """Parse the operand of a comparison. Raises `NotHeld` with the text of the complete condition, ``whole``."""
    try:
        return masked(text)
    except NotHeld:
        raise NotHeld(f"it depends on `{line(whole, 80)}`, which is more than equalities of fields") from None


def number(text: str, members: Members) -> int:
    """Return the raw value of a literal or of a member of an enumeration. Raises `NotHeld` for any other text."""
    if (found := {"true": 1, "false": 0}.get(text.lower(), integer(text))) is not None:
        return found
    if (member := _ENUM.match(text)) is not None:
        for value, name in members(member["enum"]).items():
            if name == member["member"]:
                return value
    raise NotHeld(f"it depends on whether a field is `{line(text, 60)}`")


def line_of(text: object, is_integer: bool) -> tuple[str, str] | None:
    """Return the field that an expression depends on, and its formula. None if it is not a linear function of one field.

    ``is_integer``: the field is an integer, so that a division by an integer drops the remainder and is not linear.
    """
    said = str(text)
    paths = set(_REFERENCE.findall(said)) if len(said) <= _LONGEST else set()
    if (
        len(paths) != 1 or "^" in said or (is_integer and _WHOLE_DIVISION.search(said))
    ):  # `^` is the exclusive or in Kaitai Struct
        return None
    plain = re.sub(r"\s*([*/])\s*", r"\1", " ".join(_REFERENCE.sub("raw", said).split()))
    try:
        terms = coefficients(plain)
    except FormulaError:
        return None
    return (paths.pop(), plain) if len(terms) == 2 and terms[1] else None


def counted(text: object) -> tuple[str, int] | None:
    """Return the field and the constant of an expression such as ``length - 4``. None for any other expression."""
    found = line_of(text, is_integer=True)
    if found is None:
        return None
    plus, slope = coefficients(found[1])
    return (found[0], int(plus)) if slope == 1 and plus.denominator == 1 else None
