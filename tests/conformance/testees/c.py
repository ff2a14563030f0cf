"""The C testee: tables that refer to the generated code of every message and field."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen.backends import Identifier
from icdgen.backends.c import names
from icdgen.backends.c.names import checksum_function
from icdgen.backends.c.procedures import ProcedureCode
from icdgen.backends.c.short_names import with_short_names
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.types import type_of
from icdgen.backends.origin import origin
from icdgen.describe import (
    Description,
    EnumDescription,
    FieldDescription,
    MessageDescription,
    NodeDescription,
    describe,
)
from icdgen.describe.links import Assumptions, LinkDescription, links_of
from icdgen.describe.symbols import symbols
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from tests.conformance.testees import RUNTIME, TEMPLATES

# The other files need a protocol.
MESSAGES = frozenset(
    {"testee.h", "testee_line.h", "testee_line.c", "testee_messages.c"}
)
TYPES = {"bool": "TESTEE_BOOL", "bytes": "TESTEE_BYTES", "text": "TESTEE_BYTES"}


class Limit(NamedTuple):
    """A limit of a field: its kind and its macro."""

    key: str
    name: str


class FieldRow(NamedTuple):
    """An entry of a message's table of fields. Properties that a field does not have
    are empty.
    """

    type: str
    name: str  # in the names of functions
    member: str
    # The offset of the message, or of the struct with the field.
    holder: str
    element: str  # the index of an element of an array, and a comma
    size: int
    name_of: str
    get: str
    set: str
    get_text: str
    set_text: str
    has: str  # the function that returns whether the field is present
    view: str  # the function; its type is ``c_type``
    c_type: str
    special: list[str]
    float_bits: int
    limits: list[Limit]


class MessageRow(NamedTuple):
    """A message that the node declares or includes."""

    stem: str
    length: str
    ids: list[str]
    misfit: bool
    is_open: bool
    fields: list[FieldRow]


class EnumRow(NamedTuple):
    """An enumeration. ``outside`` is the test for values outside its type."""

    name: str
    is_signed: bool
    outside: str


class Route(NamedTuple):
    """The message that an id selects."""

    id: str
    which: str  # enumerator of the message, if messages share the id
    stem: str


class Dispatcher(NamedTuple):
    """A dispatcher of the node."""

    direction: str
    name: str
    is_shared: bool
    routes: list[Route]
    is_open: bool  # frames of some of its messages differ in length


class ProcedureRow(NamedTuple):
    """A procedure of a node and the call of its typed function."""

    place: int
    form: str
    name: str
    types: list[str]  # of the inputs that are numbers
    arguments: list[str]
    outputs: list[str]


class CTesteeBackend:
    """Includes the headers of the ``c`` backend and takes all names from its plan."""

    name = "c-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Return the files common to all ICDs, the list of nodes, and one file per
        node.
        """
        description = describe(icd)
        yield from with_short_names(
            self._files(description, render), symbols(description, C_NAMES)
        )

    def _files(
        self, description: Description, render: Renderer
    ) -> Iterator[tuple[PurePosixPath, str]]:
        """Return the files with the names of the plan, some of which the C backend
        shortens.
        """
        linked = {
            place: node.name
            for place, node in enumerate(description.nodes)
            if node.is_linked
        }
        for name in render.runtime_files():
            if linked or name in MESSAGES:
                yield PurePosixPath(name), render.source(name)
        nodes = [node.name for node in description.nodes]
        links = links_of(description)
        procedures = {
            place: list(_procedures(description.node(name), links[name]))
            for place, name in linked.items()
        }
        yield (
            PurePosixPath("testee_nodes.c"),
            render(
                "nodes.c.j2",
                origin=origin(),
                nodes=nodes,
                linked=linked,
                procedures=procedures,
                checksums={
                    place: [
                        (
                            each.encode().hex(),
                            checksum_function(description.node(name), each),
                        )
                        for each in description.node(name).checksums
                    ]
                    for place, name in linked.items()
                },
            ),
        )
        yield (
            PurePosixPath("testee_ops.c"),
            render("ops.c.j2", origin=origin(), linked=bool(linked)),
        )
        for node in description.nodes:
            values = _Rows(node).all()
            yield (
                PurePosixPath(f"nodes/{node.name}.c"),
                render("node.c.j2", origin=origin(node.model), **values),
            )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers, because all names derive from names of the ``c``
        backend.
        """
        return iter(())


def _procedures(node: NodeDescription, link: LinkDescription) -> Iterator[ProcedureRow]:
    assumed = Assumptions(link.facts)
    for place, each in enumerate(link.facts.procedures):
        yield _procedure(place, ProcedureCode(node, link, each, assumed))


def _procedure(place: int, code: ProcedureCode) -> ProcedureRow:
    inputs, types = [], []
    for each in code.procedure.inputs:
        if each.is_bytes:
            inputs += ["given->bytes", "given->byte_count"]
        else:
            inputs.append(f"({code.type_of(each)})numbers[{len(types)}]")
            types.append(code.type_of(each))
    members = {value: member for member, value in code.members}
    memory = [f"given->{members[name]}" for name in code.memory_names]
    bus = ["bus"] if code.needs_bus else []
    return ProcedureRow(
        place,
        code.form,
        code.name,
        types,
        ["procedure", *bus, *inputs, *memory],
        [output.name for output in code.outputs],
    )


class _Rows:
    """The values for the template of one node's file."""

    def __init__(self, node: NodeDescription) -> None:
        self.node = node

    def all(self) -> dict[str, object]:
        node, upper = self.node, self.node.name.upper()
        used = {
            f.enum: None
            for message in node.messages
            for member in message.declared_members
            for f in member.scalars
            if f.enum is not None
        }
        dispatchers = [
            self.dispatcher(
                "telecommand", [(m, m.telecommand_id_name) for m in node.telecommands]
            ),
            self.dispatcher(
                "telemetry", [(m, m.telemetry_id_name) for m in node.telemetry]
            ),
        ]
        return {
            "node": node.name,
            "id_type": f"uint{node.id_bits}_t",
            "messages": [self.message(message) for message in node.messages],
            "included": [
                names.stem(message)
                for message in node.all_messages
                if message not in node.messages
            ],
            "enums": [_enum(enum) for enum in dict.fromkeys(node.enums) | used],
            "own_enums": [_enum(enum) for enum in node.enums],
            "dispatchers": [
                dispatcher for dispatcher in dispatchers if dispatcher.routes
            ],
            "node_type": (
                f"{upper}_NODE_TYPE" if node.model.node_type is not None else -1
            ),
            "interface_version": (
                f"{upper}_INTERFACE_VERSION"
                if node.model.interface_version is not None
                else -1
            ),
        }

    def dispatcher(
        self, direction: str, messages: list[tuple[MessageDescription, str]]
    ) -> Dispatcher:
        name, is_shared = (
            f"{self.node.name}_{direction}",
            self.node.shares_ids(direction),
        )
        routes = [
            Route(
                names.constant(message, id),
                names.enumerator_of(name, message) if is_shared else "0u",
                names.stem(message),
            )
            for message, id in messages
        ]
        is_open = any(message.last_part is not None for message, _ in messages)
        return Dispatcher(direction, name, is_shared, routes, is_open)

    def message(self, message: MessageDescription) -> MessageRow:
        return MessageRow(
            stem=names.stem(message),
            length=names.constant(message, "length"),
            ids=[names.constant(message, id.name) for id in message.ids],
            misfit=message.is_narrow,
            is_open=message.last_part is not None,
            fields=[
                self.field(field)
                for field in (*message.fields, *message.read_only_members)
            ],
        )

    def field(self, described: FieldDescription) -> FieldRow:
        owner = described.declaration.message
        field, stem = described.model, names.stem(owner)
        macros = [
            (constant.key, names.constant(owner, constant.name))
            for constant in described.constants
        ]
        return FieldRow(
            type=(
                "TESTEE_SIGNED"
                if field.is_signed
                else TYPES.get(field.type, "TESTEE_UNSIGNED")
            ),
            name=described.name,
            member=described.member,
            holder=described.holder,
            element=f"{field.index}u, " if field.index is not None else "",
            size=field.bits // 8 if field.is_bytes else described.storage.bits // 8,
            name_of=(
                f"{self.node.name}_{names.stem(described.enum)}_testee_name"
                if described.enum is not None
                else ""
            ),
            get=f"{stem}_{described.physical_name}" if described.is_scaled else "",
            set=(
                f"{stem}_set_{described.physical_name}"
                if described.is_scaled and described.is_settable
                else ""
            ),
            get_text=f"{stem}_{described.physical_name}" if described.is_text else "",
            set_text=f"{stem}_set_{described.physical_name}"
            if described.is_text
            else "",
            has=names.has(described.message, described.name)
            if field.conditions
            else "",
            view=f"{stem}_{described.name}" if field.is_read_only else "",
            c_type=type_of(described) if field.is_read_only else "",
            special=[name for key, name in macros if key == "special"],
            float_bits=field.bits if field.type == "float" else 0,
            limits=[
                Limit(key, name)
                for key, name in macros
                if key not in ("const", "special")
            ],
        )


def _enum(enum: EnumDescription) -> EnumRow:
    bits, signed = enum.storage
    outside = (
        f"(int64_t)value < INT{bits}_MIN || (int64_t)value > INT{bits}_MAX"
        if signed
        else f"value > UINT{bits}_MAX"
    )
    return EnumRow(names.stem(enum), signed, outside)
