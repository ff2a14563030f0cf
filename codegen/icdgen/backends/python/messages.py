"""A message -> what its template needs beside the description."""

from __future__ import annotations

from typing import Any

from icdgen.backends.python import names
from icdgen.describe import EnumDescription, StructDescription
from icdgen.describe.description import Composite


def values(one: Composite[Any]) -> dict[str, object]:
    """What is imported for a message or a struct: enumerations and structs."""
    return {"imports": sorted(_import(used, one) for used in (*one.enums, *one.structs))}


def _import(used: EnumDescription | StructDescription, by: Composite[Any]) -> str:
    module = names.module_name(used)
    if used.node is not by.node:
        module = f"..{used.node.name}.{names.TYPES}.{module}"
    return f"from .{module} import {names.class_name(used)}"
