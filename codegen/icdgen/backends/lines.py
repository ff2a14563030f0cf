"""Line layout of generated code in all languages: text that fits stays on one line,
otherwise each item has its own line.

Generated files declare that icdgen formats them, so that formatters skip them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from icdgen.describe.comments import one_line

STEP = "    "
# Start of a list, heading or quotation
_BLOCK = re.compile(r"(\d*)([-+*=#]+\Z|[.)]\Z|>)")


def bracketed(
    head: str,
    items: Sequence[str],
    tail: str,
    width: int,
    indent: str = "",
    last: str = ",",
) -> str:
    """Return ``head`` (with an opening bracket), ``items`` and ``tail`` (with the
    closing bracket), on one line if they fit.

    ``last`` follows the last item if each has its own line. ``indent``: indentation of
    the line; the first line is returned without it.
    """
    line = f"{head}{', '.join(items)}{tail}"
    return (
        line
        if len(indent) + len(line) <= width and "\n" not in line
        else exploded(head, items, tail, indent, last)
    )


def exploded(
    head: str, items: Sequence[str], tail: str, indent: str = "", last: str = ","
) -> str:
    """Return the items with one line each."""
    if not items:
        return f"{head}{tail}"
    rows = f",\n{indent}{STEP}".join(items)
    return f"{head}\n{indent}{STEP}{rows}{last}" + (
        f"\n{indent}{tail}" if last else tail
    )


def wrapped(text: str, width: int) -> list[str]:
    """Return the words of a text on lines of at most ``width`` characters.

    A longer word has its own line.
    """
    remaining, lines = text, []
    while len(remaining) > width:
        end = remaining.rfind(" ", 0, width + 1)
        if end < 0:
            end = remaining.find(" ")  # after a word that is longer than a line
        if end < 0:
            break
        lines.append(remaining[:end])
        remaining = remaining[end + 1 :]
    return [*lines, remaining]


def plain(text: str) -> str:
    """Return the text as one line without control, invisible and direction-changing
    characters.
    """
    # Bidirectional control characters can disguise code in comments (CVE-2021-42574).
    text = one_line(text)
    return (
        text
        if text.isprintable()
        else "".join(c if c.isprintable() else f"U+{ord(c):04X}" for c in text)
    )


def commented(
    paragraphs: Iterable[str], width: int, start: str, is_spaced: bool = False
) -> list[str]:
    """Return the lines of a comment, each after ``start``.

    ``is_spaced``: separate paragraphs by an empty line.
    """
    lines: list[str] = []
    for paragraph in filter(None, paragraphs):
        lines += [start.rstrip()] if lines and is_spaced else []
        lines += [
            start + tamed(line) for line in wrapped(paragraph, width - len(start))
        ]
    return lines


def tamed(line: str) -> str:
    """Return a line with an escaped start, if Markdown would read it as list, heading
    or quotation.
    """
    if line[:1].isalpha():
        return line
    word, space, following = line.partition(" ")
    return (
        _BLOCK.sub(r"\1\\\2", word, count=1) + space + following
        if _BLOCK.match(word)
        else line
    )


def in_rows(items: Iterable[str], count: int) -> list[str]:
    """Return rows of ``count`` items, each item with a trailing comma."""
    items_with_commas = [f"{item}," for item in items]
    return [
        " ".join(items_with_commas[first : first + count])
        for first in range(0, len(items_with_commas), count)
    ]
