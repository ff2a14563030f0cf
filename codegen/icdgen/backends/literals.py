"""Nested literals: brackets with one item a line, or all of them on one line where a backend says so. No column is counted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

from icdgen.backends.lines import STEP


@dataclass(frozen=True, slots=True)
class Brackets:
    """Items between two brackets; ``is_flat``: on one line."""

    opening: str
    items: tuple[Item, ...]
    closing: str
    is_flat: bool = False

    def within(self, before: str, after: str) -> Brackets:
        """The same with more around it."""
        return replace(self, opening=before + self.opening, closing=self.closing + after)


class Item(NamedTuple):
    """Something in brackets, with what stands before it on its line, and notes above it."""

    value: str | Brackets
    head: str = ""
    notes: tuple[str, ...] = ()


def written(value: str | Brackets, note: Callable[[str, str], str], indent: str = "") -> str:
    """The text of a literal that begins on a line of that indentation. ``note`` makes a comment of a text and its indentation."""
    if isinstance(value, str):
        return value
    if not value.items:
        return value.opening.rstrip() + value.closing.lstrip()
    inner = "" if value.is_flat else indent + STEP
    items = [f"{item.head}{written(item.value, note, inner)}" for item in value.items]
    if value.is_flat:
        return f"{value.opening}{', '.join(items)}{value.closing}"
    lines = [value.opening.rstrip()]
    for item, text in zip(value.items, items, strict=True):
        lines += [note(one, inner) for one in item.notes]
        lines.append(f"{inner}{text},")
    return "\n".join([*lines, indent + value.closing.lstrip()])
