"""Values of macros and enumerators: the only valid raw values, raw values with a meaning of their own, limits.

And what is said of fields as data: rows of tables.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from icdgen.backends.c import names
from icdgen.backends.c.text import literal
from icdgen.backends.c.types import mask
from icdgen.describe import EnumDescription, FieldDescription
from icdgen.describe.constants import Constant
from icdgen.describe.description import Composite
from icdgen.describe.numbers import exact_text
from icdgen.icd import floats
from icdgen.icd.model import Member

_MAX_ENUMERATOR = 32767
"""Range of `int` that C guarantees."""


def of_fields(message: Composite[Any]) -> list[tuple[Constant, str]]:
    """The constants of a message's fields, and their values."""
    return [(one, _value(one, field)) for field in message.declared_members for one in field.constants]


def _value(one: Constant, field: FieldDescription) -> str:
    if one.number:
        return _float(one, field.model.bits)
    if isinstance(one.value, int) and one.key in ("const", "special") and not field.storage.signed:
        return mask(one.value, field.storage.bits)
    if one.is_raw and field.storage.signed and one.value == -(1 << field.storage.bits - 1):
        return f"INT{field.storage.bits}_MIN"  # of 64 bits it cannot be written: what `-` stands before is too large
    text = exact_text(one.value)
    if one.is_raw and one.value >= 1 << 63 and text.isdigit():
        return f"UINT64_C({text})"  # without it, what no signed type holds draws a warning
    if not one.is_raw and text.lstrip("-").isdigit():
        text += ".0"  # a physical value is a double
    return f"({text})" if one.value < 0 and one.key not in ("const", "special") else text


def _float(one: Constant, bits: int) -> str:
    """A special value of a float; what is no number by its bits, for not every target has a name for it."""
    assert isinstance(one.value, int)
    if one.number in floats.NAMED:
        return f"icd_f{bits}_of({mask(one.value, bits)})"
    text = f"{one.number}{'f' if bits == 32 else ''}"
    return f"({text})" if text.startswith("-") else text


def only(field: FieldDescription) -> str:
    """The constant of the only valid value of a field that has one."""
    (name,) = (one.name for one in field.constants if one.key == "const")
    return names.constant(field.declaration.message, name)


def of_enum(enum: EnumDescription) -> tuple[bool, Callable[[int], str]]:
    """Whether the values of an enumeration must be macros, as not every `int` holds them; and what spells their literals."""
    are_macros = any(abs(one.model.value) > _MAX_ENUMERATOR for one in enum.members)
    if enum.storage.signed:
        return are_macros, partial(_signed, bits=enum.storage.bits if are_macros else 0)
    form = "UINT64_C(%d)" if enum.storage.bits == 64 else "%du" if are_macros else "%d"
    return are_macros, form.__mod__


def within(enum: EnumDescription, one: Member) -> str:
    """Whether ``value`` lies between the ends of a range."""
    bits, signed = enum.storage
    form = partial(_signed, bits=bits) if signed else ("UINT64_C(%d)" if bits == 64 else "%du").__mod__
    return f"value > {form(one.value)} && value < {form(one.last)}"


def _signed(value: int, bits: int) -> str:
    """A literal of so many bits; of an `int` if 0."""
    if bits and value == -(1 << bits - 1):
        return f"INT{bits}_MIN"
    text = f"INT64_C({value})" if bits == 64 else str(value)
    return f"({text})" if value < 0 and bits else text


class Fields(NamedTuple):
    """Rows of the fields, and of their limits, to which they point."""

    limits: list[str]
    rows: list[str]


def table(one: Composite[Any]) -> Fields:
    """Those of a message or a struct, in the order of the ICD, an array as one, and a struct."""
    found = Fields([], [])
    for field in one.members:
        model, bounds = field.model, field.bounds
        limits = f"&limits[{len(found.limits)}]" if bounds else "NULL"
        unit = literal(model.unit_symbol)
        inside = "NULL" if field.struct is None else f"{names.stem(field.struct)}_fields"
        place = f"{model.at}u, {model.bits}u, {field.count or 1}u"
        found.rows.append(f"{{{literal(model.name)}, {unit}, {place}, {limits}, {len(bounds)}u, {inside}}}")
        for bound in bounds:
            found.limits.append(f"{{ICD_LIMIT_{bound.key.upper()}, {bound.double!r}}}")
    return found
