"""Names that the headers declare, for the symbol table.

The rules on names report two equal names before any code is generated. Templates take
names from here by role, so that they cannot declare a name that the rules do not see;
see `icdgen.describe.symbols`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from icdgen.backends import Identifier
from icdgen.backends.c import names
from icdgen.describe import (
    Description,
    EnumDescription,
    FieldDescription,
    MessageDescription,
    NodeDescription,
)
from icdgen.describe.accessors import accessors_of
from icdgen.describe.arrays import all_struct_arrays
from icdgen.describe.contained import contained_messages
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription
from icdgen.describe.symbols import DescribedPart, NamingPolicy, Symbols
from icdgen.icd.procedures import BYTES

FILE = "C names at file scope"
FILES = "C header files"

_STATUS = ("LENGTH", "RANGE", "UNKNOWN_ID", "UNSUPPORTED", "CHECKSUM", "BUSY")
_SUPPORT = (
    "ICDGEN_SHARED",
    "icd_status_t",
    "ICD_OK",
    *(f"ICD_ERROR_{end}" for end in _STATUS),
)
_SIZES = (
    "LONGEST", "CAN_SLOT_BYTES", "CLIENT_BYTES", "REQUEST_BYTES", "LOG_BYTES", "LINE_BYTES", "SEQUENCES",
)  # fmt: skip
_BUSES = ("uart", "i2c", "can")


class CNames(NamingPolicy):
    """Names in C.

    All names at file scope begin with that of the node; a role is the end of the name.
    """

    reserved = names.RESERVED

    def fixed(self, description: Description) -> Symbols:
        # All names of a node begin with its name, so only a node `icd` or `icdgen` can
        # declare one of these.
        for name in _SUPPORT:
            yield Identifier(FILE, name, "the support header", None)
        yield Identifier(FILES, "icdgen.h", "the support header", None)
        yield Identifier(FILES, "icdgen_wide.h", "formulas of many digits", None)
        for end in ("h", "c"):
            yield Identifier(FILES, f"icdgen_wire.{end}", "the wire layer", None)

    def node(self, node: NodeDescription) -> Symbols:
        yield node.identifier(FILES, f"{node.name}.h")
        for end in ("ICD_DIGEST", "NODE_TYPE", "INTERFACE_VERSION", "H"):
            yield node.identifier(FILE, f"{node.name.upper()}_{end}", end)
        for kind in ("telemetry", "telecommand"):
            owner, source = f"{kind} of node `{node.name}`", node.model.source
            rare = ("which", "which_t") if node.shares_ids(kind) else ()
            for end in ("t", "name", "length", "size", "decode", "encode", *rare):
                yield Identifier(
                    FILE, f"{node.name}_{kind}_{end}", owner, source, f"{kind}_{end}"
                )
        if node.enums:
            owner = "the enumerations"
            yield Identifier(FILES, f"{node.name}/enums.h", owner, None)
            yield Identifier(
                FILE, f"{node.name.upper()}_ENUMS_H", owner, None, "ENUMS_H"
            )

    def in_node(self, node: NodeDescription, part: DescribedPart) -> Symbols:
        if not isinstance(part, MessageDescription):
            return
        for direction in part.directions:
            stem = f"{node.name}_{direction}"
            if node.shares_ids(direction):
                yield part.identifier(FILE, names.enumerator_of(stem, part))
            yield part.identifier(f"members of {stem}_t", part.name)
            if node.is_linked:
                for verb in names.client_verbs(node, direction):
                    yield part.identifier(
                        FILE, names.client_function(node.name, verb, part)
                    )

    def link(self, node: NodeDescription) -> Symbols:
        owner, source = f"the link of node `{node.name}`", node.model.source
        for file in ("link.h", "link.c", "client.h"):
            yield Identifier(FILES, f"{node.name}/{file}", owner, source)
        kinds = (
            [name for bus in _BUSES for name in (f"client_{bus}", f"{bus}_link")]
            if node.has_client
            else ["client_init", "sender_t", "sender_init"]
        )
        for end in ("link", "client_t", "refusal", *kinds):
            yield Identifier(FILE, f"{node.name}_{end}", owner, source, end)
        for end in (*_SIZES, "NODE", "LINK_H", "LINK_C", "CLIENT_H"):
            yield Identifier(FILE, f"{node.name.upper()}_{end}", owner, source, end)
        if node.procedures:
            yield Identifier(FILES, f"{node.name}/procedures.h", owner, source)
            guard = f"{node.name.upper()}_PROCEDURES_H"
            yield Identifier(FILE, guard, owner, source, "PROCEDURES_H")
        for name in node.checksums:
            function = names.checksum_function(node, name)
            about = f"checksum `{name}` of node `{node.name}`"
            yield Identifier(FILE, function, about, source)
        for name, section in node.procedures.items():
            yield from self._procedure(node, name, section)

    def _procedure(
        self, node: NodeDescription, name: str, section: Mapping[str, Any]
    ) -> Symbols:
        """Names of a procedure, and of the parameters of its function."""
        owner, source = f"procedure `{name}` of node `{node.name}`", node.model.source
        stem = names.procedure(node, name)
        yield Identifier(FILE, stem, owner, source)
        yield Identifier(FILE, names.procedure(node, name, "form"), owner, source)
        for output in section.get("outputs", {}):
            yield Identifier(FILE, names.procedure(node, name, output), owner, source)
        for end in ("BLOCK_BYTES", "BITMAP_BYTES"):
            yield Identifier(FILE, names.procedure_size(node, name, end), owner, source)
        # The parameters that the generator adds are in the scope as well, so that the
        # rules report an input of the same name.
        for parameter in names.PROCEDURE_PARAMETERS:
            yield Identifier(f"parameters of {stem}", parameter, owner, None)
        for input, row in section.get("inputs", {}).items():
            for parameter in names.input_parameters(input, row.get("type") == BYTES):
                about = f"input `{input}` of {owner}"
                yield Identifier(f"parameters of {stem}", parameter, about, source)

    def enumeration(self, enum: EnumDescription) -> Symbols:
        for end in ("t", "name"):
            yield enum.identifier(FILE, f"{names.stem(enum)}_{end}", end)

    def member(self, enum: EnumDescription, member: MemberDescription) -> Symbols:
        yield member.identifier(FILE, names.enumerator(enum, member))

    def composite(self, composite: Composite[Any]) -> Symbols:
        stem = names.stem(composite)
        yield composite.identifier(FILES, f"{composite.node.name}/{composite.name}.h")
        yield composite.identifier(FILE, names.constant(composite, "h"), "H")
        for end in ("t", "init", "fields"):
            yield composite.identifier(FILE, f"{stem}_{end}", end)
        if not isinstance(composite, MessageDescription):
            return
        for end in ("length", *(id.name for id in composite.ids)):
            yield composite.identifier(
                FILE, names.constant(composite, end), end.upper()
            )
        rare = (
            *(("misfit",) if composite.is_narrow else ()),
            *(("size",) if composite.last_part else ()),
        )
        for end in ("decode", "encode", *rare):
            yield composite.identifier(FILE, f"{stem}_{end}", end)
        for array in all_struct_arrays(composite):
            yield composite.identifier(
                FILE, names.element_reader(composite, array.name)
            )
            yield composite.identifier(
                FILE, names.element_writer(composite, array.name)
            )
        last = composite.last_part
        if (
            last is not None
            and last.element_struct is not None
            and not composite.has_inner_gaps
        ):
            yield composite.identifier(
                FILE, names.received_element_reader(composite, last.field.name)
            )
        for part in contained_messages(composite):
            yield composite.identifier(FILE, f"{stem}_{names.part_name(part.message)}")

    def fields(
        self, composite: Composite[Any], fields: Iterable[FieldDescription]
    ) -> Symbols:
        members = f"members of {names.stem(composite)}_t"
        for field in fields:
            if field.model.is_read_only:
                yield field.identifier(FILE, names.getter(composite, field.name))
            else:
                yield field.identifier(members, field.name)
            if field.model.conditions:
                yield field.identifier(FILE, names.has(composite, field.name))
            for accessor in accessors_of(field, "text", "double", "integer"):
                yield field.identifier(FILE, names.getter(composite, accessor.name))
                if accessor.is_settable:
                    yield field.identifier(FILE, names.setter(composite, accessor.name))
            for constant in field.constants:
                yield field.identifier(FILE, names.constant(composite, constant.name))


C_NAMES = CNames()
