"""C backend: C99 headers of messages, nodes and enumerations, the support header, the
wire layer, and links.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
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
from icdgen.backends.c.decoding import THRESHOLDS, Groups, Structs
from icdgen.backends.c.runtime import assembled
from icdgen.backends.c.short_names import with_short_names
from icdgen.backends.c.statement import call, head, like
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.text import FILE, comment, described, literal, noted, prose
from icdgen.backends.origin import origin
from icdgen.backends.packages import Packages
from icdgen.describe import MessageDescription, NodeDescription, describe
from icdgen.describe.arrays import StructArray, all_struct_arrays, struct_arrays_in
from icdgen.describe.comments import sentence, words
from icdgen.describe.description import Composite, VariablePartDescription
from icdgen.describe.groups import groups
from icdgen.describe.numbers import byte_count, length_text
from icdgen.describe.symbols import symbols
from icdgen.icd.model import Icd
from icdgen.icd.prefixed import with_prefix

if TYPE_CHECKING:
    from icdgen.describe.links import LinkDescription
    from icdgen.render import Renderer

_SPELLING = (
    byte_count, call, comment, described, head, length_text, like, literal, prose, names.client_function, names.constant,
    names.enumerator, names.enumerator_of, names.getter, names.selector, names.setter, C_NAMES.symbol, sentence,
    words,
)  # fmt: skip
_FUNCTIONS = {function.__name__: function for function in _SPELLING}
"""Functions with which templates spell names and text."""


class CBackend:
    """Backend of ``icdgen --lang c``."""

    name = "c"
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
        from icdgen.describe.links import (
            links_of,
        )  # imported late: rules on names do not need it

        first = f"/* {origin()} */\n"
        yield PurePosixPath("icdgen.h"), first + assembled("icdgen.h", render)
        description = describe(icd)
        if any(
            composite.has_wide_steps
            for node in description.nodes
            for composite in node.composites
        ):
            yield PurePosixPath("icdgen_wide.h"), first + assembled(
                "icdgen_wide.h", render
            )
        links = links_of(description)
        if links:
            step_bytes = max(1, *(link.longest_step for link in links.values()))
            sizes = {"wire/sizes.h": render("sizes.h.j2", step_bytes=step_bytes)}
            yield PurePosixPath("icdgen_wire.h"), first + assembled(
                "icdgen_wire.h", render, sizes
            )
            yield PurePosixPath("icdgen_wire.c"), first + assembled(
                "icdgen_wire.c", render
            )
        for node in description.nodes:
            folder = PurePosixPath(node.name)
            shared = {
                "origin": origin(node.model),
                "title": prose(words(node.model.title)),
                **_FUNCTIONS,
            }
            if node.enums:
                enums = [(enum, *constants.of_enum(enum)) for enum in node.enums]
                values = {"node": node, "enums": enums, "within": constants.within}
                yield folder / "enums.h", render("enums.h.j2", **values, **shared)
            for struct in node.structs:
                yield folder / f"{struct.name}.h", render(
                    "struct.h.j2", m=struct, **_composite(struct), **shared
                )
            for message in node.messages:
                yield folder / f"{message.name}.h", render(
                    "message.h.j2", m=message, **_message(message), **shared
                )
            if node.name in links:
                link = {**_link(node, links[node.name]), **shared}
                yield folder / "link.h", render("link.h.j2", **link)
                yield folder / "link.c", render("link.c.j2", **link)
                template = "client.h.j2" if node.has_client else "stream_client.h.j2"
                yield folder / "client.h", render(
                    template, **_client(node, links[node.name]), **shared
                )
            of_node = {**_node(node), "id_type": f"uint{description.id_bits}_t"}
            yield PurePosixPath(f"{node.name}.h"), render(
                "node.h.j2", node=node, **of_node, **shared
            )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """List every name that the headers declare."""
        return iter(symbols(describe(icd), C_NAMES))


def _composite(
    composite: Composite[Any], more_headers: Iterable[str] = ()
) -> dict[str, object]:
    """Return the values for a struct, and for a message, which includes
    ``more_headers``.
    """
    folders = sorted({enum.node.name for enum in composite.enums})
    used = [(folder, "enums") for folder in folders] + [
        (struct.node.name, struct.name) for struct in composite.structs
    ]
    headers = (
        f"{name}.h" if folder == composite.node.name else f"../{folder}/{name}.h"
        for folder, name in used
    )
    about = composite.comment
    return {
        "about": comment([FILE, about.head, *about.details, *noted(about)]),
        "includes": [
            "../icdgen_wide.h" if composite.has_wide_steps else "../icdgen.h",
            *dict.fromkeys((*headers, *more_headers)),
        ],
        "constants": constants.of_fields(composite),
        "initial": members.initial(composite),
        "declaration": types.declaration,
        "text_accessors": accessors.of_kind(composite, "text"),
        "integer_accessors": accessors.integer_accessors(composite),
        "double_accessors": accessors.double_accessors(composite),
        "known": constants.table(composite),
    }


def _message(message: MessageDescription) -> dict[str, object]:
    fields = [
        *groups(message, THRESHOLDS),
        *_arrays(
            message,
            (
                array
                for array in struct_arrays_in(message)
                if not array.field.is_in_last_part
            ),
        ),
    ]
    return {
        **_composite(message, parts.headers(message)),
        "empty": decoding.EMPTY,
        "decode": decoding.statements(message, fields),
        "repeated": [_repeated(message, array) for array in all_struct_arrays(message)],
        "element": None,
        "spread": [],
        "counter_tests": [],
        "misfits": members.misfits(message, is_last_part=False),
        "misfits_of_end": members.misfits(message, is_last_part=True),
        "excess": members.excess(message),
        "excess_type": bits.excess_type(message),
        "encode": encoding.statements(message, fields),
        "conditional": conditional.conditional(message),
        **(
            _of_variable_length(message, message.last_part) if message.last_part else {}
        ),
        "overlays": [accessors.overlay(field) for field in message.overlays],
        "parts": parts.parts(message),
    }


def _arrays(message: MessageDescription, arrays: Iterable[StructArray]) -> Groups:
    return [
        Structs(
            array,
            names.reading(message, array.name),
            names.writing(message, array.name),
        )
        for array in arrays
    ]


def _repeated(message: MessageDescription, array: StructArray) -> dict[str, object]:
    """Return the functions that read and write an element of an array of structs."""
    fields = [
        *groups(array.element_struct, THRESHOLDS),
        *_arrays(message, struct_arrays_in(array.element_struct, f"{array.name}_")),
    ]
    return {
        "field": array.field,
        "type": C_NAMES.symbol(array.element_struct, "t"),
        "reading": names.reading(message, array.name),
        "writing": names.writing(message, array.name),
        "read": decoding.statements(array.element_struct, fields),
        "write": encoding.statements(array.element_struct, fields),
    }


def _of_variable_length(
    message: MessageDescription, last: VariablePartDescription
) -> dict[str, object]:
    """Return the values for messages whose frames differ in length."""
    of_element = None
    if last.element_struct is not None:
        reading, writing = names.reading(message, last.field.name), names.writing(
            message, last.field.name
        )
        of_element = {
            "type": C_NAMES.symbol(last.element_struct, "t"),
            "reading": reading,
            "walking": (
                names.walking(message, last.field.name)
                if not message.spread_parts
                else ""
            ),
            "there": decoding.there(last),
            "place": decoding.place(last.place),
            "decode": decoding.of_elements(last, reading),
            "encode": [
                decoding.for_each(
                    last.field.member, decoding.elements(last), writing, last.place
                )
            ],
        }
    return {
        "element": of_element,
        "miscount": decoding.miscount(last),
        "spread": decoding.of_spread_parts(message),
        "counter_tests": decoding.counter_tests(message),
        "size": encoding.size(message),
        "misfit_length": decoding.misfit_length(message),
        "miscounted": None if last.inner else decoding.miscounted(last),
        "elements": decoding.elements(last),
        "counted_text": encoding.counted_text(last),
    }


def _link(node: NodeDescription, link: LinkDescription) -> dict[str, object]:
    from icdgen.backends.c import links

    return {
        "node": node.name,
        "of_node": node,
        "about": comment(
            [
                FILE,
                f"{words(node.model.title)}: description of its protocol and sizes of buffers.",
            ]
        ),
        "sizes": links.sizes(link),
        "tables": links.tables(link),
    }


def _client(node: NodeDescription, link: LinkDescription) -> dict[str, object]:
    headers = sorted(
        {
            *(f"../{name}.h" for name in node.model.includes),
            *(f"{message.name}.h" for message in node.messages),
        }
    )
    common = {
        "node": node.name,
        "of_node": node,
        "about": comment(
            [FILE, f"{words(node.model.title)}: client with one function per message."]
        ),
        "includes": ["link.h", *headers],
        "telecommands": [
            (message, message.telecommand_id_name) for message in node.telecommands
        ],
    }
    form = link.facts.stream
    if form is None:
        facts = {
            "uart": link.facts.framing,
            "i2c": link.facts.i2c_address,
            "can": link.can,
        }
        buses = [bus for bus, fact in facts.items() if fact is not None]
        telemetry_ids = [
            (message, message.telemetry_id_name) for message in node.telemetry
        ]
        return {**common, "buses": buses, "telemetry": telemetry_ids}
    replies = {row.reply for row in form.telecommands if row.least == 0}
    telemetry = [
        (under.id in replies, candidate, under.tested[: place + 1])
        for under in node.ids("telemetry")
        for place, candidate in enumerate(under.messages)
    ]
    return {**common, "sequences": form.sequences, "telemetry": telemetry}


def _node(node: NodeDescription) -> dict[str, object]:
    headers = [f"{name}.h" for name in node.model.includes]
    headers += [f"{node.name}/enums.h"] if node.enums else []
    headers += [f"{node.name}/{composite.name}.h" for composite in node.composites]
    headers += (
        [f"{node.name}/link.h", f"{node.name}/client.h"] if node.is_linked else []
    )
    return {
        "about": comment(
            [
                FILE,
                f"{words(node.model.title)}: all messages.",
                sentence(node.model.summary),
            ]
        ),
        "includes": ["icdgen.h", *headers],
    }
