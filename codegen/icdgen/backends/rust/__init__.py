"""Rust: one `no_std` crate for all nodes, one module a node, one file a message."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.backends.rust import declared, names, nodes
from icdgen.backends.rust.enumerations import EnumRow
from icdgen.backends.rust.messages import MessageRow
from icdgen.icd.model import Icd, Node

CRATE = "icd"
LINKS = "src/wire/links"


class RustBackend:
    """``icdgen --lang rust``"""

    name = "rust"
    reserved = names.RESERVED

    def __init__(self, crate: str = CRATE) -> None:
        self.crate = crate

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """The crate."""
        common = {"origin": origin(), "version": __version__, "crate": self.crate}
        enums = names.Enums(icd)
        wired = {node.name for node in icd.nodes if icd.protocol_of(node)}
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        yield PurePosixPath("src/lib.rs"), render(
            "lib.rs.j2", nodes=[nodes.Summary(node) for node in icd.nodes], wired=bool(wired), **common
        )
        yield from _runtime("src/support", render)
        rows = {node.name: message_rows(icd, node, enums) for node in icd.nodes}
        for node in icd.nodes:
            folder = PurePosixPath("src") / node.name
            first = {"origin": origin(node, with_digest=True)}
            yield folder / "mod.rs", render(
                "node.rs.j2", node=nodes.NodeRow(icd, node, rows), wired=node.name in wired, **common | first
            )
            first = {"origin": origin(node)}
            if node.enums:
                members = [EnumRow(enum, node, enums) for enum in node.enums]
                yield folder / "enums.rs", render("enums.rs.j2", enums=members, **common | first)
            for row in rows[node.name]:
                yield folder / f"{row.module}.rs", render(
                    "message.rs.j2", m=row, node=node.name, wired=bool(wired), **common | first
                )
        if wired:
            yield from _wire(icd, render, common)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the crate declares, by scope."""
        return declared.identifiers(icd)


def _wire(icd: Icd, render, common: dict[str, object]) -> Iterator[tuple[PurePosixPath, str]]:
    """How the messages travel."""
    from icdgen.backends.rust import wire

    yield from _runtime("src/wire", render)
    folder = PurePosixPath(LINKS)
    layer = wire.Wire(icd)
    yield folder / "mod.rs", render("links.rs.j2", links=layer.links, sizes=layer.sizes, **common)
    for link in layer.links:
        yield folder / f"{link.node}.rs", render("node_link.rs.j2", link=link, origin=origin(icd.node(link.node)))


def _runtime(folder: str, render) -> Iterator[tuple[PurePosixPath, str]]:
    """What is the same for every ICD; its links are a sample, there for the runtime to be a crate of its own."""
    for name in render.runtime_files(folder):
        if not name.startswith(LINKS):
            yield PurePosixPath(name), f"// {origin()}\n\n{render.source(name)}"


def message_rows(icd: Icd, node: Node, enums: names.Enums) -> list[MessageRow]:
    """The node's own messages."""
    kind = nodes.id_type(icd)
    return [MessageRow(message, node, enums, kind) for message in node.messages]
