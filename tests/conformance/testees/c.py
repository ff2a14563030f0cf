"""The C testee: tables that lead to the generated code of every message and field."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen.backends import Identifier
from icdgen.backends.c import names
from icdgen.backends.c.text import literal
from icdgen.backends.origin import origin
from icdgen.describe import EnumDescription, FieldDescription, MessageDescription, NodeDescription, describe
from icdgen.icd.model import CONFIGURATION, Icd
from icdgen.render import Renderer
from tests.conformance.testees import RUNTIME, TEMPLATES

WIRE_PARTS = frozenset(  # what answers requests about the protocol
    "testee_ask.c testee_blocks.c testee_can.c testee_client.c testee_file.c testee_logs.c testee_wire.c testee_wire.h".split()
)
TYPES = {"bool": "TESTEE_BOOL", "float": "TESTEE_FLOAT", "bytes": "TESTEE_BYTES", "int": "TESTEE_SIGNED"}


class Limit(NamedTuple):
    """A limit of a field: its kind, and the macro."""

    key: str
    name: str


class FieldRow(NamedTuple):
    """An entry of a message's table of fields."""

    text: str
    type: str
    member: str
    size: int
    name_of: str  # empty: none; so are the accessors
    get: str
    set: str
    special: list[str]
    limits: list[Limit]


class Pair(NamedTuple):
    """The accessors of a scaled field."""

    get: str
    set: str


class MessageRow(NamedTuple):
    """A message that the node declares or includes."""

    stem: str
    text: str
    length: str
    ids: list[str]
    misfit: bool
    fields: list[FieldRow]
    scaled: list[Pair]


class EnumRow(NamedTuple):
    """An enumeration; ``most`` is the largest value that its type holds."""

    name: str
    text: str
    most: str


class Route(NamedTuple):
    """An id that leads to a message."""

    id: str
    configuration: str
    stem: str


class Dispatcher(NamedTuple):
    """A dispatcher of the node."""

    name: str
    id_type: str
    routes: list[Route]


class CTesteeBackend:
    """Answers requests, one line of JSON each. Includes the headers of the ``c`` backend and takes all names from its plan."""

    name = "c-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Files that are the same for every ICD, the list of nodes, and one file a node."""
        return files(icd, render)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None of its own: all are made from those of the ``c`` backend."""
        return iter(())


def files(icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
    """The program: files that are the same for every ICD, the list of nodes, and one file a node."""
    wire = any(icd.protocol_of(node) for node in icd.nodes)
    for name in ("testee.h", "testee.c"):
        yield PurePosixPath(name), render(f"{name}.j2", origin=origin(), wire=wire)
    for name in render.runtime_files():
        if wire or name not in WIRE_PARTS:
            yield PurePosixPath(name), render.source(name)
    nodes = [node.name for node in icd.nodes]
    yield PurePosixPath("testee_nodes.c"), render("nodes.c.j2", origin=origin(), nodes=nodes)
    for node in describe(icd).nodes:
        yield PurePosixPath(f"nodes/{node.name}.c"), render("node.c.j2", origin=origin(node.model), **_Rows(node).all())


class _Rows:
    """The finished values of one node's file."""

    def __init__(self, node: NodeDescription) -> None:
        self.node = node

    def all(self) -> dict[str, object]:
        node = self.node
        used = {field.enum: None for message in node.spoken for field in message.fields if field.enum is not None}
        found = {
            "telecommand": self.dispatcher("telecommand", [(m, m.telecommand_id_name) for m in node.telecommands]),
            "telemetry": self.dispatcher("telemetry", [(m, m.telemetry_id_name) for m in node.telemetry]),
        }
        upper, one = node.name.upper(), node.model
        return {
            "node": node.name,
            "link": node.is_linked,
            "header": f"{node.name}.h",
            "messages": [self.message(message) for message in node.spoken],
            "enums": [self.enum(enum) for enum in dict.fromkeys(node.enums) | used],
            "own_enums": [self.enum(enum) for enum in node.enums],
            "dispatchers": [one for one in found.values() if one.routes],
            "node_type": f"{upper}_NODE_TYPE" if one.node_type is not None else -1,
            "interface_version": f"{upper}_INTERFACE_VERSION" if one.interface_version is not None else -1,
            **{direction: f"&{one.name}_testee" if one.routes else "" for direction, one in found.items()},
        }

    def dispatcher(self, direction: str, messages: list[tuple[MessageDescription, str]]) -> Dispatcher:
        routes = [
            Route(names.constant(one, id), str(one.model.kind == CONFIGURATION).lower(), names.stem(one))
            for one, id in messages
        ]
        return Dispatcher(f"{self.node.name}_{direction}", f"uint{self.node.id_bits}_t", routes)

    def enum(self, enum: EnumDescription) -> EnumRow:
        return EnumRow(names.stem(enum), literal(enum.model.name), f"UINT{enum.storage.bits}_MAX")

    def message(self, message: MessageDescription) -> MessageRow:
        return MessageRow(
            stem=names.stem(message),
            text=literal(message.model.name),
            length=names.constant(message, "length"),
            ids=[names.constant(message, id.name) for id in message.ids],
            misfit=message.is_narrow,
            fields=[self.field(field) for field in message.fields],
            scaled=[accessors(field) for field in message.fields if field.steps],
        )

    def field(self, one: FieldDescription) -> FieldRow:
        field, pair = one.model, accessors(one) if one.steps else None
        macros = [(constant.key, names.constant(one.message, constant.name)) for constant in one.constants]
        return FieldRow(
            text=literal(field.name),
            type=TYPES.get(field.type, "TESTEE_UNSIGNED"),
            member=one.name,
            size=field.bits // 8 if field.type == "bytes" else one.storage.bits // 8,
            name_of=f"{self.node.name}_{names.stem(one.enum)}_testee_name" if one.enum is not None else "",
            get=f"{pair.get}_testee" if pair else "",
            set=f"{pair.set}_testee" if pair else "",
            special=[name for key, name in macros if key == "special"],
            limits=[Limit(key, name) for key, name in macros if key not in ("const", "special")],
        )


def accessors(field: FieldDescription) -> Pair:
    """Names of the getter and the setter of the physical value."""
    stem, end = names.stem(field.message), field.physical_name
    return Pair(f"{stem}_{end}", f"{stem}_set_{end}")
