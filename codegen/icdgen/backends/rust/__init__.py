"""Rust: one `no_std` crate for all nodes, one module a node, one file a message."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.backends.rust import names
from icdgen.backends.rust.declared_names import declared_names
from icdgen.describe import Description, describe
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.render import Renderer

CRATE = "icd"
LINKS = "src/wire/links"


class RustBackend:
    """``icdgen --lang rust``"""

    name = "rust"
    reserved = names.RESERVED

    def __init__(self, crate: str = CRATE) -> None:
        self.crate = crate

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """The crate."""
        from icdgen.backends.rust import nodes  # the rules about names need none of them
        from icdgen.backends.rust.enumerations import EnumRow
        from icdgen.backends.rust.messages import MessageRow

        common: dict[str, object] = {"origin": origin(), "version": __version__, "crate": self.crate}
        description = describe(icd)
        id_bits = description.id_bits
        wired = any(node.is_linked for node in description.nodes)
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        yield PurePosixPath("src/lib.rs"), render(
            "lib.rs.j2", nodes=[nodes.Summary(node) for node in icd.nodes], wired=wired, **common
        )
        yield from _runtime("src/support", render)
        for node in description.nodes:
            folder = PurePosixPath("src") / node.name
            shared = {**common, "origin": origin(node.model)}
            rows = [MessageRow(message, f"u{id_bits}") for message in node.messages]
            row = nodes.NodeRow(node, rows, id_bits)
            yield folder / "mod.rs", render(
                "node.rs.j2",
                node=row,
                wired=node.is_linked,
                **common | {"origin": origin(node.model, with_digest=True)},
            )
            if node.enums:
                enums = [EnumRow(enum) for enum in node.enums]
                yield folder / "enums.rs", render("enums.rs.j2", enums=enums, **shared)
            for message, values in zip(node.messages, rows, strict=True):
                text = render("message.rs.j2", m=values, node=node.name, wired=wired, **shared)
                yield folder / f"{message.name}.rs", text
        if wired:
            yield from _wire(description, render, common)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the crate declares, by scope."""
        return declared_names(describe(icd))


def _wire(description: Description, render: Renderer, common: dict[str, object]) -> Iterator[tuple[PurePosixPath, str]]:
    """How the messages travel."""
    from icdgen.backends.rust import links
    from icdgen.describe.links import links_of

    yield from _runtime("src/wire", render)
    folder, found = PurePosixPath(LINKS), links_of(description)
    yield folder / "mod.rs", render("links.rs.j2", nodes=list(found), sizes=links.sizes(found.values()), **common)
    for name, link in found.items():
        yield folder / f"{name}.rs", render("node_link.rs.j2", link=links.values(link), origin=origin(link.facts.node))


def _runtime(folder: str, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
    """What is the same for every ICD; its links are a sample, there for the runtime to be a crate of its own."""
    for name in render.runtime_files(folder):
        if not name.startswith(LINKS):
            yield PurePosixPath(name), f"// {origin()}\n\n{render.source(name)}"
