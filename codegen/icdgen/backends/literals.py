"""Nested literals of generated code: brackets with one item per line, or on one line if
a backend requests it.

Line lengths are not considered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from icdgen.backends.lines import STEP
from icdgen.frozen import NamedTuple


@dataclass(frozen=True, slots=True)
class Brackets:
    """Items between two brackets.

    ``is_flat``: all on one line.
    """

    opening: str
    items: tuple[Item, ...]
    closing: str
    is_flat: bool = False

    def within(self, before: str, after: str) -> Brackets:
        """Return the brackets with additional text before and after."""
        return replace(
            self, opening=before + self.opening, closing=self.closing + after
        )


class Item(NamedTuple):
    """Item in brackets, with text before it on its line, and notes above it."""

    value: str | Brackets
    head: str = ""
    notes: tuple[str, ...] = ()


def written(
    value: str | Brackets, note: Callable[[str, str], str], indent: str = ""
) -> str:
    """Return the text of a literal whose first line has the indentation ``indent``.

    ``note``: function that returns a comment for a text and its indentation.
    """
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
        lines += [note(text_of_note, inner) for text_of_note in item.notes]
        lines.append(f"{inner}{text},")
    return "\n".join([*lines, indent + value.closing.lstrip()])
