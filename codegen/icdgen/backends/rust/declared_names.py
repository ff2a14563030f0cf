"""Every name that the crate declares, for the rules about names."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends import Identifier
from icdgen.backends.rust import names
from icdgen.describe import Description, EnumDescription, MessageDescription, NodeDescription
from icdgen.naming import DEVICES

_METHODS = ("from_bytes", "from_array", "to_bytes", "try_to_bytes", "default")
_CONSTANTS = ("NAME", "LENGTH", "ID", "SET_ID", "GET_ID")
_ENUM_USES = ("Option", "From", "Enumeration")
_OURS = "a name of the generated code"


def declared_names(description: Description) -> Iterator[Identifier]:
    """By scope, what the generated code itself uses first."""
    scope = "modules of the crate"
    yield from _ours(scope, names.USED_MODULES)
    for name, said in names.ROOTS.items():
        yield Identifier(scope, name, said, None)
    yield from _devices(scope)
    for node in description.nodes:
        yield Identifier(scope, node.name, f"node `{node.name}`", node.model.source)
    for node in description.nodes:
        yield from _node(node)


def _ours(scope: str, found: tuple[str, ...]) -> Iterator[Identifier]:
    return (Identifier(scope, name, _OURS, None) for name in found)


def _devices(scope: str) -> Iterator[Identifier]:
    return (Identifier(scope, name, "a device of Windows", None) for name in DEVICES)


def _node(node: NodeDescription) -> Iterator[Identifier]:
    modules, types, enums = f"modules of {node.name}", f"types of {node.name}", f"enumerations of {node.name}"
    yield from _ours(modules, names.USED_IN_NODES)
    yield from _devices(modules)
    yield from _ours(types, names.USED_TYPES)
    yield from _ours(enums, _ENUM_USES)
    for enum in node.enums:
        yield Identifier(enums, names.type_name(enum), f"enumeration `{enum.model.name}`", enum.model.source)
        yield from _enum(enum)
    for one in node.messages:
        owner = f"message `{one.model.name}`"
        yield Identifier(modules, one.name, owner, one.model.source)
        yield Identifier(types, names.type_name(one), owner, one.model.source)
        yield from _message(one)
    for sum_type, messages in (("Telecommand", node.telecommands), ("Telemetry", node.telemetry)):
        scope = f"variants of {node.name}::{sum_type}"
        for one in messages:
            yield Identifier(scope, names.type_name(one), f"message `{one.model.name}`", one.model.source)


def _enum(enum: EnumDescription) -> Iterator[Identifier]:
    scope = f"variants of {enum.node.name}::{enum.model.name}"
    yield from _ours(scope, (names.catch_all(enum),))
    for one in enum.members:
        owner = f"member `{one.model.name}` of `{enum.model.name}`"
        yield Identifier(scope, names.type_name(one), owner, one.model.source)


def _message(message: MessageDescription) -> Iterator[Identifier]:
    where = f"{message.node.name}::{message.model.name}"
    fields, methods, associated = f"fields of {where}", f"methods of {where}", f"constants of {where}"
    yield from _ours(methods, _METHODS)
    yield from _ours(associated, _CONSTANTS)
    for field in message.fields:
        owner, source = f"field `{field.model.name}` of `{message.model.name}`", field.model.source
        yield Identifier(fields, names.field_name(field), owner, source)
        if field.steps is not None:
            yield Identifier(methods, field.physical_name, owner, source)
            yield Identifier(methods, f"set_{field.physical_name}", owner, source)
        for constant in field.constants:
            yield Identifier(associated, constant.name.upper(), owner, source)
