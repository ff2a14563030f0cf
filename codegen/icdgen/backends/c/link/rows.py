"""Rows of the tables of a link, and how they are laid out."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.c.text import WIDTH, comment
from icdgen.backends.lines import STEP
from icdgen.icd.model import Message

_MOST_ID, _MOST_LENGTH = 0xFF, 0xFFFF


def short(known: dict[int, Message]) -> dict[int, Message]:
    """Messages that can be told by an id of one byte."""
    return {id: m for id, m in known.items() if id <= _MOST_ID and m.length <= _MOST_LENGTH}


def boolean(value: bool) -> str:
    return "true" if value else "false"


def or_none(value: int | None) -> str:
    return "-1" if value is None else str(value)


def row_of(value: str, text: str) -> str:
    """``value, /* text */``; longer than a line: the comment before it."""
    line = f"{value}, /* {text} */" if text else f"{value},"
    if len(line) + 8 <= WIDTH:
        return line
    return "\n        ".join([f"/* {text} */", *_broken(f"{value},")] if text else _broken(f"{value},"))


def _broken(value: str) -> list[str]:
    """A long initialiser on several lines."""
    return lines([f"{part}," for part in value.removesuffix(",").split(", ")])


def wrapped(value: str, text: str) -> list[str]:
    line = f"{value} /* {text} */"
    return [line] if len(line) + 8 <= WIDTH else [comment([text], STEP * 2).lstrip().replace("/**", "/*", 1), value]


def lines(items: Iterable[str]) -> list[str]:
    """The items, as many on a line as fit."""
    lines, line = [], ""
    for item in items:
        if line and len(line) + len(item) + 1 + 8 > WIDTH:
            lines.append(line)
            line = ""
        line += f" {item}" if line else item
    return [*lines, line] if line else lines


def aligned(rows: Iterable[str]) -> list[str]:
    """The rows with the comments at their ends below each other, as far as they fit."""
    found = [row.partition(" /* ") for row in rows]
    ends = [bool(text) and "\n" not in code + text for code, _, text in found]
    widest = max((len(code) for (code, _, _), end in zip(found, ends, strict=True) if end), default=0)
    if any(text and "\n" not in text and widest + len(text) + 12 > WIDTH for _, _, text in found):
        return list(rows)
    return [
        f"{code:{widest}} /* {text}" if end else code + sep + text
        for (code, sep, text), end in zip(found, ends, strict=True)
    ]
