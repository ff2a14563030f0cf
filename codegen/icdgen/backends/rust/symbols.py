"""Names that the crate declares, for the symbol table.

The rules on names report two equal names of a scope before any code is generated; see
`icdgen.describe.symbols`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from icdgen.backends import Identifier
from icdgen.backends.rust import names
from icdgen.backends.rust.physical import accessors_in_rust
from icdgen.describe import (
    Description,
    EnumDescription,
    FieldDescription,
    MessageDescription,
    NodeDescription,
)
from icdgen.describe.arrays import looped_arrays
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription
from icdgen.describe.symbols import NamingPolicy, Symbols
from icdgen.naming import DEVICES, camel, words

_METHODS = ("from_bytes", "from_array", "to_bytes", "default")
_METHODS_OF_VARIABLE_LENGTH = ("from_longest", "size")
_CONSTANTS = ("NAME", "LENGTH", "ID", "SET_ID", "GET_ID")
_METHODS_OF_STRUCTS = ("fit", "rows", "default")
_CONSTANTS_OF_STRUCTS = ("NAME", "FIELDS")
_USED_BY_ENUMS = ("Option", "From", "Enumeration")
_CRATE = "modules of the crate"
_OWN = "a name of the generated code"
_CATCH_ALL = ("Unknown", "Unlisted", "Unnamed", "AnyOther")


class RustNames(NamingPolicy):
    """Names in Rust.

    Modules, types, variants, fields, methods and constants are scopes of their own.
    """

    reserved = names.RESERVED

    def fixed(self, description: Description) -> Symbols:
        yield from _used_names(_CRATE, names.USED_MODULES)
        for name, use in names.ROOTS.items():
            yield Identifier(_CRATE, name, use, None)
        # Modules are files, and Windows opens a device for `nul.rs`.
        yield from _used_names(_CRATE, DEVICES, "a device of Windows")

    def node(self, node: NodeDescription) -> Symbols:
        yield node.identifier(_CRATE, node.name)
        yield from _used_names(f"modules of {node.name}", names.USED_IN_NODES)
        yield from _used_names(
            f"modules of {node.name}", DEVICES, "a device of Windows"
        )
        yield from _used_names(f"types of {node.name}", names.USED_TYPES)
        yield from _used_names(f"enumerations of {node.name}", _USED_BY_ENUMS)

    def message_of_direction(
        self, node: NodeDescription, direction: str, message: MessageDescription
    ) -> Symbols:
        scope = f"variants of {node.name}::{direction.capitalize()}"
        yield message.identifier(scope, message.camel_name)

    def link(self, node: NodeDescription) -> Symbols:
        """Names of the procedures and of their outputs."""
        scope, source = f"{names.PROCEDURES_MODULE} of {node.name}", node.model.source
        if node.procedures:
            yield from _used_names(scope, ("ALL",))
        for name, row in node.procedures.items():
            owner = f"procedure `{name}`"
            for text in (
                procedure_type(name),
                names.constant_name(name),
                names.memory_constant(name),
            ):
                yield Identifier(scope, text, owner, source)
            methods = f"methods of {node.name}::{procedure_type(name)}"
            yield from _used_names(methods, ("new",))
            for output in row.get("outputs", {}):
                yield Identifier(methods, output, f"`{output}` of {owner}", source)

    def enumeration(self, enum: EnumDescription) -> Symbols:
        yield enum.identifier(
            f"enumerations of {enum.node.name}", enum.camel_name, "type"
        )
        yield Identifier(
            _variants_scope(enum), _catch_all(enum), _OWN, None, "catch_all"
        )

    def member(self, enum: EnumDescription, member: MemberDescription) -> Symbols:
        yield member.identifier(_variants_scope(enum), member.camel_name, "variant")

    def composite(self, composite: Composite[Any]) -> Symbols:
        node, scope = composite.node.name, _scope(composite)
        yield composite.identifier(f"modules of {node}", composite.name)
        yield composite.identifier(f"types of {node}", composite.camel_name, "type")
        methods, constants = f"methods of {scope}", f"constants of {scope}"
        if not isinstance(composite, MessageDescription):
            yield from _used_names(methods, _METHODS_OF_STRUCTS)
            yield from _used_names(constants, _CONSTANTS_OF_STRUCTS)
            return
        yield from _used_names(methods, _METHODS)
        yield from _used_names(constants, _CONSTANTS)
        if composite.last_part is not None:
            yield from _used_names(methods, _METHODS_OF_VARIABLE_LENGTH)
        if composite.spread_parts:  # `inner` returns their sizes
            yield from _used_names(methods, ("inner",))
        for _, name in looped_arrays(composite):
            yield composite.identifier(methods, names.reader(name))
            yield composite.identifier(methods, names.writer(name))

    def fields(
        self, composite: Composite[Any], fields: Iterable[FieldDescription]
    ) -> Symbols:
        scope, has_variable_parts = _scope(composite), composite.last_part is not None
        members = f"fields of {scope}"
        methods = f"methods of {scope}"
        constants = f"constants of {scope}"
        for field in fields:
            name, is_read_only = names.own_name(field), field.model.is_read_only
            # Fields and methods have separate namespaces in Rust, so the member and the
            # method that returns its present elements can have the same name.
            if has_variable_parts and (
                field.is_in_last_part or field.is_in_earlier_part
            ):
                yield field.identifier(methods, name)
            yield field.identifier(methods if is_read_only else members, name)
            if field.model.conditions:
                yield field.identifier(methods, names.has(field))
            for accessor in accessors_in_rust(field):
                yield field.identifier(methods, accessor.name)
                if accessor.is_settable:
                    yield field.identifier(methods, names.setter(accessor.name))
            for constant in field.constants:
                yield field.identifier(constants, names.constant_name(constant.name))


RUST_NAMES = RustNames()


def procedure_type(name: str) -> str:
    """Return the name of the type of a procedure: ``ProgramCopy``."""
    return camel(words(name))


def _scope(composite: Composite[Any]) -> str:
    return f"{composite.node.name}::{composite.model.name}"


def _variants_scope(enum: EnumDescription) -> str:
    return f"variants of {enum.node.name}::{enum.model.name}"


def _catch_all(enum: EnumDescription) -> str:
    """Return the variant that keeps values without a name: the first name that no
    member has.
    """
    taken = {member.camel_name for member in enum.members}
    # If members have all of these names, the table lists one of them twice, and the
    # rules on names report it.
    return next((name for name in _CATCH_ALL if name not in taken), _CATCH_ALL[0])


def _used_names(
    scope: str, texts: Iterable[str], use: str = _OWN
) -> Iterator[Identifier]:
    """Names that the generated code itself declares or refers to in a scope."""
    return (Identifier(scope, text, use, None) for text in texts)
