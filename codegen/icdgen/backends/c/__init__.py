"""C backend: C99 headers of messages, nodes and enumerations, the support header, the
wire layer, and links.

`CBackend.files` renders the templates of ``templates/c``. They get the descriptions of
`icdgen.describe`, and the functions in `_FUNCTIONS` that spell these in C. To follow a
field into the code, read `decoding` and `encoding`, then `bits`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from icdgen.backends import Identifier
from icdgen.backends.c import (
    accessors,
    bits,
    conditional,
    constants,
    decoding,
    encoding,
    members,
    names,
    parts,
    types,
)
from icdgen.backends.c.runtime import assemble_file
from icdgen.backends.c.short_names import with_short_names
from icdgen.backends.c.statement import call, frame_test, head
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.text import FILE, comment, described, literal, noted, prose
from icdgen.backends.origin import origin
from icdgen.backends.packages import Packages
from icdgen.backends.template_functions import functions_by_name
from icdgen.describe import MessageDescription, NodeDescription, describe
from icdgen.describe.arrays import all_struct_arrays
from icdgen.describe.comments import presence_comment, sentence, words
from icdgen.describe.contained import contained_messages
from icdgen.describe.description import Composite
from icdgen.describe.numbers import byte_count, length_text
from icdgen.describe.symbols import symbols
from icdgen.icd.model import Icd
from icdgen.icd.prefixed import with_prefix

if TYPE_CHECKING:
    from icdgen.describe.links import LinkDescription
    from icdgen.render import Renderer


class CBackend:
    """Backend of ``icdgen --lang c``."""

    name = "c"
    # C++ can include the headers, so its reserved words cannot be names in C either.
    title = "C/C++"
    reserved = names.RESERVED

    def __init__(self) -> None:
        self.packages = Packages()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """List all files: the support header, the wire layer, then the files of each
        node.
        """
        prefixed = with_prefix(icd, self.packages.c_prefix)
        yield from with_short_names(
            self._files(prefixed, render), self.identifiers(prefixed)
        )

    def _files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        # Imported late: rules on names do not need it.
        from icdgen.describe.links import links_of

        first = f"/* {origin()} */\n"
        yield PurePosixPath("icdgen.h"), first + assemble_file("icdgen.h", render)
        description = describe(icd)
        if any(
            composite.has_wide_steps
            for node in description.nodes
            for composite in node.composites
        ):
            yield (
                PurePosixPath("icdgen_wide.h"),
                first + assemble_file("icdgen_wide.h", render),
            )
        links = links_of(description)
        if links:
            from icdgen.backends.c.kinds import kinds_of, length_type
            from icdgen.backends.c.procedures import procedure_sizes

            longest = procedure_sizes(links.values())
            kinds = {
                "kinds": kinds_of(links.values()),
                "length_type": length_type(links.values()),
            }
            of_icd = {
                "wire/kinds.h": render("kinds.h.j2", **kinds),
                "wire/sizes.h": render("sizes.h.j2", sizes=longest),
            }
            yield (
                PurePosixPath("icdgen_wire.h"),
                first + assemble_file("icdgen_wire.h", render, of_icd),
            )
            yield (
                PurePosixPath("icdgen_wire.c"),
                first + assemble_file("icdgen_wire.c", render),
            )
        for node in description.nodes:
            folder = PurePosixPath(node.name)
            shared = {
                "origin": origin(node.model),
                "title": prose(words(node.model.title)),
                "FILE": FILE,
                **_FUNCTIONS,
            }
            if node.enums:
                enums = [
                    (enum, *constants.enumerator_literals(enum)) for enum in node.enums
                ]
                values = {
                    "node": node,
                    "enums": enums,
                    "range_test": constants.range_test,
                }
                yield folder / "enums.h", render("enums.h.j2", **values, **shared)
            for struct in node.structs:
                header = render("struct.h.j2", m=struct, **shared)
                yield folder / f"{struct.name}.h", header
            for message in node.messages:
                header = render("message.h.j2", m=message, **shared)
                yield folder / f"{message.name}.h", header
            if node.name in links:
                yield from _link(node, links[node.name], render, shared)
            id_type = f"uint{description.id_bits}_t"
            yield (
                PurePosixPath(f"{node.name}.h"),
                render("node.h.j2", node=node, id_type=id_type, **shared),
            )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """List every name that the headers declare."""
        return iter(symbols(describe(icd), C_NAMES))


def file_comment(composite: Composite[Any]) -> str:
    """Return the comment at the start of the header of a message or struct."""
    about = composite.comment
    return comment([FILE, about.head, *about.details, *noted(about)])


def includes(composite: Composite[Any]) -> list[str]:
    """Return the headers that the header of a message or struct includes."""
    folders = sorted({enum.node.name for enum in composite.enums})
    used = [(folder, "enums") for folder in folders]
    used += [(struct.node.name, struct.name) for struct in composite.structs]
    if isinstance(composite, MessageDescription):
        parts = (part.message for part in contained_messages(composite))
        used += [(message.node.name, message.name) for message in parts]
    headers = (
        f"{name}.h" if folder == composite.node.name else f"../{folder}/{name}.h"
        for folder, name in used
    )
    # `icdgen_wide.h` includes `icdgen.h`, so one of them is enough.
    support = "../icdgen_wide.h" if composite.has_wide_steps else "../icdgen.h"
    return [support, *dict.fromkeys(headers)]


def _link(
    node: NodeDescription,
    link: LinkDescription,
    render: Renderer,
    shared: Mapping[str, object],
) -> Iterator[tuple[PurePosixPath, str]]:
    """List the files of the link of a node: its facts, its client and its procedures."""
    from icdgen.backends.c import links
    from icdgen.backends.c.names import checksum_function
    from icdgen.backends.c.procedures import ProcedureCode
    from icdgen.backends.c.tables import algorithm_table_name
    from icdgen.describe.links import Assumptions

    folder, assumptions = PurePosixPath(node.name), Assumptions(link.facts)
    procedures = [
        ProcedureCode(node, link, each, assumptions) for each in link.facts.procedures
    ]
    values = {
        "node": node,
        "link": link,
        "sizes": links.buffer_sizes(link),
        "procedures": procedures,
        "checksums": [
            (
                each.name,
                checksum_function(node, each.name),
                algorithm_table_name(each.name),
            )
            for each in link.facts.checksums.values()
        ],
        **shared,
    }
    code = links.link_code(link, assumptions)
    yield folder / "link.h", render("link.h.j2", **values)
    yield folder / "link.c", render("link.c.j2", code=code, **values)
    if procedures:
        yield folder / "procedures.h", render("procedures.h.j2", **values)
    yield folder / "client.h", render("client.h.j2", **values)


def client_headers(node: NodeDescription) -> list[str]:
    """Return the headers that the client of a node includes."""
    included = (f"../{name}.h" for name in node.model.includes)
    own = (f"{message.name}.h" for message in node.messages)
    return ["link.h", *sorted({*included, *own})]


def procedure_headers(node: NodeDescription) -> list[str]:
    """Return the headers that the procedures of a node include."""
    included = (f"../{name}.h" for name in node.model.includes)
    return ["link.h", *included, *(["enums.h"] if node.enums else [])]


_FUNCTIONS = functions_by_name(
    (
        accessors.double_accessors, accessors.integer_accessors, accessors.of_kind, accessors.overlay_comment,
        all_struct_arrays, bits.excess_type, byte_count, call, client_headers, comment, conditional.absent_value,
        conditional.presence_test, conditional.write_optional, constants.constant_value, constants.field_table,
        contained_messages, decoding.chunk_bytes, decoding.counter_tests, decoding.decode_statements,
        decoding.element_bytes, decoding.element_count, decoding.groups_of, decoding.invalid_count, decoding.test_of_count,
        decoding.misfit_length, decoding.read_number, decoding.part_bytes, decoding.first_byte, decoding.read_statements,
        decoding.elements_received, described,
        encoding.counted_text, encoding.encode_statements, encoding.size_terms, encoding.write_statements, file_comment,
        head, includes, length_text, frame_test, literal, members.excess, members.initial_statements, members.misfits,
        names.client_function, names.constant, names.enumerator, names.enumerator_of, names.getter, names.has,
        names.part_name, names.element_reader, procedure_headers, names.selector, names.setter, names.received_element_reader,
        names.element_writer, parts.part_about, parts.part_statements, presence_comment, prose, sentence, C_NAMES.symbol,
        types.declaration, types.type_of,
        words,
    )
)  # fmt: skip
"""Functions that templates call, by name."""
