"""Optional fields: the test whether a field is present, and the code that depends on
it.

A member of an optional field always exists in the struct. `presence_test` is the
condition under which it is part of the frame.
"""

from __future__ import annotations

from icdgen.backends.c import bits, constants
from icdgen.backends.c.names import enumerator
from icdgen.backends.c.statement import assigned_byte, either
from icdgen.backends.c.types import mask
from icdgen.describe import FieldDescription
from icdgen.describe.description import PresenceCondition


def presence_test(field: FieldDescription) -> str:
    """Return the condition under which an optional field is present."""
    return either(list(map(_value_test, field.needs)), " && ")


def absent_value(field: FieldDescription) -> str:
    """Return the value of an absent field: its constant, so that the message is valid
    once the field is present; else 0.
    """
    if field.model.const is not None:
        return constants.only_value_macro(field)
    return {"bool": "false", "float": "0"}.get(
        field.model.type, "0" if field.storage.signed else "0u"
    )


def _value_test(need: PresenceCondition) -> str:
    """Return the test whether a field has one of the values."""
    field, member = need.field, f"message->{need.field.name}"
    if field.model.type == "bool":
        tests = [member if value else f"!{member}" for value in need.values]
    else:
        tests = [f"{member} == {_value_literal(field, value)}" for value in need.values]
    return either(tests)


def _value_literal(field: FieldDescription, value: int) -> str:
    member = field.enum.member(value) if field.enum is not None else None
    if field.enum is not None and member is not None:
        return enumerator(field.enum, member)
    if field.storage.signed:
        return f"({value})" if value < 0 else str(value)
    # An `unsigned int` has at least 16 bits (C99 5.2.4.2.1).
    return f"{value}u" if value < 1 << 16 else mask(value, field.storage.bits)


def write_optional(field: FieldDescription) -> list[str]:
    """Return the statements that write a field into a frame in which its bits are 0."""
    if field.is_word:
        return [bits.store_word(field)]
    return [
        assigned_byte(
            f"buffer[{piece.byte}]",
            [f"buffer[{piece.byte}]", bits.field_term(field, piece)],
        )
        for piece in field.pieces
    ]
