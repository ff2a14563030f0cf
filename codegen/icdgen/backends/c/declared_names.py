"""Every name that the headers declare, for the rules about names."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends import Identifier
from icdgen.backends.c import names, physical
from icdgen.backends.c.accessors import whole_name
from icdgen.describe import Description, EnumDescription, FieldDescription, MessageDescription, NodeDescription

FILE = "C names at file scope"
FILES = "C header files"

_STATUS = ("LENGTH", "RANGE", "UNKNOWN_ID", "UNSUPPORTED", "CHECKSUM", "BUSY")
_SUPPORT = ("icd_status_t", "ICD_OK", *(f"ICD_ERROR_{end}" for end in _STATUS))
_SIZES = ("LONGEST", "CAN_SLOT_BYTES", "CLIENT_BYTES", "LOG_BYTES", "BLOCK_BYTES", "BLOCK_BITMAP_BYTES")


def declared_names(description: Description) -> Iterator[Identifier]:
    """The names in the order of the ICDs."""
    for name in _SUPPORT:
        yield Identifier(FILE, name, "the support header", None)
    yield Identifier(FILES, "icdgen.h", "the support header", None)
    yield Identifier(FILES, "icdgen_wire.h", "the wire layer", None)
    for node in description.nodes:
        yield from _node(node)
        if node.is_linked:
            yield from _link(node)
        for message in node.messages:
            yield from _message(message, node.is_linked)


def _node(node: NodeDescription) -> Iterator[Identifier]:
    owner, source = f"node `{node.name}`", node.model.source
    yield Identifier(FILES, f"{node.name}.h", owner, source)
    for end in ("ICD_DIGEST", "NODE_TYPE", "INTERFACE_VERSION", "H"):
        yield Identifier(FILE, f"{node.name.upper()}_{end}", owner, source)
    for kind in ("telemetry", "telecommand"):
        for end in ("t", "name", "length", "decode", "encode"):
            yield Identifier(FILE, f"{node.name}_{kind}_{end}", f"{kind} of {owner}", source)
    for kind, messages in (("telemetry", node.telemetry), ("telecommand", node.telecommands)):
        for one in messages:
            scope = f"members of {node.name}_{kind}_t"
            yield Identifier(scope, one.name, f"message `{one.model.name}`", one.model.source)
    if node.enums:
        yield Identifier(FILES, f"{node.name}/enums.h", "the enumerations", None)
        yield Identifier(FILE, f"{node.name.upper()}_ENUMS_H", "the enumerations", None)
    for enum in node.enums:
        yield from _enum(enum)


def _enum(enum: EnumDescription) -> Iterator[Identifier]:
    owner = f"enumeration `{enum.model.name}`"
    for end in ("t", "name"):
        yield Identifier(FILE, f"{names.stem(enum)}_{end}", owner, enum.model.source)
    for one in enum.members:
        yield Identifier(FILE, names.enumerator(enum, one), f"`{one.model.name}` of {owner}", one.model.source)


def _link(node: NodeDescription) -> Iterator[Identifier]:
    owner, source = f"the link of node `{node.name}`", node.model.source
    yield Identifier(FILES, f"{node.name}/link.h", owner, source)
    yield Identifier(FILE, f"{node.name}_link", owner, source)
    for end in (*_SIZES, "NODE", "LINK_H"):
        yield Identifier(FILE, f"{node.name.upper()}_{end}", owner, source)


def _message(message: MessageDescription, linked: bool) -> Iterator[Identifier]:
    owner, source = f"message `{message.model.name}`", message.model.source
    yield Identifier(FILES, f"{message.node.name}/{message.name}.h", owner, source)
    telemetry = ("telemetry",) if linked and message.model.telemetry_id is not None else ()
    for end in ("h", "length", *(id.name for id in message.ids), *telemetry):
        yield Identifier(FILE, names.constant(message, end), owner, source)
    for end in ("t", "init", "decode", "encode", *(("misfit",) if message.is_narrow else ())):
        yield Identifier(FILE, f"{names.stem(message)}_{end}", owner, source)
    stem, members = names.stem(message), f"members of {names.stem(message)}_t"
    for field in message.fields:
        owner, source = f"field `{field.model.name}` of `{message.model.name}`", field.model.source
        yield Identifier(members, field.name, owner, source)
        for one in field.constants:
            yield Identifier(FILE, names.constant(message, one.name), owner, source)
        for end in _physical_names(field) if field.steps is not None else ():
            yield Identifier(FILE, f"{stem}_{end}", owner, source)
            yield Identifier(FILE, f"{stem}_set_{end}", owner, source)


def _physical_names(field: FieldDescription) -> tuple[str, ...]:
    """What its accessors are called by: the physical value as a double, and in whole parts of its unit."""
    whole = physical.scaled(field).whole
    return (field.physical_name,) if whole is None else (field.physical_name, whole_name(field, whole))
