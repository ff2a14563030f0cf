"""Every name that the headers declare, for the rules about names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.backends import Identifier
from icdgen.backends.c import names, physical
from icdgen.backends.c.parts import part_name
from icdgen.describe import Description, FieldDescription, MessageDescription, NodeDescription, StructDescription
from icdgen.describe.arrays import all_struct_arrays
from icdgen.describe.contained import contained_messages
from icdgen.describe.description import Composite

FILE = "C names at file scope"
FILES = "C header files"

_STATUS = ("LENGTH", "RANGE", "UNKNOWN_ID", "UNSUPPORTED", "CHECKSUM", "BUSY")
_SUPPORT = ("ICDGEN_SHARED", "icd_status_t", "ICD_OK", *(f"ICD_ERROR_{end}" for end in _STATUS))
_SIZES = (
    "LONGEST", "CAN_SLOT_BYTES", "CLIENT_BYTES", "REQUEST_BYTES", "LOG_BYTES", "BLOCK_BYTES", "BLOCK_BITMAP_BYTES",
    "LINE_BYTES", "SEQUENCES",
)  # fmt: skip
_BUSES = ("uart", "i2c", "can")


def declared_names(description: Description) -> Iterator[Identifier]:
    """The names in the order of the ICDs."""
    for name in _SUPPORT:
        yield Identifier(FILE, name, "the support header", None)
    yield Identifier(FILES, "icdgen.h", "the support header", None)
    yield Identifier(FILES, "icdgen_wide.h", "formulas of many digits", None)
    for end in ("h", "c"):
        yield Identifier(FILES, f"icdgen_wire.{end}", "the wire layer", None)
    for node in description.nodes:
        yield from _node(node)
        if node.is_linked:
            yield from _link(node)
        for struct in node.structs:
            yield from _struct(struct)
        for message in node.messages:
            yield from _message(message)


def _node(node: NodeDescription) -> Iterator[Identifier]:
    yield node.identifier(FILES, f"{node.name}.h")
    for end in ("ICD_DIGEST", "NODE_TYPE", "INTERFACE_VERSION", "H"):
        yield node.identifier(FILE, f"{node.name.upper()}_{end}")
    for kind in ("telemetry", "telecommand"):
        rare = ("which", "which_t") if node.shares_ids(kind) else ()
        for end in ("t", "name", "length", "size", "decode", "encode", *rare):
            owner = f"{kind} of node `{node.name}`"
            yield Identifier(FILE, f"{node.name}_{kind}_{end}", owner, node.model.source)
    for direction in node.directions:
        if node.shares_ids(direction.kind):
            stem = f"{node.name}_{direction.kind}"
            yield from (one.identifier(FILE, names.enumerator_of(stem, one)) for one, _ in direction.messages)
        for one, _ in direction.messages:
            yield one.identifier(f"members of {node.name}_{direction.kind}_t", one.name)
    if node.enums:
        yield Identifier(FILES, f"{node.name}/enums.h", "the enumerations", None)
        yield Identifier(FILE, f"{node.name.upper()}_ENUMS_H", "the enumerations", None)
    for enum in node.enums:
        for end in ("t", "name"):
            yield enum.identifier(FILE, f"{names.stem(enum)}_{end}")
        for member in enum.members:
            yield member.identifier(FILE, names.enumerator(enum, member))


def _link(node: NodeDescription) -> Iterator[Identifier]:
    owner, source = f"the link of node `{node.name}`", node.model.source
    for file in ("link.h", "link.c", "client.h"):
        yield Identifier(FILES, f"{node.name}/{file}", owner, source)
    begun = [f"client_{bus}" for bus in _BUSES] if node.has_client else ["client_init", "sender_t", "sender_init"]
    for end in ("link", "client_t", *begun):
        yield Identifier(FILE, f"{node.name}_{end}", owner, source)
    sent = ("send",) if node.has_client else ("send", "ask", "put")
    for verbs, messages in ((sent, node.telecommands), (("request", "receive"), node.telemetry)):
        for one in messages:
            yield from (one.identifier(FILE, f"{node.name}_{verb}_{one.name}") for verb in verbs)
    for end in (*_SIZES, "NODE", "LINK_H", "LINK_C", "CLIENT_H"):
        yield Identifier(FILE, f"{node.name.upper()}_{end}", owner, source)


def _struct(struct: StructDescription) -> Iterator[Identifier]:
    stem = names.stem(struct)
    yield struct.identifier(FILES, f"{struct.node.name}/{struct.name}.h")
    yield struct.identifier(FILE, names.constant(struct, "h"))
    for end in ("t", "init", "fields"):
        yield struct.identifier(FILE, f"{stem}_{end}")
    yield from _fields(struct)


def _message(message: MessageDescription) -> Iterator[Identifier]:
    stem = names.stem(message)
    yield message.identifier(FILES, f"{message.node.name}/{message.name}.h")
    for end in ("h", "length", *(id.name for id in message.ids)):
        yield message.identifier(FILE, names.constant(message, end))
    rare = (*(("misfit",) if message.is_narrow else ()), *(("size",) if message.last_part else ()))
    for end in ("t", "init", "decode", "encode", "fields", *rare):
        yield message.identifier(FILE, f"{stem}_{end}")
    for one in all_struct_arrays(message):
        yield message.identifier(FILE, names.reading(message, one.name))
        yield message.identifier(FILE, names.writing(message, one.name))
    if message.last_part is not None and message.last_part.element_struct is not None and not message.earlier_parts:
        yield message.identifier(FILE, names.walking(message, message.last_part.field.name))
    for part in contained_messages(message):
        yield message.identifier(FILE, f"{stem}_{part_name(part.message)}")
    yield from _fields(message)


def _fields(message: Composite[Any]) -> Iterator[Identifier]:
    stem = names.stem(message)
    members = f"members of {stem}_t"
    for field in message.declared_members:
        is_view = field.model.view
        yield field.identifier(FILE, f"{stem}_{field.name}") if is_view else field.identifier(members, field.name)
        if field.model.when:
            yield field.identifier(FILE, names.has(field))
        for one in field.constants:
            yield field.identifier(FILE, names.constant(message, one.name))
        for end in _physical_names(field) if field.has_physical else ():
            yield field.identifier(FILE, f"{stem}_{end}")
            if field.is_settable:
                yield field.identifier(FILE, f"{stem}_set_{end}")


def _physical_names(field: FieldDescription) -> tuple[str, ...]:
    """What its accessors are called by: the physical value as a text or a double, and in whole parts of its unit."""
    integers = None if field.steps is None else physical.scaled(field).integers
    return (field.physical_name,) if integers is None else (field.physical_name, field.integer_name(integers.scale.per))
