"""The Rust testee: a program that answers the requests of the conformance run about the generated crate.

It is a package of its own, so that the crate stays free of it; the crate must lie beside it in a folder called ``rust``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.backends.rust import CRATE, constants, message_rows, names, wire
from icdgen.backends.rust.messages import FieldRow, MessageRow
from icdgen.backends.rust.names import Enums
from icdgen.backends.rust.nodes import id_type
from icdgen.backends.rust.text import string
from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts
from tests.conformance.testees import RUNTIME, TEMPLATES

WIRE = ("ask", "client", "file", "logs", "wire")  # what answers requests about the protocol


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
    limits: str


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
            EnumEntry(
                string(e.name), f"{crate}::{node.name}::enums::{names.type_name(e, node)}", f"u{enums.storage(e)}"
            )
            for e in node.enums
        ]
        kind = id_type(icd)
        has = {
            way: any(getattr(row.message, f"{way}_id") is not None for row in spoken)
            for way in ("telecommand", "telemetry")
        }
        self.sums = [Dispatcher(way, way.capitalize(), kind) for way, there in has.items() if there]
        self.telecommand, self.telemetry = (f"Some({way})" if there else "None" for way, there in has.items())
        self.node_type = self._constant("NODE_TYPE", node.node_type)
        self.interface_version = self._constant("INTERFACE_VERSION", node.interface_version)
        self.messages = [self._message(row) for row in rows[node.name]]

    def _constant(self, name: str, value: int | None) -> str:
        return "None" if value is None else f"Some({self.crate}::{self.name}::{name} as u64)"

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
        encode = "self.try_to_bytes().map(Vec::from)" if row.fits else "Ok(Vec::from(self.to_bytes()))"
        return MessageEntry(path, ids, encode, [_field(one, row.node) for one in row.fields])


def _field(row: FieldRow, node: Node) -> FieldEntry:
    field, scale, special, limits = row.model, "None", "Vec::new", "Vec::new"
    if field.scale is not None:
        name = names.physical_name(field, row.name)
        scale = f"Some(Scale {{ get: Self::{name}, set: Self::set_{name} }})"
    if field.special:
        values = ", ".join(f"i128::from(Self::{name})" for name in constants.special_names(field, node))
        special = f"|| vec![{values}]"
    if field.limits is not None:
        values = ", ".join(
            f'("{key}", Self::{name} as f64)' for key, name in constants.limit_names(field, node).items()
        )
        limits = f"|| vec![{values}]"
    return FieldEntry(string(field.name), row.name, scale, special, limits)


class RustTesteeBackend:
    """A package of one program, beside the crate."""

    name = "rust-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def __init__(self, crate: str = CRATE) -> None:
        self.crate = crate

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """A package with one binary, ``testee``."""
        common = {"origin": origin(), "version": __version__, "crate": self.crate}
        enums = Enums(icd)
        rows = {node.name: message_rows(icd, node, enums) for node in icd.nodes}
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        known = [facts.of(icd, node) for node in icd.nodes if icd.protocol_of(node)]
        for name in ("main", "json", "protocol", "subject", *(WIRE if known else ())):
            yield PurePosixPath(f"src/{name}.rs"), render(f"{name}.rs.j2", wired=bool(known), **common)
        yield PurePosixPath("src/nodes/mod.rs"), render(
            "nodes.rs.j2",
            nodes=icd.nodes,
            wired=bool(known),
            links=[one.node.name for one in known],
            longest=max(map(wire.longest, known), default=0),
            **common,
        )
        for node in icd.nodes:
            entry = NodeEntry(self.crate, icd, node, rows, enums)
            yield PurePosixPath(f"src/nodes/{node.name}.rs"), render("node.rs.j2", node=entry, **common)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None of its own: it only uses the crate's names."""
        return iter(())
