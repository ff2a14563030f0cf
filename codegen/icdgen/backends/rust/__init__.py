"""Rust: one `no_std` crate for all nodes, one module a node, one file a message."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.rust import declared, names, nodes
from icdgen.backends.rust.enumerations import EnumRow
from icdgen.backends.rust.messages import MessageRow
from icdgen.icd.model import Icd, Node

CRATE = "icd"
SUPPORT = ("array", "bytes", "mod", "scale")


class RustBackend:
    """``icdgen --lang rust``"""

    name = "rust"
    reserved = names.RESERVED

    def __init__(self, crate: str = CRATE) -> None:
        self.crate = crate

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """The crate."""
        common = {"version": __version__, "crate": self.crate}
        enums = names.Enums(icd)
        wired = {node.name for node in icd.nodes if icd.protocol_of(node)}
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        yield PurePosixPath("src/lib.rs"), render(
            "lib.rs.j2", nodes=[nodes.Summary(node) for node in icd.nodes], wired=bool(wired), **common
        )
        for name in SUPPORT:
            yield PurePosixPath(f"src/support/{name}.rs"), render(f"support/{name}.rs.j2", **common)
        rows = {node.name: message_rows(icd, node, enums) for node in icd.nodes}
        for node in icd.nodes:
            folder = PurePosixPath("src") / node.name
            yield folder / "mod.rs", render(
                "node.rs.j2", node=nodes.NodeRow(icd, node, rows), wired=node.name in wired, **common
            )
            if node.enums:
                members = [EnumRow(enum, node, enums) for enum in node.enums]
                yield folder / "enums.rs", render("enums.rs.j2", node=node.name, enums=members, **common)
            for row in rows[node.name]:
                yield folder / f"{row.module}.rs", render(
                    "message.rs.j2", m=row, node=node.name, wired=bool(wired), **common
                )
        if wired:
            yield from _wire(icd, render, common)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the crate declares, by scope."""
        return declared.identifiers(icd)


def _wire(icd: Icd, render, common: dict[str, object]) -> Iterator[tuple[PurePosixPath, str]]:
    """How the messages travel."""
    from icdgen.backends.rust import wire

    folder = PurePosixPath("src/wire")
    for name in wire.modules():
        yield folder / f"{name}.rs", render(f"wire/{name}.rs.j2", **common)
    layer = wire.Wire(icd)
    yield folder / "links" / "mod.rs", render("wire/links.rs.j2", links=layer.links, sizes=layer.sizes, **common)
    for link in layer.links:
        yield folder / "links" / f"{link.node}.rs", render("wire/node_link.rs.j2", link=link, **common)


def message_rows(icd: Icd, node: Node, enums: names.Enums) -> list[MessageRow]:
    """The node's own messages."""
    kind = nodes.id_type(icd)
    return [MessageRow(message, node, enums, kind) for message in node.messages]
