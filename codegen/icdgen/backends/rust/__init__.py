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
        from icdgen.backends.rust import messages, nodes  # the rules about names need none of them

        description = describe(icd)
        common = {
            "origin": origin(),
            "version": __version__,
            "crate": self.crate,
            "id_bits": description.id_bits,
            **_functions(),
        }
        wired = any(node.is_linked for node in description.nodes)
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **common)
        yield PurePosixPath("src/lib.rs"), render(
            "lib.rs.j2", nodes=icd.nodes, summary=nodes.summary, wired=wired, **common
        )
        yield from _runtime("src/support", render)
        for node in description.nodes:
            folder = PurePosixPath("src") / node.name
            digested = {**common, "origin": origin(node.model, with_digest=True)}
            about = nodes.about(node)
            yield folder / "mod.rs", render(
                "node.rs.j2", node=node, about=about, typed=nodes.typed, guarded=nodes.guarded, **digested
            )
            shared = {**common, "origin": origin(node.model), "wired": wired}
            if node.enums:
                yield folder / "enums.rs", render("enums.rs.j2", enums=node.enums, **shared)
            for message in node.messages:
                text = render("message.rs.j2", m=message, **messages.values(message), **shared)
                yield folder / f"{message.name}.rs", text
        if wired:
            yield from _wire(description, render, common)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the crate declares, by scope."""
        return declared_names(describe(icd))


def _functions() -> dict[str, object]:
    """What templates spell names and text with."""
    from icdgen.backends.rust import text
    from icdgen.backends.rust.accessors import accessors, field_row, scale_of
    from icdgen.backends.rust.physical import big_parts
    from icdgen.describe.comments import sentence, text_comment, words

    found = (
        accessors, big_parts, field_row, names.catch_all, names.field_name, names.message_path, names.raw_type,
        names.type_name, scale_of, sentence, text.arm, text.assigned, text.described, text.doc, text.integer,
        text.prose, text.signature, text.string, text_comment, words,
    )  # fmt: skip
    return {function.__name__: function for function in found}


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
