"""Members of a message's struct, and the checks of them."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c import bits
from icdgen.backends.c.text import comment, described, literal
from icdgen.backends.c.types import type_of
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription

EMPTY = "empty"
"""Member of the struct of a message without fields: C has no empty structs."""


class Declaration(NamedTuple):
    """A member of a struct."""

    comment: str
    text: str


class Misfit(NamedTuple):
    """A field that can hold raw values which do not fit; ``test`` is 0 if and only if one fits."""

    test: str
    name: str


def declarations(message: MessageDescription) -> list[Declaration]:
    """The members of the message's struct."""
    rows = [Declaration(described(field.comment, STEP), f"{_declared(field)};") for field in message.fields]
    return rows or [Declaration(comment(["There are no fields; C has no empty structs."], STEP), f"uint8_t {EMPTY};")]


def _declared(field: FieldDescription) -> str:
    if field.model.type == "bytes":
        return f"uint8_t {field.name}[{field.model.bits // 8}]"
    return f"{type_of(field)} {field.name}"


def misfits(message: MessageDescription) -> list[Misfit]:
    """The tests that encode makes, one a field whose C type holds more than the field."""
    return [Misfit(bits.excess(field), literal(field.model.name)) for field in message.fields if field.is_narrow]


def excess_type(message: MessageDescription) -> str:
    """The type that holds what does not fit of any field."""
    return "uint64_t" if any(f.is_narrow and f.storage.bits == 64 for f in message.fields) else "uint32_t"
