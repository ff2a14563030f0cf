"""Phrases that messages of changes share: names, sizes, numbers, formulas and types.

Each function takes a value or a field of the model and returns words, such as ``bits 16
to 31`` for a position (`span`). `formula` writes all formulas in one notation, whatever
the spelling in the ICD. `some` lists at most `MOST` names and counts the remaining
ones. Rules, compatibility and reports use these phrases.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import lru_cache

from icdgen.describe.numbers import bit_range, factor_text, points_text
from icdgen.icd.curve import Curve
from icdgen.icd.formula import Scale
from icdgen.icd.lines import Line
from icdgen.wording import count, listing, quote

MOST = 4  # maximum number of names before the remaining ones are counted


def some(names: Sequence[str], what: str = "") -> str:
    """Return some of the names and the number of the remaining ones: `` `a`, `b` and 12
    more``.
    """
    shown = [quote(name) for name in names[:MOST]]
    remaining = len(names) - len(shown)
    text = (
        listing([*shown, f"{remaining} more"] if remaining else shown) if shown else ""
    )
    return f"{text} ({count(len(names), what)})" if what and remaining else text


def bits(number: int) -> str:
    """Return a size: ``16 bits``, ``2 bytes``."""
    return (
        count(number // 8, "byte")
        if number and number % 8 == 0
        else count(number, "bit")
    )


def span(field: Line) -> str:
    """Return the bits of a field: ``bits 16 to 31``."""
    return bit_range(field.at, field.width)


def number(value: Fraction | int | None) -> str:
    """Return an exact number: ``0.01``, ``1/3``; empty for None."""
    return "" if value is None else factor_text(Fraction(value))


@lru_cache(maxsize=4096)
def formula(scale: Scale | Curve | None) -> str:
    """Return a formula in a uniform notation: ``raw``, ``raw*0.01``, ``raw*0.5 - 40``,
    ``3e-06*raw^2 + 0.02*raw - 40``.
    """
    # A field without a formula equals one with the formula `raw`.
    if scale is None:
        return "raw"
    if isinstance(scale, Curve):
        return (
            f"a table ({points_text(scale, 6)})" if scale.points else _polynomial(scale)
        )
    text = "raw" if scale.factor == 1 else f"raw*{number(scale.factor)}"
    if scale.offset:
        text += f" {'+' if scale.offset > 0 else '-'} {number(abs(scale.offset))}"
    return text


def _polynomial(curve: Curve) -> str:
    """Return a polynomial with the highest power first, without terms of 0."""
    text = ""
    for power, factor in reversed(list(enumerate(curve.coefficients))):
        # A polynomial whose factors are all 0 is written as `0`.
        if not factor and (power or text):
            continue
        size = f"{abs(factor):g}"
        if float(size) != abs(factor):
            size = repr(abs(factor))
        if power == 0:
            term = size
        else:
            raw = "raw" if power == 1 else f"raw^{power}"
            term = raw if size == "1" else f"{size}*{raw}"
        if text:
            text += f" {'-' if factor < 0 else '+'} {term}"
        else:
            text = f"-{term}" if factor < 0 else term
    return text


def type_of(field: Line) -> str:
    """Return the type of a field: ``16-bit int``, ``4-bit enum Mode``, ``4-bit signed
    enum Mode``, ``6 elements, 16-bit int``.
    """
    if field.type == "enum":
        name = field.enum.name if field.enum else "?"
        sign = "signed " if field.is_signed else ""
        text = f"{field.bits}-bit {sign}enum {name}"
    elif field.type == "bool" and field.bits == 1:
        text = "bool"
    else:
        text = f"{field.bits}-bit {field.type}"
    return f"{count(field.count, 'element')}, {text}" if field.count else text


def read_as(field: Line) -> str:
    """Return the type as which a field is read: ``int``, ``enum``, ``signed enum``."""
    return (
        f"signed {field.type}"
        if field.type == "enum" and field.is_signed
        else field.type
    )


def ids(values: Iterable[int | None]) -> str:
    """Return ids as text: ``120 / 247``."""
    return " / ".join(str(value) for value in values if value is not None)
