"""Rust backend: a `no_std` crate for all nodes, with a module per node and a file per
message.

`RustBackend.files` renders the templates of ``templates/rust`` and copies the folder
``support`` of ``runtime/rust`` and, if a node has a link, its folder ``wire``. Templates
get the descriptions of `icdgen.describe`, and the functions in `_template_functions`
that spell these in Rust. To follow a field into the code, read `messages`, then `bits`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.backends.packages import Packages
from icdgen.backends.rust import names
from icdgen.backends.rust.symbols import RUST_NAMES
from icdgen.backends.template_functions import functions_by_name
from icdgen.describe import describe
from icdgen.describe.symbols import symbols
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.describe.links import LinkDescription
    from icdgen.render import Renderer

CRATE = Packages.rust
RUNTIME = "icdgen_runtime"
LINKS = "src/wire/links"


class RustBackend:
    """Backend of ``icdgen --lang rust``."""

    name = "rust"
    title = "Rust"
    reserved = names.RESERVED

    def __init__(self, crate: str = Packages.rust) -> None:
        self.packages = Packages(rust=crate)

    @property
    def crate(self) -> str:
        """Name of the crate."""
        return self.packages.rust

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield the files of the crate."""
        from icdgen.backends.rust.procedures import NodeProcedures
        from icdgen.describe.links import links_of

        description = describe(icd)
        crate_values = {
            "origin": origin(),
            "version": __version__,
            "crate": self.crate,
            "id_bits": description.id_bits,
            **_template_functions(),
        }
        has_variable_length = any(
            message.layout.sequence for node in icd.nodes for message in node.messages
        )
        links = links_of(description)
        # Nodes come after the nodes that they include, so the procedures of these are
        # in the table when a node asks for their code.
        procedures_by_node: dict[str, NodeProcedures] = {}
        yield PurePosixPath("Cargo.toml"), render("Cargo.toml.j2", **crate_values)
        yield (
            PurePosixPath("src/lib.rs"),
            render(
                "lib.rs.j2",
                has_variable_length=has_variable_length,
                nodes=icd.nodes,
                wired=bool(links),
                **crate_values,
            ),
        )
        yield from _runtime("src/support", render, self.crate)
        for node in description.nodes:
            folder = PurePosixPath("src") / node.name
            module_values = {
                **crate_values,
                "origin": origin(node.model, with_digest=True),
            }
            link = links.get(node.name)
            file_values = {**crate_values, "origin": origin(node.model)}
            if link and link.facts.procedures:
                procedures = NodeProcedures(
                    link, description, procedures_by_node, self.crate
                )
                procedures_by_node[node.name] = procedures
                yield (
                    folder / "procedures.rs",
                    render("procedures.rs.j2", procedures=procedures, **file_values),
                )
            yield (
                folder / "mod.rs",
                render("node.rs.j2", node=node, link=link, **module_values),
            )
            if node.enums:
                yield (
                    folder / "enums.rs",
                    render("enums.rs.j2", enums=node.enums, **file_values),
                )
            for struct in node.structs:
                text = render("struct.rs.j2", m=struct, **file_values)
                yield folder / f"{struct.name}.rs", text
            for message in node.messages:
                text = render("message.rs.j2", m=message, **file_values)
                yield folder / f"{message.name}.rs", text
        if links:
            yield from _wire(links, render, crate_values)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """List every name that the crate declares, by scope."""
        return iter(symbols(describe(icd), RUST_NAMES))


def _template_functions() -> dict[str, object]:
    """Return the functions that templates call, by name."""
    from icdgen.backends.rust import (
        accessors,
        conditional,
        elements,
        examples,
        messages,
        nodes,
        parts,
        physical,
        text,
        types,
    )
    from icdgen.describe.comments import presence_comment, sentence, words
    from icdgen.describe.examples import example_of_message
    from icdgen.describe.numbers import byte_count, count_text

    functions = (
        accessors.accessors, accessors.curve_of, accessors.field_row, accessors.scale_of, accessors.texts, byte_count,
        conditional.presence_test, conditional.read_optional, conditional.write_optional, count_text,
        elements.array_functions, example_of_message, examples.byte_array, examples.client_message, examples.is_short,
        examples.read_example, examples.write_example, messages.bytes_of, messages.counted_text,
        messages.counter_value, messages.default, messages.derives, messages.element_bytes, messages.typed_constant,
        messages.fits, messages.flag_bytes, messages.imports, messages.literal, messages.overlay_value,
        messages.part_bytes, messages.part_count, messages.times, messages.used_names, messages.write_statements,
        names.constant_name, names.field_name, names.has, names.scale_name, names.setter, nodes.about, nodes.guarded,
        nodes.summary, nodes.typed, parts.parts_of, physical.big_parts, physical.derived_statements,
        physical.has_constant, presence_comment, RUST_NAMES.symbol, sentence, text.arm, text.assigned, text.code,
        text.described, text.doc, text.integer, text.mask, text.prose, text.signature, text.string,
        types.enum_path, types.message_path, types.open_type, types.raw_type, types.reason_number, words,
    )  # fmt: skip
    return functions_by_name(functions)


def _wire(
    linked: dict[str, LinkDescription],
    render: Renderer,
    crate_values: dict[str, object],
) -> Iterator[tuple[PurePosixPath, str]]:
    """Yield the files of the wire layer and of the links."""
    from icdgen.backends.rust import links, procedures

    yield from _runtime("src/wire", render, str(crate_values["crate"]))
    folder = PurePosixPath(LINKS)
    yield (
        folder / "mod.rs",
        render(
            "links.rs.j2",
            nodes=list(linked),
            sizes=procedures.buffer_sizes(linked.values()),
            **crate_values,
        ),
    )
    for name, link in linked.items():
        yield (
            folder / f"{name}.rs",
            render(
                "node_link.rs.j2",
                link=links.values(link),
                origin=origin(link.facts.node),
            ),
        )


def _runtime(
    folder: str, render: Renderer, crate: str
) -> Iterator[tuple[PurePosixPath, str]]:
    """Yield the files that are the same for every ICD.

    The runtime is developed as a crate of its own, with links of a sample ICD that are
    left out here. Examples in its documentation get the name of the generated crate.
    """
    for name in render.runtime_files(folder):
        if not name.startswith(f"{LINKS}/"):
            text = render.source(name).replace(f"{RUNTIME}::", f"{crate}::")
            yield PurePosixPath(name), f"// {origin()}\n\n{text}"
