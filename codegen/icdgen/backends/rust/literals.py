"""Data -> Rust expressions, one part a line."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from icdgen.backends.rust.text import doc, integer, prose, string
from icdgen.describe.comments import sentence

STEP = "    "


class Raw(str):
    """An expression as it is."""

    __slots__ = ()


class Part(NamedTuple):
    """A field of a struct literal. ``source``: the key of the ICD that it comes from, which may be an assumption."""

    name: str
    value: object
    source: str = ""


class Struct(NamedTuple):
    """A struct literal; ``flat``: on one line."""

    name: str
    parts: tuple[Part, ...]
    flat: bool = False


class Rows(tuple[object, ...]):
    """A reference to an array, one element a line."""

    __slots__ = ()


def flat(name: str, /, **parts: object) -> Struct:
    """A struct literal on one line."""
    return Struct(name, tuple(Part(key, value) for key, value in parts.items()), True)


def literal(value: object, why: Callable[[str], str | None], indent: str = "", optional: bool = False) -> str:
    """The expression. ``why``: the reason for what is assumed. ``optional``: the value is one of an `Option`."""
    if value is None:
        return "None"
    text = _literal(value, why, indent)
    return f"Some({text})" if optional else text


def _literal(value: object, why: Callable[[str], str | None], indent: str) -> str:
    if isinstance(value, Optional):
        return literal(value.value, why, indent, True)
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return integer(value)
    if isinstance(value, str):
        return string(value)
    if isinstance(value, bytes):
        return f"&[{', '.join(map(str, value))}]"
    if isinstance(value, Rows):
        rows = "".join(f"{indent}{STEP}{_literal(one, why, indent + STEP)},\n" for one in value)
        return f"&[\n{rows}{indent}]" if rows else "&[]"
    if isinstance(value, tuple) and not isinstance(value, Struct):
        return f"({', '.join(_literal(one, why, indent) for one in value)})"
    assert isinstance(value, Struct), value
    if value.flat:
        inner = ", ".join(f"{part.name}: {_literal(part.value, why, indent)}" for part in value.parts)
        return f"{value.name} {{ {inner} }}"
    lines = []
    for part in value.parts:
        reason = why(part.source) if part.source else None
        if reason:
            lines.append(doc([f"Assumed. {prose(sentence(reason))}"], indent + STEP, "//"))
        lines.append(f"{indent}{STEP}{part.name}: {_literal(part.value, why, indent + STEP)},")
    return f"{value.name} {{\n" + "\n".join(lines) + f"\n{indent}}}"


class Optional(NamedTuple):
    """A value that may be absent."""

    value: object
