"""The crate's testee for the conformance run: an example that answers requests about every message."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen.backends.rust import constants, names
from icdgen.backends.rust.messages import FieldRow, MessageRow
from icdgen.backends.rust.names import Enums
from icdgen.backends.rust.nodes import id_type
from icdgen.backends.rust.text import string
from icdgen.icd.model import Icd, Node

FOLDER = PurePosixPath("examples/testee")


class Route(NamedTuple):
    """Kind of a message, where its id is said, its type."""

    way: str
    id: str
    type: str


class EnumEntry(NamedTuple):
    """Name, type and integer of an enumeration."""

    name: str
    type: str
    raw: str


class FieldEntry(NamedTuple):
    """What the table of fields says."""

    title: str
    name: str
    scale: str
    special: str


class MessageEntry(NamedTuple):
    """A message of the node's own."""

    type: str
    ids: str
    encode: str
    fields: list[FieldEntry]


class Dispatcher(NamedTuple):
    """A sum type of the node."""

    function: str
    type: str
    id_type: str


class NodeEntry:
    """What the testee's template of a node is given."""

    def __init__(self, crate: str, icd: Icd, node: Node, rows: dict[str, list[MessageRow]], enums: Enums) -> None:
        self.name, self.crate = node.name, crate
        spoken = [row for one in (*icd.included(node), node) for row in rows[one.name]]
        self.routes = [route for row in spoken for route in self._routes(row)]
        self.enums = [
            EnumEntry(string(e.name), f"{crate}::{node.name}::enums::{names.type_name(e, node)}", f"u{enums.storage(e)}")
            for e in node.enums
        ]
        kind = id_type(row.message for row in spoken)
        has = {way: any(getattr(row.message, f"{way}_id") is not None for row in spoken) for way in ("telecommand", "telemetry")}
        self.sums = [Dispatcher(way, way.capitalize(), kind) for way, there in has.items() if there]
        self.telecommand, self.telemetry = (f"Some({way})" if there else "None" for way, there in has.items())
        self.messages = [self._message(row) for row in rows[node.name]]

    def _path(self, row: MessageRow) -> str:
        return f"{self.crate}::{row.node.name}::{row.type}"

    def _routes(self, row: MessageRow) -> Iterator[Route]:
        path = self._path(row)
        if row.message.id is not None:
            yield Route(row.message.kind.capitalize(), f"{path}::ID", path)
        else:
            yield Route("Set", f"{path}::SET_ID", path)
            yield Route("Get", f"{path}::GET_ID", path)

    def _message(self, row: MessageRow) -> MessageEntry:
        path = self._path(row)
        ids = ", ".join(f"Self::{one.name} as u16" for one in row.ids)
        encode = "self.try_to_bytes().map(Vec::from)" if row.fallible else "Ok(Vec::from(self.to_bytes()))"
        return MessageEntry(path, ids, encode, [_field(one, row.node) for one in row.fields])


def _field(row: FieldRow, node: Node) -> FieldEntry:
    field, scale, special = row.model, "None", "Vec::new"
    if field.scale is not None:
        name = names.physical_name(field, node)
        scale = f"Some(Scale {{ get: |m| m.{name}(), set: |m, value| m.set_{name}(value) }})"
    if field.special:
        values = ", ".join(f"i128::from(Self::{name})" for name in constants.special_names(field, node))
        special = f"|| vec![{values}]"
    return FieldEntry(string(field.name), row.name, scale, special)


def files(
    icd: Icd, rows: dict[str, list[MessageRow]], enums: Enums, render, common: dict[str, str]
) -> Iterator[tuple[PurePosixPath, str]]:
    """The example's files."""
    for name in ("main", "json", "protocol", "subject"):
        yield FOLDER / f"{name}.rs", render(f"testee/{name}.rs.j2", **common)
    yield FOLDER / "nodes/mod.rs", render("testee/nodes.rs.j2", nodes=icd.nodes, **common)
    for node in icd.nodes:
        entry = NodeEntry(common["crate"], icd, node, rows, enums)
        yield FOLDER / f"nodes/{node.name}.rs", render("testee/node.rs.j2", node=entry, **common)
