"""How statements are laid out: on one line where they fit, else in the way of the usual formatters."""

from __future__ import annotations

import re
from collections.abc import Sequence

from icdgen.backends.c.text import WIDTH

STEP = "    "

_COMPOUND = re.compile(r" (?:<<|>>|&) \w+\Z")


def grouped(term: str) -> str:
    """The term as an operand: in parentheses if it ends with an operation."""
    return f"({term})" if _COMPOUND.search(term) else term


def joined(terms: Sequence[str]) -> str:
    """The terms, or-ed together."""
    return " | ".join(map(grouped, terms)) if len(terms) > 1 else terms[0]


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


def assigned_byte(target: str, terms: Sequence[str]) -> str:
    """A statement that gives a byte the value of terms or-ed together."""
    value = joined(terms)
    value = (
        f"{value};"
        if len(terms) == 1 and value.startswith("ICDGEN_U8(") and value.endswith(")")
        else f"ICDGEN_U8({value});"
    )
    if len(STEP) + len(target) + 3 + len(value) <= WIDTH:
        return f"{target} = {value}"
    indent = STEP * 2
    if len(indent) + len(value) <= WIDTH:
        return f"{target} =\n{indent}{value}"
    lines, line = [f"{target} = ICDGEN_U8("], indent + grouped(terms[0])
    for term in map(grouped, terms[1:]):
        if len(line) + len(term) + 5 > WIDTH:
            lines.append(f"{line} |")
            line = indent + term
        else:
            line += f" | {term}"
    return "\n".join([*lines, f"{line});"])


def head(returned: str, name: str, parameters: str) -> str:
    """The first line of a function, broken before the parameters, and after the type, where it is too long."""
    line = f"static inline {returned}{name}({parameters})"
    if len(line) <= WIDTH:
        return line
    first = f"static inline {returned}{name}("
    if len(first) > WIDTH:
        first = f"static inline {returned.rstrip()}\n{name}("
    return f"{first}\n{STEP}{parameters})"


def parameters(*each: str) -> str:
    """Parameters on the line after the name: on one where they fit, else each on its own."""
    line = f"{STEP}{', '.join(each)})"
    return line if len(line) <= WIDTH else f"{STEP}" + f",\n{STEP}".join(each) + ")"
