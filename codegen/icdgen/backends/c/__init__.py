"""C99 headers: one a message, one a node, one of the enumerations of a node, and one for support."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends import Identifier
from icdgen.backends.c import accessors, constants, decoding, encoding, members, names
from icdgen.backends.c.declared_names import declared_names
from icdgen.backends.c.dispatch import dispatchers
from icdgen.backends.c.reserved_words import RESERVED
from icdgen.backends.c.runtime import header
from icdgen.backends.c.statement import head
from icdgen.backends.c.text import comment, described, literal, noted, prose
from icdgen.backends.lines import STEP
from icdgen.backends.origin import origin
from icdgen.describe import Description, EnumDescription, MessageDescription, NodeDescription, describe
from icdgen.describe.comments import sentence, words
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.describe.links import LinkDescription
    from icdgen.render import Renderer

_MAX_ENUMERATOR = 32767
"""What every `int` can hold."""


class CBackend:
    """``--lang c``"""

    name = "c"
    reserved = RESERVED

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Every header, the support header first, then node by node."""
        first = f"/* {origin()} */\n"
        yield PurePosixPath("icdgen.h"), first + header("icdgen.h", {}, render)
        description = describe(icd)
        links = _links(description)
        if links:
            step_bytes = max(1, *(link.longest_step for link in links.values()))
            made = {"wire/sizes.h": render("sizes.h.j2", step_bytes=step_bytes)}
            yield PurePosixPath("icdgen_wire.h"), first + header("icdgen_wire.h", made, render)
        for node in description.nodes:
            folder = PurePosixPath(node.name)
            if node.enums:
                yield folder / "enums.h", render("enums.h.j2", **_enums(node))
            for message in node.messages:
                yield folder / f"{message.name}.h", render("message.h.j2", **_message(message))
            if node.name in links:
                yield folder / "link.h", render("link.h.j2", **_link(node, links[node.name]))
            yield PurePosixPath(f"{node.name}.h"), render("node.h.j2", **_node(node, description.id_bits))

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the headers declare."""
        return declared_names(describe(icd))


def _guard(*parts: str) -> str:
    return "_".join((*parts, "h")).upper()


def _message(message: MessageDescription) -> dict[str, object]:
    folders = sorted({field.enum.node.name for field in message.fields if field.enum is not None})
    enums = ("enums.h" if folder == message.node.name else f"../{folder}/enums.h" for folder in folders)
    name, about = names.stem(message), message.comment
    buffer = "uint8_t *ICDGEN_RESTRICT buffer"
    return {
        "origin": origin(message.node),
        "guard": _guard(name),
        "about": comment(["@file", about.head, *about.rest, *noted(about)]),
        "includes": ["../icdgen.h", *enums],
        "name": name,
        "upper": name.upper(),
        "length": message.model.length,
        "ids": constants.ids(message),
        "constants": constants.constants(message),
        "members": members.declarations(message),
        "initial": constants.initial(message),
        "decode": decoding.statements(message),
        "misfits": members.misfits(message),
        "excess_type": members.excess_type(message),
        "encode": encoding.statements(message),
        "whole_accessors": accessors.whole_accessors(message),
        "accessors": accessors.accessors(message),
        "init_head": head("void ", f"{name}_init", f"{name}_t *message"),
        "misfit_head": head("const char *", f"{name}_misfit", f"const {name}_t *message"),
        "decode_head": head(
            "icd_status_t ",
            f"{name}_decode",
            f"{name}_t *ICDGEN_RESTRICT message",
            f"const {buffer}",
            "size_t length",
        ),
        "encode_head": head(
            "icd_status_t ", f"{name}_encode", f"const {name}_t *ICDGEN_RESTRICT message", buffer, "size_t capacity"
        ),
    }


def _links(description: Description) -> dict[str, LinkDescription]:
    from icdgen.describe.links import links_of  # the rules about names need none of it

    return links_of(description)


def _link(node: NodeDescription, link: LinkDescription) -> dict[str, object]:
    from icdgen.backends.c import links

    title = words(node.model.title)
    return {
        "origin": origin(node.model),
        "node": node.name,
        "guard": _guard(node.name, "link"),
        "about": comment(["@file", f"{title}: how its messages travel."]),
        "title": prose(title),
        "constants": links.sizes(link),
        "aliases": links.aliases(node.messages),
        "tables": links.tables(link),
    }


def _enums(node: NodeDescription) -> dict[str, object]:
    return {
        "origin": origin(node.model),
        "guard": _guard(node.name, "enums"),
        "title": prose(words(node.model.title)),
        "enums": [_enum(enum) for enum in node.enums],
    }


def _enum(enum: EnumDescription) -> dict[str, object]:
    bits = enum.storage.bits
    macros = any(one.model.value > _MAX_ENUMERATOR for one in enum.members)
    literals = "UINT64_C({})" if bits == 64 else "{}u" if macros else "{}"
    return {
        "name": names.stem(enum),
        "bits": bits,
        "macros": macros,
        "comment": described(enum.comment),
        "members": [
            {
                "name": names.enumerator(enum, one),
                "value": literals.format(one.model.value),
                "comment": described(one.comment, "" if macros else STEP),
                "text": literal(one.model.name),
            }
            for one in enum.members
        ],
    }


def _node(node: NodeDescription, id_bits: int) -> dict[str, object]:
    headers = [f"{name}.h" for name in node.model.includes]
    headers += [f"{node.name}/enums.h"] if node.enums else []
    headers += [f"{node.name}/{message.name}.h" for message in node.messages]
    headers += [f"{node.name}/link.h"] if node.is_linked else []
    return {
        "origin": origin(node.model),
        "guard": _guard(node.name),
        "about": comment(["@file", f"{words(node.model.title)}: all messages.", sentence(node.model.summary)]),
        "includes": ["icdgen.h", *headers],
        "title": prose(words(node.model.title)),
        "upper": node.name.upper(),
        "digest": node.model.digest[:16],
        "constants": constants.of_node(node.model),
        "dispatchers": dispatchers(node, id_bits),
    }
