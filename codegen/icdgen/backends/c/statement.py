"""How statements are laid out: on one line where they fit, else in the way of the usual formatters."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.backends.c.text import WIDTH

STEP = "    "


def call(function: str, arguments: Sequence[str], depth: int = 1, end: str = ";") -> str:
    """A call, without the indentation of its first line; ``depth`` is that of the line it begins in."""
    line = f"{function}({', '.join(arguments)}){end}"
    if len(STEP) * depth + len(line) <= WIDTH:
        return line
    indent = STEP * (depth + 1)
    lines, current = [f"{function}("], indent
    for argument in arguments:
        if current != indent and len(current) + len(argument) + 2 > WIDTH:
            lines.append(current.rstrip())
            current = indent
        current += f"{argument}, "
    return "\n".join([*lines, f"{current[:-2]}){end}"])


def joined(head: str, terms: Sequence[str], tail: str, depth: int = 1) -> str:
    """``head`` and ``tail`` around terms joined by |; a line a term where they do not fit on one."""
    line = f"{head}{' | '.join(terms)}{tail}"
    if len(STEP) * depth + len(line) <= WIDTH and "\n" not in line:
        return line
    indent = STEP * (depth + 1)
    return f"{head}\n{indent}" + f" |\n{indent}".join(terms) + tail
