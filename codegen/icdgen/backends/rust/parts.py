"""The messages that a composite message repeats, as conversions from it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.backends.lines import STEP, bracketed
from icdgen.backends.rust.names import field_name, own_name, struct_path
from icdgen.backends.rust.text import WIDTH
from icdgen.describe import FieldDescription, MessageDescription, StructDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.contained import ContainedDescription, CopiedMember, contained_messages


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
    for one in contained_messages(message):
        path = struct_path(one.message, message.node)
        count = len(one.positions)
        kind = f"[{path}; {count}]" if count > 1 else path
        values = tuple(tuple(_values(one, message, begin)) for begin in one.positions)
        found.append(Part(part_comment(one.message.model, one.positions), kind, count > 1, values, path))
    return found


def _values(part: ContainedDescription, composite: MessageDescription, begin: int) -> Iterator[str]:
    copies = {copied.member.model.name: copied for copied in part.copies(composite, begin)}
    for member in part.message.members:
        yield _struct(member, member.struct, copies) if member.struct else _value(copies[member.model.name])


def _struct(field: FieldDescription, struct: StructDescription, copies: dict[str, CopiedMember]) -> str:
    """A struct, or an array of them, of the values that stand in it."""
    path, found = struct_path(struct, field.message.node), []
    for row in field.instances:
        values = (_struct(one, one.struct, copies) if one.struct else _value(copies[one.model.name]) for one in row)
        found.append(f"{path} {{ {', '.join(values)} }}")
    rows = ", ".join(found)
    return f"{own_name(field)}: {f'[{rows}]' if field.count else rows}"


def _value(copied: CopiedMember) -> str:
    name = own_name(copied.member)
    sources = [f"message.{field_name(one)}" for one in copied.sources]
    if copied.is_whole:
        return f"{name}: {sources[0]}"
    return bracketed(f"{name}: [", sources, "]", WIDTH - len(STEP) * 4, STEP * 4)
