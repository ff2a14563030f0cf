"""Statements for the members of a message, one by one; for what stands in arrays, in loops."""

from __future__ import annotations

from collections.abc import Callable

from icdgen.backends.c.statement import loop
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription

Said = Callable[[FieldDescription, str, str], list[str]]
"""The lines for a field, for what it is called in C from the message on, and in the ICD; none if there is nothing to do."""


def statements(
    field: FieldDescription, said: Said, count: str, owner: str = "", of: str = "", depth: int = 1
) -> list[str]:
    """The lines for one of the `blocks` of a message; of an array for so many elements, ``count`` in C."""
    name, member = of + field.model.name, owner + field.member
    if not field.count:
        return said(field, member, name)
    index = "0" if count == "1u" else "element" if depth == 1 else f"element_{depth}"
    member += f"[{index}]"
    if field.element is None:
        lines = said(field, member, name)
    else:
        inner = ((one, f"{one.count}u") for one in field.element.blocks)
        lines = [
            line for one, many in inner for line in statements(one, said, many, f"{member}.", f"{name}[].", depth + 1)
        ]
    if not lines or index == "0":
        return lines
    return [loop(index, count), *(f"{STEP}{line}" for line in lines), "}"]
