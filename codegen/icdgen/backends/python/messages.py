"""A message -> what its template needs beside the description."""

from __future__ import annotations

from icdgen.backends.python import names
from icdgen.backends.python.fields import constant
from icdgen.describe import EnumDescription, MessageDescription
from icdgen.describe.parts import parts_of


def values(message: MessageDescription) -> dict[str, object]:
    """The enumerations that are imported for it, the constants of its fields, and what it repeats in the order of the frame."""
    enums = {field.enum for field in message.all_fields if field.enum is not None}
    parts = [(begin, part.message) for part in parts_of(message) for begin in part.begins]
    return {
        "imports": sorted(_import(enum, message) for enum in enums),
        "constants": [(one, constant(one, field)) for field in message.all_members for one in field.constants],
        "parts": sorted(parts, key=lambda one: one[0]),
    }


def _import(enum: EnumDescription, message: MessageDescription) -> str:
    module = names.module_name(enum)
    if enum.node is not message.node:
        module = f"..{enum.node.name}.{names.TYPES}.{module}"
    return f"from .{module} import {names.class_name(enum)}"
