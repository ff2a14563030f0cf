"""Values -> Rust expressions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from icdgen.backends.literals import Brackets, Item

Expression = str | Brackets


def struct(name: str, *items: Item) -> Brackets:
    """A struct of the wire layer, one field a line."""
    return Brackets(f"link::{name} {{ ", items, " }")


def flat(name: str, /, **parts: Expression | int) -> Brackets:
    """A struct of the wire layer on one line."""
    items = (part(key, value if isinstance(value, Brackets) else spelled(value)) for key, value in parts.items())
    return Brackets(f"link::{name} {{ ", tuple(items), " }", True)


def members(one: Any) -> dict[str, Any]:
    """All that an object of a dataclass holds."""
    return {field.name: getattr(one, field.name) for field in fields(one)}


def part(name: str, value: Expression, why: str = "") -> Item:
    """A field of a struct, with the reason for what is assumed."""
    return Item(value, f"{name}: ", (why,) if why else ())


def rows(values: Iterable[Expression]) -> Brackets:
    """A reference to an array, one element a line."""
    return Brackets("&[", tuple(map(Item, values)), "]")


def flat_rows(values: Iterable[Expression]) -> Brackets:
    """A reference to an array, on one line."""
    return Brackets("&[", tuple(map(Item, values)), "]", True)


def some(value: Expression | int | None) -> Expression:
    """The value as one of an `Option`."""
    if value is None:
        return "None"
    return value.within("Some(", ")") if isinstance(value, Brackets) else f"Some({spelled(value)})"


def spelled(value: bool | int | str) -> str:
    """A truth value, a number, or an expression as it is."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:_}" if isinstance(value, int) else value
