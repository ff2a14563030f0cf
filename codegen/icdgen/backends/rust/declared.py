"""Every name that the crate declares, for the rules about names."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends import Identifier
from icdgen.backends.rust import constants, names
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.naming import DEVICES

_METHODS = ("from_bytes", "from_array", "to_bytes", "try_to_bytes", "default")
_CONSTANTS = ("NAME", "LENGTH", "ID", "SET_ID", "GET_ID")
_ENUM_USES = ("Option", "From", "Enumeration")
_OURS = "a name of the generated code"


def identifiers(icd: Icd) -> Iterator[Identifier]:
    """By scope, what the generated code itself uses first."""
    scope = "modules of the crate"
    for name in names.USED_MODULES:
        yield Identifier(scope, name, _OURS, None)
    for name, said in names.ROOTS.items():
        yield Identifier(scope, name, said, None)
    yield from _devices(scope)
    for node in icd.nodes:
        yield Identifier(scope, node.name, f"node `{node.name}`", node.source)
    by_name = {node.name: node for node in icd.nodes}
    for node in icd.nodes:
        yield from _node(icd, node, by_name)


def _devices(scope: str) -> Iterator[Identifier]:
    return (Identifier(scope, name, "a device of Windows", None) for name in DEVICES)


def _node(icd: Icd, node: Node, by_name: dict[str, Node]) -> Iterator[Identifier]:
    modules, types, enums = f"modules of {node.name}", f"types of {node.name}", f"enumerations of {node.name}"
    for name in names.USED_IN_NODES:
        yield Identifier(modules, name, _OURS, None)
    yield from _devices(modules)
    for name in names.USED_TYPES:
        yield Identifier(types, name, _OURS, None)
    for name in _ENUM_USES:
        yield Identifier(enums, name, _OURS, None)
    for enum in node.enums:
        yield Identifier(enums, names.type_name(enum, node), f"enumeration `{enum.name}`", enum.source)
        yield from _enum(enum, node)
    for message in node.messages:
        owner = f"message `{message.name}`"
        yield Identifier(modules, names.file_name(message, node), owner, message.source)
        yield Identifier(types, names.type_name(message, node), owner, message.source)
        yield from _message(message, node)
    for pick, sum_type in (("telecommand_id", "Telecommand"), ("telemetry_id", "Telemetry")):
        for message in icd.messages_of(node):
            if getattr(message, pick) is not None:
                name = names.type_name(message, by_name[message.node])
                yield Identifier(
                    f"variants of {node.name}::{sum_type}", name, f"message `{message.name}`", message.source
                )


def _enum(enum: Enum, node: Node) -> Iterator[Identifier]:
    scope = f"variants of {node.name}::{enum.name}"
    yield Identifier(scope, names.catch_all(enum, node), _OURS, None)
    for member in enum.members:
        owner = f"member `{member.name}` of `{enum.name}`"
        yield Identifier(scope, names.variant_name(member, node), owner, member.source)


def _message(message: Message, node: Node) -> Iterator[Identifier]:
    where = f"{node.name}::{message.name}"
    fields, methods, associated = f"fields of {where}", f"methods of {where}", f"constants of {where}"
    for name in _METHODS:
        yield Identifier(methods, name, _OURS, None)
    for name in _CONSTANTS:
        yield Identifier(associated, name, _OURS, None)
    for field in message.fields:
        owner = f"field `{field.name}` of `{message.name}`"
        name = names.field_name(field, node)
        yield Identifier(fields, name, owner, field.source)
        if field.scale is not None:
            getter = names.physical_name(field, name)
            yield Identifier(methods, getter, owner, field.source)
            yield Identifier(methods, f"set_{getter}", owner, field.source)
        for constant in constants.of_field(field, node) if constants.has_some(field) else ():
            yield Identifier(associated, constant.name, owner, field.source)
