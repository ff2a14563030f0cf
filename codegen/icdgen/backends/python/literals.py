"""Python expressions from values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from icdgen.backends.lines import wrapped
from icdgen.backends.literals import Brackets, Item, written
from icdgen.backends.python.text import WIDTH, literal, prose
from icdgen.describe.comments import sentence


@dataclass(frozen=True, slots=True)
class Call:
    """``name(positional, keyword=value)``; ``is_flat``: on one line."""

    name: str
    positional: tuple[object, ...] = ()
    keywords: Mapping[str, object] = field(default_factory=dict)
    is_flat: bool = False


@dataclass(frozen=True, slots=True)
class Verbatim:
    """Source that stands as it is."""

    text: str


@dataclass(frozen=True, slots=True)
class Noted:
    """An item of a call or a mapping, with comments above it."""

    item: object
    notes: tuple[str, ...]


def expression(value: object) -> str:
    """The source of a value: calls and mappings with an item a line, tuples on one."""
    return written(_spelled(value), _note)


def _note(text: str, indent: str) -> str:
    first, *rest = wrapped(prose(sentence(text)), WIDTH - len(indent) - 4)
    # What goes on is indented, so that no line of it can be read as an instruction to a tool.
    return "\n".join([f"{indent}# {first}", *(f"{indent}#   {line}" for line in rest)])


def _spelled(value: object) -> str | Brackets:
    if isinstance(value, Verbatim):
        return value.text
    if isinstance(value, str):
        return literal(value)
    if isinstance(value, Call):
        items = [*map(_item, value.positional), *(_item(one, f"{key}=") for key, one in value.keywords.items())]
        return Brackets(f"{value.name}(", tuple(items), ")", value.is_flat)
    if isinstance(value, Mapping):
        return Brackets("{", tuple(_item(one, f"{_spelled(key)}: ") for key, one in value.items()), "}")
    if isinstance(value, Sequence):
        is_flat = not any(isinstance(one, Call | Mapping | Noted) for one in value)
        return Brackets("(", tuple(map(_item, value)), ",)" if is_flat and len(value) == 1 else ")", is_flat)
    return repr(value)


def _item(value: object, head: str = "") -> Item:
    if isinstance(value, Noted):
        return Item(_spelled(value.item), head, value.notes)
    return Item(_spelled(value), head)
