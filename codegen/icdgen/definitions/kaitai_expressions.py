"""Expressions of Kaitai Struct, as far as messages are told by them and formulas made of them."""

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
_LONGEST = 400


Members = Callable[[str], dict[int, str]]  # those of an enumeration, by its name


class Masked(NamedTuple):
    """A field, or some bits of it."""

    path: str
    mask: int | None


class Equality(NamedTuple):
    """What a condition asks: whether bits of a field have a value, which is a number or a member of an enumeration."""

    of: Masked
    value: str
    is_negated: bool


def masked(text: object) -> Masked:
    """``header.flags & 0x13``. Raises `NotHeld`."""
    found = _MASKED.match(str(text).strip()) if len(str(text)) <= _LONGEST else None
    if found is None:
        raise NotHeld(f"`{line(str(text), 80)}` is neither a field nor bits of a field")
    return Masked(found["path"].removesuffix(".to_i"), None if found["mask"] is None else integer(found["mask"]))


def equalities(text: object) -> list[Equality]:
    """``a == 1 and flag``: all must hold. Raises `NotHeld` for anything else."""
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
    try:
        return masked(text)
    except NotHeld:
        raise NotHeld(f"it depends on `{line(whole, 80)}`, which is more than equalities of fields") from None


def number(text: str, members: Members) -> int:
    """The raw value that is compared with. Raises `NotHeld`."""
    if (found := {"true": 1, "false": 0}.get(text.lower(), integer(text))) is not None:
        return found
    if (member := _ENUM.match(text)) is not None:
        for value, name in members(member["enum"]).items():
            if name == member["member"]:
                return value
    raise NotHeld(f"it depends on whether a field is `{line(text, 60)}`")


def line_of(text: object, is_integer: bool) -> tuple[str, str] | None:
    """The field that a value is computed from, and the formula; None if it is not a linear function of one field.

    ``is_integer`` of a field: there the division of whole numbers drops the rest.
    """
    said = str(text)
    paths = set(_REFERENCE.findall(said)) if len(said) <= _LONGEST else set()
    if len(paths) != 1 or "^" in said or (is_integer and _WHOLE_DIVISION.search(said)):  # `^` is no power there
        return None
    plain = re.sub(r"\s*([*/])\s*", r"\1", " ".join(_REFERENCE.sub("raw", said).split()))
    try:
        terms = coefficients(plain)
    except FormulaError:
        return None
    return (paths.pop(), plain) if len(terms) == 2 and terms[1] else None


def counted(text: object) -> tuple[str, int] | None:
    """The field that a number is, and what is added to it; None if it is anything else."""
    found = line_of(text, is_integer=True)
    if found is None:
        return None
    plus, slope = coefficients(found[1])
    return (found[0], int(plus)) if slope == 1 and plus.denominator == 1 else None
