"""A message -> what its template needs beside the description."""

from __future__ import annotations

from typing import Any

from icdgen.backends.python import names
from icdgen.backends.python.fields import constant
from icdgen.describe import EnumDescription, MessageDescription, StructDescription
from icdgen.describe.description import Composite
from icdgen.describe.parts import parts_of


def values(message: MessageDescription) -> dict[str, object]:
    """What is said of it, and what it repeats in the order of the frame."""
    parts = [(begin, part.message) for part in parts_of(message) for begin in part.begins]
    return {**shared(message), "parts": sorted(parts, key=lambda one: one[0])}


def shared(composite: Composite[Any]) -> dict[str, object]:
    """The enumerations and structs that are imported for a message or a struct, and the constants of its fields."""
    used_by: tuple[EnumDescription | StructDescription, ...] = (*composite.enums, *composite.structs)
    return {
        "imports": sorted(_import(used, composite) for used in used_by),
        "constants": [(one, constant(one, field)) for field in composite.all_members for one in field.constants],
    }


def _import(used: EnumDescription | StructDescription, by: Composite[Any]) -> str:
    module = names.module_name(used)
    if used.node is not by.node:
        module = f"..{used.node.name}.{names.TYPES}.{module}"
    return f"from .{module} import {names.class_name(used)}"
