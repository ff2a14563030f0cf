"""Messages that a composite message contains, as conversions from it.

`parts_of` returns the struct expressions of each ``impl From``; see
`icdgen.describe.contained`.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.lines import STEP, bracketed
from icdgen.backends.rust.names import field_name, own_name
from icdgen.backends.rust.text import WIDTH
from icdgen.backends.rust.types import struct_path
from icdgen.describe import FieldDescription, MessageDescription, StructDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.contained import (
    ContainedDescription,
    CopiedMember,
    contained_messages,
)
from icdgen.frozen import NamedTuple


class ContainedConversion(NamedTuple):
    """Conversion to a contained message, or to an array of them if it is contained
    several times.
    """

    about: str
    type: str
    is_array: bool
    values: tuple[tuple[str, ...], ...]  # fields of each struct expression
    message: str


def parts_of(message: MessageDescription) -> list[ContainedConversion]:
    """Return the conversions of a composite message."""
    conversions = []
    for contained in contained_messages(message):
        path = struct_path(contained.message, message.node)
        count = len(contained.positions)
        kind = f"[{path}; {count}]" if count > 1 else path
        values = tuple(
            tuple(_field_expressions(contained, message, begin))
            for begin in contained.positions
        )
        conversions.append(
            ContainedConversion(
                part_comment(contained.message.model, contained.positions),
                kind,
                count > 1,
                values,
                path,
            )
        )
    return conversions


def _field_expressions(
    part: ContainedDescription, composite: MessageDescription, begin: int
) -> Iterator[str]:
    copies = {
        copied.member.model.name: copied for copied in part.copies(composite, begin)
    }
    for member in part.message.members:
        yield (
            _struct_expression(member, member.struct, copies)
            if member.struct
            else _copy_expression(copies[member.model.name])
        )


def _struct_expression(
    field: FieldDescription, struct: StructDescription, copies: dict[str, CopiedMember]
) -> str:
    """Return the expression of a struct, or of an array of structs, over fields of the
    composite.
    """
    path, structs = struct_path(struct, field.message.node), []
    for row in field.instances:
        values = (
            (
                _struct_expression(member, member.struct, copies)
                if member.struct
                else _copy_expression(copies[member.model.name])
            )
            for member in row
        )
        structs.append(f"{path} {{ {', '.join(values)} }}")
    rows = ", ".join(structs)
    return f"{own_name(field)}: {f'[{rows}]' if field.count else rows}"


def _copy_expression(copied: CopiedMember) -> str:
    name = own_name(copied.member)
    sources = [f"message.{field_name(source)}" for source in copied.sources]
    # Members are `Copy`, so an expression over a reference copies an array as well.
    if copied.is_whole:
        return f"{name}: {sources[0]}"
    return bracketed(f"{name}: [", sources, "]", WIDTH - len(STEP) * 4, STEP * 4)
