"""Rust expressions for links.

`struct`, `flat`, `rows` and `some` build nested expressions; `icdgen.backends.literals`
writes them as text with one item per line.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from icdgen.backends.literals import Brackets, Item

Expression = str | Brackets


def struct(name: str, *items: Item) -> Brackets:
    """Return a struct of the wire layer, with a field per line."""
    return Brackets(f"link::{name} {{ ", items, " }")


# The slash keeps `name` free for a field of the struct that has this name.
def flat(name: str, /, **parts: Expression | int) -> Brackets:
    """Return a struct of the wire layer on one line."""
    items = (
        part(key, value if isinstance(value, Brackets) else spelled(value))
        for key, value in parts.items()
    )
    return Brackets(f"link::{name} {{ ", tuple(items), " }", True)


def members(part: Any) -> dict[str, Any]:
    """Return the fields of an object of a dataclass, by name."""
    return {field.name: getattr(part, field.name) for field in fields(part)}


def part(name: str, value: Expression, why: str = "") -> Item:
    """Return a field of a struct, with a comment on why its value is assumed."""
    return Item(value, f"{name}: ", (why,) if why else ())


def rows(values: Iterable[Expression]) -> Brackets:
    """Return a reference to an array, with an element per line."""
    return Brackets("&[", tuple(map(Item, values)), "]")


def flat_rows(values: Iterable[Expression]) -> Brackets:
    """Return a reference to an array, on one line."""
    return Brackets("&[", tuple(map(Item, values)), "]", True)


def some(value: Expression | int | None) -> Expression:
    """Return a value as an `Option`."""
    if value is None:
        return "None"
    return (
        value.within("Some(", ")")
        if isinstance(value, Brackets)
        else f"Some({spelled(value)})"
    )


def spelled(value: bool | int | str) -> str:
    """Return the literal of a truth value or number. Expressions stay unchanged."""
    # `bool` is a subclass of `int`, so it is tested first.
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:_}" if isinstance(value, int) else value
