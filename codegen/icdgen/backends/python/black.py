"""Python source the way Black lays it out: what fits stays on one line, the rest is split at its brackets.

Only forms are made here that Black keeps as they are, whatever the length of the names.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

WIDTH = 88

_DIGITS = re.compile(r"([0-9]+)")


def bracketed(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """A call or subscript: ``head`` (which ends in a bracket), ``items`` and ``tail`` (which closes it) on one line; else the items
    on a line of their own; else one item a line."""
    inner = ", ".join(items)
    if len(head) + len(inner) + len(tail) + indent <= WIDTH:
        return f"{' ' * indent}{head}{inner}{tail}"
    if len(items) == 1 or len(inner) + indent + 4 <= WIDTH:
        pad = " " * indent
        return f"{pad}{head}\n{pad}    {inner}\n{pad}{tail}"
    return exploded(indent, head, items, tail)


def definition(indent: int, head: str, parameters: Sequence[str], tail: str) -> str:
    """The head of a function, laid out like `bracketed`; a single parameter gets a comma, too. ``tail`` is ``) -> type:``."""
    if len(tail) + indent > WIDTH >= len(tail[5:-1]) + indent + 4:
        pad = " " * indent
        tail = f") -> (\n{pad}    {tail[5:-1]}\n{pad}):"
        return exploded(indent, head, parameters, tail)
    if len(parameters) == 1 and len(head) + len(parameters[0]) + len(tail) + indent > WIDTH:
        return exploded(indent, head, parameters, tail)
    return bracketed(indent, head, parameters, tail)


def display(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """A tuple or dictionary display: on one line (a tuple of one with its comma), else one item a line."""
    inner = f"{items[0]}," if len(items) == 1 and head.endswith("(") else ", ".join(items)
    if len(head) + len(inner) + len(tail) + indent <= WIDTH and "\n" not in inner:
        return f"{' ' * indent}{head}{inner}{tail}"
    return exploded(indent, head, items, tail)


def assignment(indent: int, target: str, value: str) -> str:
    """``target = value`` for a name or an attribute."""
    pad = " " * indent
    is_hopeless = "." not in value and len(value) + indent + 4 > WIDTH
    if len(target) + len(value) + indent + 3 <= WIDTH or is_hopeless:
        return f"{pad}{target} = {value}"
    return f"{pad}{target} = (\n{pad}    {value}\n{pad})"


def exploded(indent: int, head: str, items: Iterable[str], tail: str) -> str:
    """One item a line, each with a comma."""
    pad = " " * indent
    lines = "".join(f"{pad}    {item},\n" for item in items)
    return f"{pad}{head}\n{lines}{pad}{tail}" if lines else f"{pad}{head}{tail}"


def imported(indent: int, module: str, name: str, alias: str = "") -> str:
    """An import of one name, without indentation in front."""
    text = f"{name} as {alias}" if alias else name
    if len(line := f"from {module} import {text}") + indent <= WIDTH:
        return line
    pad = " " * indent
    return f"from {module} import (\n{pad}    {text},\n{pad})"


def stored(indent: int, target: str, value: str, local: str) -> str:
    """``target = value``, by way of a local variable where that does not fit on a line; without indentation in front."""
    if len(target) + len(value) + indent + 3 <= WIDTH:
        return f"{target} = {value}"
    return f"{local} = {value}\n{assignment(indent, target, local)}"


def annotated(indent: int, name: str, kind: str) -> str:
    """``name: kind``, without indentation in front."""
    if len(name) + len(kind) + indent + 2 <= WIDTH or len(kind) + indent + 4 > WIDTH:
        return f"{name}: {kind}"
    pad = " " * indent
    return f"{name}: (\n{pad}    {kind}\n{pad})"


def by_module(line: tuple[str, str]) -> tuple:
    """Sort key of (module, name) as Ruff sorts imports: more dots first, numbers by their value."""
    module = line[0].lstrip(".")
    parts = tuple((0, int(p), "") if p.isdigit() else (1, 0, p) for p in _DIGITS.split(module) if p)
    return len(module) - len(line[0]), parts, line[1]
