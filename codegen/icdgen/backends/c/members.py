"""Statements for the members of a message, one by one; for what stands in arrays, in loops.

They give members their first values, and look for raw values with more bits than their fields.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from icdgen.backends.c import bits, constants
from icdgen.backends.c.decoding import elements
from icdgen.backends.c.statement import loop
from icdgen.backends.c.text import literal
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Composite, Into

_Said = Callable[[FieldDescription, str, str], list[str]]
"""The lines for a field, for what it is called in C from the message on, and in the ICD; none if there is nothing to do."""


def _statements(
    field: FieldDescription, said: _Said, count: str, owner: str = "", of: str = "", depth: int = 1
) -> list[str]:
    """The lines for one of the `flat_members` of a message; of an array for so many elements, ``count`` in C."""
    name, member = of + field.model.name, owner + field.member
    if not field.count:
        return said(field, member, name)
    index = "0" if count == "1u" else "element" if depth == 1 else f"element_{depth}"
    member += f"[{index}]"
    if field.element_struct is None:
        lines = said(field, member, name)
    else:
        inner = ((one, f"{one.count}u") for one in field.element_struct.walk(Into.STRUCTS))
        lines = [
            line for one, many in inner for line in _statements(one, said, many, f"{member}.", f"{name}[].", depth + 1)
        ]
    if not lines or index == "0":
        return lines
    return [loop(index, count), *(f"{STEP}{line}" for line in lines), "}"]


def initial(message: Composite[Any]) -> list[str]:
    """Statements that give fields with only one valid value that value, and what counts an open end its smallest."""
    counters = [field for field in message.members if field.model.smallest_raw]
    found = [f"message->{field.member} = {field.initial_raw}u;" for field in counters]
    for field in message.walk(Into.STRUCTS):
        if field.initial_count or not field.count:
            found += _statements(field, _valid, f"{field.initial_count}u")
    return found


def _valid(field: FieldDescription, member: str, name: str) -> list[str]:
    return [] if field.model.const is None else [f"message->{member} = {constants.only(field)};"]


def misfits(message: MessageDescription, is_open: bool) -> list[str]:
    """Those that return the name of the first field whose raw value does not fit: of the open end, or of all others."""
    return _looked_at(message, is_open, _named)


def excess(message: MessageDescription) -> list[str]:
    """Those that gather in ``excess`` what does not fit."""
    return [line for is_open in (False, True) for line in _looked_at(message, is_open, _gathered)]


def _looked_at(message: MessageDescription, is_open: bool, said: _Said) -> list[str]:
    found = []
    for field in message.walk(Into.STRUCTS):
        if field.is_in_last_part == is_open:
            found += _statements(
                field, said, elements(message.last_part) if is_open and message.last_part else f"{field.count}u"
            )
    return found


def _named(field: FieldDescription, member: str, name: str) -> list[str]:
    if not field.is_narrow:
        return []
    return [f"if (({bits.excess(field, member)}) != 0u) {{", f"{STEP}return {literal(name)};", "}"]


def _gathered(field: FieldDescription, member: str, name: str) -> list[str]:
    return [f"excess |= {bits.excess(field, member)};"] if field.is_narrow else []
