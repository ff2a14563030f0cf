"""The messages that a composite message repeats, as conversions from it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.backends.lines import STEP, bracketed
from icdgen.backends.rust.names import field_name, own_name, struct_path
from icdgen.backends.rust.text import WIDTH
from icdgen.describe import FieldDescription, MessageDescription, StructDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.parts import Copied, PartDescription, parts_of


class Part(NamedTuple):
    """``type``: the message, or an array of as many as it is repeated; ``values`` are what each is made of."""

    about: str
    type: str
    is_array: bool
    values: tuple[tuple[str, ...], ...]
    message: str


def parts(message: MessageDescription) -> list[Part]:
    """Those of a composite message."""
    found = []
    for one in parts_of(message):
        path = struct_path(one.message, message.node)
        count = len(one.begins)
        kind = f"[{path}; {count}]" if count > 1 else path
        values = tuple(tuple(_values(one, message, begin)) for begin in one.begins)
        found.append(Part(part_comment(one.message.model, one.begins), kind, count > 1, values, path))
    return found


def _values(part: PartDescription, composite: MessageDescription, begin: int) -> Iterator[str]:
    copies = {copied.member.model.name: copied for copied in part.copies(composite, begin)}
    for member in part.message.members:
        yield _struct(member, member.struct, copies) if member.struct else _value(copies[member.model.name])


def _struct(field: FieldDescription, struct: StructDescription, copies: dict[str, Copied]) -> str:
    """A struct, or an array of them, of the values that stand in it."""
    path, found = struct_path(struct, field.message.node), []
    for row in field.instances:
        values = (_struct(one, one.struct, copies) if one.struct else _value(copies[one.model.name]) for one in row)
        found.append(f"{path} {{ {', '.join(values)} }}")
    rows = ", ".join(found)
    return f"{own_name(field)}: {f'[{rows}]' if field.count else rows}"


def _value(copied: Copied) -> str:
    name = own_name(copied.member)
    twins = [f"message.{field_name(one)}" for one in copied.twins]
    if copied.is_whole:
        return f"{name}: {twins[0]}"
    return bracketed(f"{name}: [", twins, "]", WIDTH - len(STEP) * 4, STEP * 4)
