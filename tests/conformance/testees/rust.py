"""The Rust testee: a program that answers the requests of the conformance run about the
generated crate.

It is a package of its own, so that the crate stays free of it; the crate must lie
beside it in a folder called ``rust``.
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

WIRE = (
    "logs",
    "procedures",
    "scripts",
    "stream",
    "wire",
)  # what answers requests about the protocol


class Route(NamedTuple):
    """Where an id is said, and the type of the message that it leads to."""

    id: str
    type: str


class EnumEntry(NamedTuple):
    """Type and integer of an enumeration."""

    type: str
    raw: str


class FieldEntry(NamedTuple):
    """What the table of fields says."""

    value: str
    scale: str
    text: str
    special: str
    limits: str


class MessageEntry(NamedTuple):
    """A message of the node's own."""

    type: str
    ids: str
    fields: list[FieldEntry]


class Dispatcher(NamedTuple):
    """A sum type of the node."""

    function: str
    type: str
    id_type: str


class NodeEntry:
    """What the testee's template of a node is given."""

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
            Dispatcher(way, way.capitalize(), f"u{id_bits}")
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

    def _route(self, message: MessageDescription, id: str) -> Route:
        path = self._path(message)
        return Route(f"{path}::{id.upper()}", path)

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
        which = "" if field.model.index is None else f"{field.model.index}"
        get = f"|m| {within}.{field.physical_name}({which})"
        set = f"|m, text| {within}.set_{field.physical_name}({f'{which}, ' if which else ''}text)"
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
    known = [
        (one.key, f"{type}::{one.name.upper()}")
        for one in field.constants
        if one.key != "const"
    ]
    if field.model.special:
        bits = ".to_bits()" if field.model.type == "float" else ""
        special = f"|| vec![{', '.join(f'i128::from({name}{bits})' for key, name in known if key == 'special')}]"
    if field.bounds:
        values = ", ".join(
            f'("{key}", {name} as f64)' for key, name in known if key != "special"
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
    """A package of one program, beside the crate."""

    name = "rust-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """A package with one binary, ``testee``."""
        common = {"origin": origin(), "version": __version__, "crate": CRATE}
        description = describe(icd)
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        known = links_of(description)
        yield (
            PurePosixPath("src/main.rs"),
            render("main.rs.j2", wired=bool(known), **common),
        )
        for file in render.runtime_files():
            if known or PurePosixPath(file).stem not in WIRE:
                yield PurePosixPath(file), render.source(file)
        yield (
            PurePosixPath("src/nodes/mod.rs"),
            render(
                "nodes.rs.j2",
                nodes=icd.nodes,
                wired=bool(known),
                links=list(known),
                with_procedures=[
                    name for name, link in known.items() if link.facts.procedures
                ],
                longest=max(map(longest_buffer, known.values()), default=0),
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
        """None of its own: it only uses the crate's names."""
        return iter(())
