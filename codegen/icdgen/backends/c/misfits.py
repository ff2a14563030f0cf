"""The statements that look for raw values with more bits than their fields."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from icdgen.backends.c import bits
from icdgen.backends.c.decoding import elements
from icdgen.backends.c.text import literal
from icdgen.backends.lines import STEP
from icdgen.describe import MessageDescription
from icdgen.describe.description import Composite, FieldDescription

Said = Callable[[str, str], list[str]]
"""The lines for an expression that is 0 where the value fits, and for the name of what is too large."""


def naming(message: MessageDescription, is_open: bool = False) -> list[str]:
    """Those that return the name of the first such field: of the open end, or of all others."""
    return [line for field in _looked_at(message, is_open) for line in _of(message, field, _named)]


def gathering(message: MessageDescription, is_open: bool = False) -> list[str]:
    """Those that gather in ``excess`` what does not fit."""
    return [line for field in _looked_at(message, is_open) for line in _of(message, field, _gathered)]


def _looked_at(message: MessageDescription, is_open: bool) -> Iterator[FieldDescription]:
    return (field for field in message.blocks if field.is_open == is_open)


def _named(excess: str, name: str) -> list[str]:
    return [f"if (({excess}) != 0u) {{", f"{STEP}return {literal(name)};", "}"]


def _gathered(excess: str, name: str) -> list[str]:
    return [f"excess |= {excess};"]


def _of(
    one: Composite[Any], field: FieldDescription, said: Said, owner: str = "", of: str = "", depth: int = 1
) -> list[str]:
    """The lines for a field of ``one``, which is ``owner`` in C and ``of`` in the ICD; of an array, in a loop."""
    name = of + field.model.name
    if not field.count:
        return said(bits.excess(field, owner and owner + field.member), name) if field.is_narrow else []
    index = "element" if depth == 1 else f"element_{depth}"
    member = f"{owner}{field.member}[{index}]"
    if field.element is None:
        lines = said(bits.excess(field, member), name) if field.is_narrow else []
    else:
        inside = (field.element, f"{member}.", f"{name}[].", depth + 1)
        lines = [line for one in field.element.blocks for line in _of(inside[0], one, said, *inside[1:])]
    if not lines:
        return []
    count = elements(one.tail) if field.is_open and one.tail is not None else f"{field.count}u"
    head = f"for (size_t {index} = 0u; {index} < {count}; {index}++) {{"
    return [head, *(f"{STEP}{line}" for line in lines), "}"]
