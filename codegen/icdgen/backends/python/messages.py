"""A message -> what its template needs beside the description."""

from __future__ import annotations

from icdgen.backends.lines import bracketed
from icdgen.backends.python import names
from icdgen.backends.python.fields import default
from icdgen.backends.python.packing import Packer
from icdgen.backends.python.text import WIDTH
from icdgen.describe import EnumDescription, MessageDescription

STEP = "    "


def values(message: MessageDescription) -> dict[str, object]:
    """How bytes become attributes and back, what attributes are at first, and what is imported for it."""
    packing = Packer(message).packing()
    constants: dict[str, str] = {}
    defaults = {field.name: default(field, constants) for field in message.members}
    head = "def from_bytes(", ["cls", "data: _base.Buffer"], f") -> {names.class_name(message)}:"
    return {
        "imports": _imports(message, packing.floats),
        "tables": [*packing.tables, *(f"{name} = {call}" for call, name in constants.items())],
        "defaults": defaults,
        "from_bytes": bracketed(*head, WIDTH, STEP),
        "packing": packing,
    }


def _imports(message: MessageDescription, floats: bool) -> list[str]:
    enums = {field.enum for field in message.fields if field.enum is not None}
    lines = [_import(enum, message) for enum in enums]
    return [f"from ... import _base, _codec{', _floats' if floats else ''}", *sorted(lines)]


def _import(enum: EnumDescription, message: MessageDescription) -> str:
    module = names.module_name(enum)
    if enum.node is not message.node:
        module = f"..{enum.node.name}.{names.TYPES}.{module}"
    return f"from .{module} import {names.class_name(enum)}"
