"""Every name that the crate declares, for the rules about names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from icdgen.backends import Identifier
from icdgen.backends.rust import arrays, names
from icdgen.backends.rust.accessors import integers_of, single_name
from icdgen.describe import Description, MessageDescription, NodeDescription
from icdgen.describe.description import Composite
from icdgen.naming import DEVICES

_METHODS = ("from_bytes", "from_array", "to_bytes", "default")
_OPEN_METHODS = ("from_longest", "size")
_CONSTANTS = ("NAME", "LENGTH", "ID", "SET_ID", "GET_ID")
_METHODS_OF_STRUCTS = ("fit", "rows", "default")
_CONSTANTS_OF_STRUCTS = ("NAME", "FIELDS")
_ENUM_USES = ("Option", "From", "Enumeration")
_OURS, _DEVICE = "a name of the generated code", "a device of Windows"


def declared_names(description: Description) -> Iterator[Identifier]:
    """By scope, what the generated code itself uses first."""
    scope = "modules of the crate"
    yield from _ours(scope, names.USED_MODULES)
    for name, said in names.ROOTS.items():
        yield Identifier(scope, name, said, None)
    yield from _ours(scope, DEVICES, _DEVICE)
    for node in description.nodes:
        yield node.identifier(scope, node.name)
    for node in description.nodes:
        yield from _node(node)


def _ours(scope: str, found: Iterable[str], said: str = _OURS) -> Iterator[Identifier]:
    return (Identifier(scope, name, said, None) for name in found)


def _node(node: NodeDescription) -> Iterator[Identifier]:
    modules, types, enums = f"modules of {node.name}", f"types of {node.name}", f"enumerations of {node.name}"
    yield from _ours(modules, names.USED_IN_NODES)
    yield from _ours(modules, DEVICES, _DEVICE)
    yield from _ours(types, names.USED_TYPES)
    yield from _ours(enums, _ENUM_USES)
    for enum in node.enums:
        yield enum.identifier(enums, names.type_name(enum))
        variants = f"variants of {node.name}::{enum.model.name}"
        yield from _ours(variants, (names.catch_all(enum),))
        for member in enum.members:
            yield member.identifier(variants, names.type_name(member))
    for one in node.composites:
        yield one.identifier(modules, one.name)
        yield one.identifier(types, names.type_name(one))
        yield from _members(one)
    for direction in node.directions:
        for message, _ in direction.messages:
            yield message.identifier(
                f"variants of {node.name}::{direction.kind.capitalize()}", names.type_name(message)
            )


def _members(message: Composite[Any]) -> Iterator[Identifier]:
    where = f"{message.node.name}::{message.model.name}"
    fields, methods, associated = f"fields of {where}", f"methods of {where}", f"constants of {where}"
    is_message = isinstance(message, MessageDescription)
    yield from _ours(methods, _METHODS if is_message else _METHODS_OF_STRUCTS)
    if isinstance(message, MessageDescription):
        if message.last_part is not None:
            yield from _ours(methods, (*_OPEN_METHODS, "inner") if message.earlier_parts else _OPEN_METHODS)
        for _, name in arrays.named(message):
            yield message.identifier(methods, arrays.reader(name))
            yield message.identifier(methods, arrays.writer(name))
    yield from _ours(associated, _CONSTANTS if is_message else _CONSTANTS_OF_STRUCTS)
    for field in message.declared_members:
        is_view = field.model.view
        if message.last_part is not None and (field.is_in_last_part or field.is_in_earlier_part):
            yield field.identifier(methods, names.field_name(field))
        yield field.identifier(methods if is_view else fields, names.field_name(field))
        if field.model.when:
            yield field.identifier(methods, names.has(field))
        if field.has_physical:
            yield field.identifier(methods, field.physical_name)
            if field.is_settable:
                yield field.identifier(methods, f"set_{field.physical_name}")
        if field.steps is not None:
            yield field.identifier(methods, single_name(field))
        known = integers_of(field)
        if known is not None:
            name = field.integer_name(known[0].per)
            yield field.identifier(methods, name)
            if not is_view:
                yield field.identifier(methods, f"set_{name}")
        for constant in field.constants:
            yield field.identifier(associated, constant.name.upper())
