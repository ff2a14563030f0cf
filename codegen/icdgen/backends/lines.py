"""How the code that is made from an ICD is laid out, in every language: what fits stays on its line, the rest goes one item a line.

The files say that they are laid out by icdgen, so that no formatter need agree.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from icdgen.describe.comments import one_line

STEP = "    "
_BLOCK = re.compile(r"(\d*)([-+*=#]+\Z|[.)]\Z|>)")  # what begins a list, a heading or a quotation


def bracketed(head: str, items: Sequence[str], tail: str, width: int, indent: str = "", last: str = ",") -> str:
    """``head`` (which opens a bracket), ``items`` and ``tail`` (which closes it); ``last`` follows the last item on its own line.

    ``indent`` is that of the line it begins on; the first line stands without.
    """
    line = f"{head}{', '.join(items)}{tail}"
    return line if len(indent) + len(line) <= width and "\n" not in line else exploded(head, items, tail, indent, last)


def exploded(head: str, items: Sequence[str], tail: str, indent: str = "", last: str = ",") -> str:
    """One item a line."""
    if not items:
        return f"{head}{tail}"
    rows = f",\n{indent}{STEP}".join(items)
    return f"{head}\n{indent}{STEP}{rows}{last}" + (f"\n{indent}{tail}" if last else tail)


def wrapped(text: str, width: int) -> list[str]:
    """The words of a text, one blank apart, on lines of at most ``width`` characters, as far as words allow."""
    rest, lines = text, []
    while len(rest) > width:
        end = rest.rfind(" ", 0, width + 1)
        if end < 0:
            end = rest.find(" ")  # behind a word that is longer than a line
        if end < 0:
            break
        lines.append(rest[:end])
        rest = rest[end + 1 :]
    return [*lines, rest]


def plain(text: str) -> str:
    """One line without control, invisible or direction-changing characters."""
    text = one_line(text)
    return text if text.isprintable() else "".join(c if c.isprintable() else f"U+{ord(c):04X}" for c in text)


def commented(paragraphs: Iterable[str], width: int, start: str, is_spaced: bool = False) -> list[str]:
    """The lines of a comment, each after ``start``; ``is_spaced``: with an empty one between two paragraphs."""
    lines: list[str] = []
    for paragraph in filter(None, paragraphs):
        lines += [start.rstrip()] if lines and is_spaced else []
        lines += [start + tamed(line) for line in wrapped(paragraph, width - len(start))]
    return lines


def tamed(line: str) -> str:
    """A line that begins no list, heading or quotation of Markdown."""
    if line[:1].isalpha():
        return line
    word, space, rest = line.partition(" ")
    return _BLOCK.sub(r"\1\\\2", word, count=1) + space + rest if _BLOCK.match(word) else line


def in_rows(items: Iterable[str], count: int) -> list[str]:
    """``count`` items a line, each with a comma behind it."""
    found = [f"{item}," for item in items]
    return [" ".join(found[first : first + count]) for first in range(0, len(found), count)]
