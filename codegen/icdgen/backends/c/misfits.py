"""The statements that look for raw values with more bits than their fields."""

from __future__ import annotations

from icdgen.backends.c import bits
from icdgen.backends.c.decoding import elements
from icdgen.backends.c.members import Said, statements
from icdgen.backends.c.text import literal
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription


def naming(message: MessageDescription, is_open: bool = False) -> list[str]:
    """Those that return the name of the first such field: of the open end, or of all others."""
    return _looked_at(message, is_open, _named)


def gathering(message: MessageDescription, is_open: bool = False) -> list[str]:
    """Those that gather in ``excess`` what does not fit."""
    return _looked_at(message, is_open, _gathered)


def _looked_at(message: MessageDescription, is_open: bool, said: Said) -> list[str]:
    tail = message.tail
    found = []
    for field in message.blocks:
        if field.is_open == is_open:
            count = elements(tail) if field.is_open and tail is not None else f"{field.count}u"
            found += statements(field, said, count)
    return found


def _named(field: FieldDescription, member: str, name: str) -> list[str]:
    if not field.is_narrow:
        return []
    return [f"if (({bits.excess(field, member)}) != 0u) {{", f"{STEP}return {literal(name)};", "}"]


def _gathered(field: FieldDescription, member: str, name: str) -> list[str]:
    return [f"excess |= {bits.excess(field, member)};"] if field.is_narrow else []
