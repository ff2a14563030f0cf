"""Python expressions for links.

`icdgen.link_calls` returns the link of a node as nested calls of the runtime;
`expression` writes them as source, with assumptions as comments.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from icdgen.backends.lines import wrapped
from icdgen.backends.literals import Brackets, Item, written
from icdgen.backends.python.text import WIDTH, literal, prose
from icdgen.describe.comments import sentence
from icdgen.link_calls import Call, Commented, Verbatim


def expression(value: object) -> str:
    """Return the source of a value: calls and mappings with one item per line, tuples
    on one line.
    """
    return written(_literal_of(value), _note)


def _note(text: str, indent: str) -> str:
    first, *continued = wrapped(prose(sentence(text)), WIDTH - len(indent) - 4)
    # Continued lines are indented, so that none can be read as an instruction to a tool
    # (`# type: ignore`).
    return "\n".join(
        [f"{indent}# {first}", *(f"{indent}#   {line}" for line in continued)]
    )


def _literal_of(value: object) -> str | Brackets:
    if isinstance(value, Verbatim):
        return value.text
    if isinstance(value, str):
        return literal(value)
    if isinstance(value, bytes):
        return f'bytes.fromhex("{value.hex()}")'
    if isinstance(value, Call):
        items = [
            *map(_item, value.positional),
            *(_item(item, f"{key}=") for key, item in value.keywords.items()),
        ]
        return Brackets(f"{value.name}(", tuple(items), ")", value.is_flat)
    if isinstance(value, Mapping):
        return Brackets(
            "{",
            tuple(_item(item, f"{_literal_of(key)}: ") for key, item in value.items()),
            "}",
        )
    if isinstance(value, Sequence):
        is_flat = not any(
            isinstance(item, Call | Mapping | Commented) for item in value
        )
        return Brackets(
            "(",
            tuple(map(_item, value)),
            # Only flat brackets need this comma of a tuple. Others have one after each
            # item.
            ",)" if is_flat and len(value) == 1 else ")",
            is_flat,
        )
    return repr(value)


def _item(value: object, head: str = "") -> Item:
    if isinstance(value, Commented):
        return Item(_literal_of(value.item), head, value.comments)
    return Item(_literal_of(value), head)
