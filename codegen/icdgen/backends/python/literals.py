"""Python expressions from values, laid out the way Black does it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from icdgen.backends.lines import wrapped
from icdgen.backends.python.text import WIDTH, literal, prose
from icdgen.describe.comments import sentence


@dataclass(frozen=True, slots=True)
class Call:
    """``name(positional, keyword=value)``."""

    name: str
    positional: tuple[object, ...] = ()
    keywords: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Verbatim:
    """Source that stands as it is."""

    text: str


@dataclass(frozen=True, slots=True)
class Noted:
    """An item of a call or a mapping, with a comment above it."""

    item: object
    notes: tuple[str, ...]


def expression(value: object, indent: int = 0, before: int = 0, after: int = 0) -> str:
    """The source of a value: on one line if it fits between so many characters, else one item a line.

    ``indent`` is that of the line it begins on.
    """
    is_noted = _is_noted(value)
    line = "" if is_noted else _line(value)
    if not is_noted and indent + before + len(line) + after <= WIDTH:
        return line
    if isinstance(value, str):
        return _long_text(value, indent)
    opening, items, closing = _parts(value)
    if not items:
        return line
    rows = [_row(head, item, indent + 4) for head, item in items]
    return f"{opening}\n{''.join(rows)}{' ' * indent}{closing}"


def _row(head: str, item: object, indent: int) -> str:
    """An item on lines of its own, under its comment."""
    pad = " " * indent
    if not isinstance(item, Noted):
        return f"{pad}{head}{expression(item, indent, len(head), 1)},\n"
    comment = ""
    for note in item.notes:
        first, *rest = wrapped(prose(sentence(note)), WIDTH - indent - 4)
        # What goes on is indented, so that no line of it can be read as an instruction to a tool.
        comment += f"{pad}# {first}\n" + "".join(f"{pad}#   {line}\n" for line in rest)
    return comment + _row(head, item.item, indent)


def _is_noted(value: object) -> bool:
    if isinstance(value, Noted):
        return True
    return not isinstance(value, str | Verbatim) and any(_is_noted(item) for _, item in _parts(value)[1])


def _long_text(text: str, indent: int) -> str:
    """A string in pieces, in brackets."""
    pieces = wrapped(text, WIDTH - indent - 8)
    if len(pieces) == 1:
        return literal(text)
    pad = " " * (indent + 4)
    spaced = [*(f"{piece} " for piece in pieces[:-1]), pieces[-1]]
    return "(\n" + "".join(f"{pad}{literal(piece)}\n" for piece in spaced) + " " * indent + ")"


def _line(value: object) -> str:
    if isinstance(value, Verbatim):
        return value.text
    if isinstance(value, str):
        return literal(str(value))
    if value is None or isinstance(value, bool | int | float):
        return repr(value)
    opening, items, closing = _parts(value)
    inner = ", ".join(f"{head}{_line(item)}" for head, item in items)
    single = "," if opening == "(" and len(items) == 1 else ""
    return f"{opening}{inner}{single}{closing}"


def _parts(value: object) -> tuple[str, list[tuple[str, object]], str]:
    """Opening bracket, items with what stands before each, closing bracket."""
    if isinstance(value, Call):
        named = [(f"{key}=", item) for key, item in value.keywords.items()]
        return f"{value.name}(", [*(("", item) for item in value.positional), *named], ")"
    if isinstance(value, Mapping):
        return "{", [(f"{_line(key)}: ", item) for key, item in value.items()], "}"
    if isinstance(value, Sequence):
        return "(", [("", item) for item in value], ")"
    return "", [], repr(value)
