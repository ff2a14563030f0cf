"""Macros: ids, the only valid raw values, raw values with a meaning of their own, limits."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c import names
from icdgen.backends.c.text import comment
from icdgen.backends.c.types import mask
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.constants import Constant
from icdgen.describe.numbers import exact_text
from icdgen.icd.model import Node


class Macro(NamedTuple):
    """A macro."""

    comment: str
    name: str
    value: str


def ids(message: MessageDescription) -> list[Macro]:
    """The id, or the set id and the get id."""
    return [Macro(comment([id.comment]), names.constant(message, id.name), f"{id.value}u") for id in message.ids]


def constants(message: MessageDescription) -> list[Macro]:
    """The only valid raw values, raw values with a meaning of their own, and limits."""
    return [
        Macro(comment([one.comment]), names.constant(message, one.name), _value(one, field))
        for field in message.fields
        for one in field.constants
    ]


def _value(one: Constant, field: FieldDescription) -> str:
    if isinstance(one.value, int) and one.key in ("const", "special") and not field.storage.signed:
        return mask(one.value, field.storage.bits)
    text = exact_text(one.value)
    return f"({text})" if one.value < 0 and one.key not in ("const", "special") else text


def initial(message: MessageDescription) -> list[str]:
    """Statements that give fields with only one valid value that value."""
    return [
        f"message->{field.name} = {names.constant(message, one.name)};"
        for field in message.fields
        for one in field.constants
        if one.key == "const"
    ]


def of_node(node: Node) -> list[Macro]:
    """What the node says of itself."""
    rows = (
        ("NODE_TYPE", node.node_type, "What the node answers when asked for its type."),
        ("INTERFACE_VERSION", node.interface_version, "Version of the interface that it reports."),
    )
    upper = node.name.upper()
    return [Macro(comment([text]), f"{upper}_{end}", f"{value}u") for end, value, text in rows if value is not None]
