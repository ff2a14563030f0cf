"""Values of macros and enumerators: the only valid raw values, raw values with a meaning of their own, limits."""

from __future__ import annotations

from icdgen.backends.c import names
from icdgen.backends.c.types import mask
from icdgen.describe import EnumDescription, FieldDescription, MessageDescription
from icdgen.describe.constants import Constant
from icdgen.describe.numbers import exact_text

_MAX_ENUMERATOR = 32767
"""What every `int` can hold."""


def of_fields(message: MessageDescription) -> list[tuple[Constant, str]]:
    """The constants of a message's fields, and their values."""
    return [(one, _value(one, field)) for field in message.fields for one in field.constants]


def _value(one: Constant, field: FieldDescription) -> str:
    if isinstance(one.value, int) and one.key in ("const", "special") and not field.storage.signed:
        return mask(one.value, field.storage.bits)
    text = exact_text(one.value)
    return f"({text})" if one.value < 0 and one.key not in ("const", "special") else text


def initial(message: MessageDescription) -> list[str]:
    """Statements that give fields with only one valid value that value."""
    return [
        f"message->{field.name} = {names.constant(message, one.name)};"
        for field in message.fields
        for one in field.constants
        if one.key == "const"
    ]


def of_enum(enum: EnumDescription) -> tuple[bool, str]:
    """Whether the values of an enumeration must be macros, as not every `int` holds them; and the form of their literals."""
    are_macros = any(one.model.value > _MAX_ENUMERATOR for one in enum.members)
    return are_macros, "UINT64_C(%d)" if enum.storage.bits == 64 else "%du" if are_macros else "%d"
