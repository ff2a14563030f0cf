"""Values of macros and enumerators, and fields as rows of tables.

C has no literal for some values, such as the smallest integer of a type, and an
enumerator may have 16 bits only. The functions return the text that compiles without a
warning on all targets.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from icdgen.backends.c import names
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.text import literal
from icdgen.backends.c.types import mask
from icdgen.describe import EnumDescription, FieldDescription
from icdgen.describe.constants import Constant
from icdgen.describe.description import Composite
from icdgen.describe.numbers import exact_text
from icdgen.frozen import NamedTuple
from icdgen.icd import floats
from icdgen.icd.model import Member

_MAX_ENUMERATOR = 32767
"""Largest `int` that C guarantees."""


def constant_value(field: FieldDescription, constant: Constant) -> str:
    """Return the value of the macro of a constant of a field."""
    if constant.number:
        return _float_literal(constant, field.model.bits)
    if (
        isinstance(constant.value, int)
        and constant.key in ("const", "special")
        and not field.storage.signed
    ):
        return mask(constant.value, field.storage.bits)
    if (
        constant.is_raw
        and field.storage.signed
        and constant.value == -(1 << field.storage.bits - 1)
    ):
        # `-9223372036854775808` is no literal: the operand of `-` is too large
        return f"INT{field.storage.bits}_MIN"
    text = exact_text(constant.value)
    if constant.is_raw and constant.value >= 1 << 63 and text.isdigit():
        # Compilers warn about plain literals that no signed type can store.
        return f"UINT64_C({text})"
    if not constant.is_raw and text.lstrip("-").isdigit():
        text += ".0"  # a physical value is a double
    return (
        f"({text})"
        if constant.value < 0 and constant.key not in ("const", "special")
        else text
    )


def _float_literal(constant: Constant, bits: int) -> str:
    """Return a special value of a float; NaN and infinity by their bits, as some
    targets have no names for them.
    """
    assert isinstance(constant.value, int)
    if constant.number in floats.NAMED:
        return f"icd_f{bits}_of({mask(constant.value, bits)})"
    text = f"{constant.number}{'f' if bits == 32 else ''}"
    return f"({text})" if text.startswith("-") else text


def only_value_macro(field: FieldDescription) -> str:
    """Return the macro of the only valid value of a field that has one."""
    (name,) = (constant.name for constant in field.constants if constant.key == "const")
    return names.constant(field.declaration.message, name)


def enumerator_literals(enum: EnumDescription) -> tuple[bool, Callable[[int], str]]:
    """Return whether values of an enumeration must be macros because an `int` may be
    too small, and the function for literals.
    """
    # An enumerator is an `int` (C99 6.7.2.2), which may have only 16 bits (5.2.4.2.1).
    # If one value is larger, all values are macros.
    are_macros = any(
        abs(member.model.value) > _MAX_ENUMERATOR for member in enum.members
    )
    if enum.storage.signed:
        return are_macros, partial(
            _signed_literal, bits=enum.storage.bits if are_macros else 0
        )
    if enum.storage.bits == 64:
        return are_macros, "UINT64_C({})".format
    return are_macros, ("{}u" if are_macros else "{}").format


def range_test(enum: EnumDescription, member: Member) -> str:
    """Return the test whether ``value`` is between the ends of a range."""
    bits, signed = enum.storage
    if signed:
        first, last = (
            _signed_literal(end, bits) for end in (member.value, member.last)
        )
    else:
        form = "UINT64_C({})" if bits == 64 else "{}u"
        first, last = form.format(member.value), form.format(member.last)
    return f"value > {first} && value < {last}"


def _signed_literal(value: int, bits: int) -> str:
    """Return the literal of a signed integer of ``bits`` bits; of an `int` if ``bits``
    is 0.
    """
    if bits and value == -(1 << bits - 1):
        return f"INT{bits}_MIN"
    text = f"INT64_C({value})" if bits == 64 else str(value)
    return f"({text})" if value < 0 and bits else text


class FieldTable(NamedTuple):
    """Rows for fields, and rows for their limits, to which the former point."""

    limits: list[str]
    rows: list[str]


def field_table(composite: Composite[Any]) -> FieldTable:
    """Return the rows of a message or struct: one per member, in the order of the ICD."""
    table = FieldTable([], [])
    for field in composite.members:
        model, bounds = field.model, field.bounds
        # Fields have different numbers of limits. All limits are one array, and each
        # row points to the first of its own.
        limits = f"&limits[{len(table.limits)}]" if bounds else "NULL"
        unit = literal(model.unit_symbol)
        inside = (
            "NULL" if field.struct is None else C_NAMES.symbol(field.struct, "fields")
        )
        place = f"{model.at}u, {model.bits}u, {field.count or 1}u"
        table.rows.append(
            f"{{{literal(model.name)}, {unit}, {place}, {limits}, {len(bounds)}u, {inside}}}"
        )
        for bound in bounds:
            table.limits.append(f"{{ICD_LIMIT_{bound.key.upper()}, {bound.double!r}}}")
    return table
