"""Every name that the headers declare, for the rules about names."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends import Identifier
from icdgen.backends.c import encoding, physical
from icdgen.backends.c.constants import constant_name, limits, specials
from icdgen.backends.c.names import accessor_unit
from icdgen.backends.c.plan import Plan, Planner
from icdgen.backends.c.prefixes import part_of_unit
from icdgen.icd.located import Map
from icdgen.icd.model import Field, Icd, Message, Node

FILE = "C names at file scope"
FILES = "C header files"

_STATUS = ("LENGTH", "RANGE", "UNKNOWN_ID", "UNSUPPORTED", "CHECKSUM", "BUSY")
_SUPPORT = ("icd_status_t", "ICD_OK", *(f"ICD_ERROR_{end}" for end in _STATUS))
_SIZES = ("LONGEST", "CAN_SLOT_BYTES", "CLIENT_BYTES", "LOG_BYTES", "BLOCK_BYTES", "BLOCK_BITMAP_BYTES")


def declared(icd: Icd) -> Iterator[Identifier]:
    """The names in the order of the ICDs."""
    planner = Planner(icd)
    for name in _SUPPORT:
        yield Identifier(FILE, name, "the support header", None)
    yield Identifier(FILES, "icdgen.h", "the support header", None)
    yield Identifier(FILES, "icdgen_wire.h", "the wire layer", None)
    for node in icd.nodes:
        yield from _node(node, planner)
        linked = bool(icd.protocol_of(node))
        if linked:
            yield from _link(node)
        for message in node.messages:
            yield from _message(planner.plan(message), linked)


def _node(node: Node, planner: Planner) -> Iterator[Identifier]:
    owner, source = f"node `{node.name}`", node.source
    yield Identifier(FILES, f"{node.name}.h", owner, source)
    for end in ("ICD_DIGEST", "NODE_TYPE", "INTERFACE_VERSION", "H"):
        yield Identifier(FILE, f"{node.name.upper()}_{end}", owner, source)
    for kind in ("telemetry", "telecommand"):
        for end in ("t", "name", "length", "decode", "encode"):
            yield Identifier(FILE, f"{node.name}_{kind}_{end}", f"{kind} of {owner}", source)
    messages = planner.icd.messages_of(node)
    for message in messages:
        about = f"message `{message.name}`"
        for kind, number in (("telemetry", message.telemetry_id), ("telecommand", message.telecommand_id)):
            if number is not None:
                scope = f"members of {node.name}_{kind}_t"
                yield Identifier(scope, planner.names.file(message), about, message.source)
    if node.enums:
        yield Identifier(FILES, f"{node.name}/enums.h", "the enumerations", None)
        yield Identifier(FILE, f"{node.name.upper()}_ENUMS_H", "the enumerations", None)
    for enum in node.enums:
        stem = planner.names.enum(enum)
        for end in ("t", "name"):
            yield Identifier(FILE, f"{stem}_{end}", f"enumeration `{enum.name}`", enum.source)
        for member in enum.members:
            owner = f"`{member.name}` of enumeration `{enum.name}`"
            yield Identifier(FILE, planner.names.member(enum, member), owner, member.source)


def _link(node: Node) -> Iterator[Identifier]:
    owner, source = f"the link of node `{node.name}`", node.source
    yield Identifier(FILES, f"{node.name}/link.h", owner, source)
    yield Identifier(FILE, f"{node.name}_link", owner, source)
    for end in (*_SIZES, "LINK_H"):
        yield Identifier(FILE, f"{node.name.upper()}_{end}", owner, source)


def _message(plan: Plan, linked: bool) -> Iterator[Identifier]:
    message, stem = plan.message, plan.stem
    owner, source = f"message `{message.name}`", message.source
    yield Identifier(FILES, f"{plan.node.name}/{plan.file}.h", owner, source)
    for end in ("H", "LENGTH", *(("ID",) if message.id is not None else ("SET_ID", "GET_ID"))):
        yield Identifier(FILE, f"{stem.upper()}_{end}", owner, source)
    if linked and message.telemetry_id is not None:
        yield Identifier(FILE, f"{stem.upper()}_TELEMETRY", owner, source)
    ends = ("t", "init", "decode", "encode", *(("misfit",) if encoding.excess(plan) else ()))
    for end in ends:
        yield Identifier(FILE, f"{stem}_{end}", owner, source)
    for field, name, storage in plan.members:
        yield from _field(message, field, name, plan, storage)


def _field(message: Message, field: Field, name: str, plan: Plan, storage) -> Iterator[Identifier]:
    owner, source = f"field `{field.name}` of `{message.name}`", field.source
    yield Identifier(f"members of {plan.type}", name, owner, source)
    ends = [end for end, *_ in specials(field, plan.node.vocabulary)] + [end for end, _ in limits(field)]
    for end in ends:
        yield Identifier(FILE, constant_name(plan, name, end), owner, source)
    if field.scale is None:
        return
    yield from _accessors(plan.stem, name, accessor_unit(field), owner, source)
    whole = physical.scaled(field, storage).whole
    if whole is not None:
        suffix, _ = part_of_unit(field, whole.prefix)
        yield from _accessors(plan.stem, name, suffix, owner, source)


def _accessors(stem: str, name: str, suffix: str, owner: str, source: Map | None) -> Iterator[Identifier]:
    yield Identifier(FILE, f"{stem}_{name}_{suffix}", owner, source)
    yield Identifier(FILE, f"{stem}_set_{name}_{suffix}", owner, source)
