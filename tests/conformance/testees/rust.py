"""The Rust testee: a program that answers requests of the conformance run about the
generated crate.

It is a separate package, so that the crate contains no test code. The crate must be
next to it in a folder called ``rust``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.backends.rust import CRATE, names
from icdgen.backends.rust.links import longest_buffer
from icdgen.backends.rust.names import field_name
from icdgen.describe import (
    FieldDescription,
    MessageDescription,
    NodeDescription,
    describe,
)
from icdgen.describe.links import links_of
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from tests.conformance.testees import RUNTIME, TEMPLATES

# The files that answer requests about the protocol.
WIRE = (
    "logs",
    "procedures",
    "scripts",
    "stream",
    "wire",
)


class RouteEntry(NamedTuple):
    """An id, and the type of the message that it selects."""

    id: str
    type: str


class EnumEntry(NamedTuple):
    """Type and integer type of an enumeration."""

    type: str
    raw: str


class FieldEntry(NamedTuple):
    """An entry of the table of fields."""

    value: str
    scale: str
    text: str
    special: str
    limits: str


class MessageEntry(NamedTuple):
    """A message that the node declares."""

    type: str
    ids: str
    fields: list[FieldEntry]


class DispatcherEntry(NamedTuple):
    """A sum type of the node."""

    function: str
    type: str
    id_type: str


class NodeEntry:
    """The values for the testee's template of a node."""

    def __init__(self, crate: str, node: NodeDescription, id_bits: int) -> None:
        self.name, self.crate = node.name, crate
        ways = {
            "telecommand": [(m, m.telecommand_id_name) for m in node.telecommands],
            "telemetry": [(m, m.telemetry_id_name) for m in node.telemetry],
        }
        self.routes = [
            [self._route(*route) for route in routes] for routes in ways.values()
        ]
        self.enums = [
            EnumEntry(
                f"{crate}::{node.name}::enums::{enum.camel_name}",
                f"{'i' if enum.storage.signed else 'u'}{enum.storage.bits}",
            )
            for enum in node.enums
        ]
        self.sums = [
            DispatcherEntry(way, way.capitalize(), f"u{id_bits}")
            for way, routes in ways.items()
            if routes
        ]
        self.dispatchers = [
            f"Some({way})" if routes else "None" for way, routes in ways.items()
        ]
        self.node_type = self._constant("NODE_TYPE", node.model.node_type)
        self.interface_version = self._constant(
            "INTERFACE_VERSION", node.model.interface_version
        )
        self.messages = [self._message(message) for message in node.messages]

    def _constant(self, name: str, value: int | None) -> str:
        return (
            "None"
            if value is None
            else f"Some({self.crate}::{self.name}::{name} as u64)"
        )

    def _path(self, message: MessageDescription) -> str:
        return f"{self.crate}::{message.node.name}::{message.camel_name}"

    def _route(self, message: MessageDescription, id: str) -> RouteEntry:
        path = self._path(message)
        return RouteEntry(f"{path}::{id.upper()}", path)

    def _message(self, message: MessageDescription) -> MessageEntry:
        ids = ", ".join(f"Self::{id.name.upper()} as u32" for id in message.ids)
        return MessageEntry(
            self._path(message),
            ids,
            [_field(field) for field in (*message.fields, *message.read_only_members)],
        )


def _field(field: FieldDescription) -> FieldEntry:
    scale, text, special, limits = "None", "None", "Vec::new", "Vec::new"
    within = f"m.{names.raw_words(field.holder)}" if field.holder else "m"
    if field.is_text:
        argument = "" if field.model.index is None else f"{field.model.index}"
        get = f"|m| {within}.{field.physical_name}({argument})"
        set = f"|m, text| {within}.set_{field.physical_name}({f'{argument}, ' if argument else ''}text)"
        text = f"Some(Text {{ get: {get}, set: {set} }})"
    if field.is_scaled:
        get, set = (
            f"{within}.{field.physical_name}",
            f"{within}.set_{field.physical_name}",
        )
        index = field.model.index
        if field.model.conditions:
            get, set = f"|m| {get}().unwrap_or_default()", f"|m, value| {set}(value)"
        elif index is None:
            get, set = f"|m| {get}()", f"|m, value| {set}(value)"
        else:
            get, set = (
                f"|m| {get}({index}).unwrap_or_default()",
                f"|m, value| {set}({index}, value)",
            )
        set = set if field.is_settable else "|_, _| Ok(())"
        scale = f"Some(Scale {{ get: {get}, set: {set} }})"
    owner = field.declaration.message
    type = (
        "Self"
        if owner is field.message
        else f"{CRATE}::{owner.node.name}::{owner.camel_name}"
    )
    constants = [
        (constant.key, f"{type}::{constant.name.upper()}")
        for constant in field.constants
        if constant.key != "const"
    ]
    if field.model.special:
        bits = ".to_bits()" if field.model.type == "float" else ""
        special = f"|| vec![{', '.join(f'i128::from({name}{bits})' for key, name in constants if key == 'special')}]"
    if field.bounds:
        values = ", ".join(
            f'("{key}", {name} as f64)' for key, name in constants if key != "special"
        )
        limits = f"|| vec![{values}]"
    name = field_name(field)
    value = (
        f"View(|m| Box::new(m.{name}()))"
        if field.model.is_read_only
        else f"Member(|m| &mut m.{name})"
    )
    return FieldEntry(value, scale, text, special, limits)


class RustTesteeBackend:
    """A package with one program, next to the crate."""

    name = "rust-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Return a package with the binary ``testee``."""
        common = {"origin": origin(), "version": __version__, "crate": CRATE}
        description = describe(icd)
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        links = links_of(description)
        yield (
            PurePosixPath("src/main.rs"),
            render("main.rs.j2", wired=bool(links), **common),
        )
        for file in render.runtime_files():
            if links or PurePosixPath(file).stem not in WIRE:
                yield PurePosixPath(file), render.source(file)
        yield (
            PurePosixPath("src/nodes/mod.rs"),
            render(
                "nodes.rs.j2",
                nodes=icd.nodes,
                wired=bool(links),
                links=list(links),
                with_procedures=[
                    name for name, link in links.items() if link.facts.procedures
                ],
                longest=max(map(longest_buffer, links.values()), default=0),
                **common,
            ),
        )
        for node in description.nodes:
            entry = NodeEntry(CRATE, node, description.id_bits)
            yield (
                PurePosixPath(f"src/nodes/{node.name}.rs"),
                render("node.rs.j2", node=entry, **common),
            )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers, because the testee only uses names of the crate."""
        return iter(())
