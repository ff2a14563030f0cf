"""Values for the templates of the package, of nodes and of messages, in addition to the
description.

These are mostly imports, ``__all__`` and literals of dictionaries.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from icdgen.backends.lines import exploded
from icdgen.backends.python import names
from icdgen.backends.python.symbols import PYTHON_NAMES
from icdgen.backends.python.text import docstring, literal, paragraph
from icdgen.describe import (
    EnumDescription,
    NodeDescription,
    StructDescription,
)
from icdgen.describe.comments import sentence
from icdgen.describe.description import Composite
from icdgen.describe.nodes import MessagesOfId
from icdgen.icd.model import Message, Node

_OF_NODE = (
    "DIGEST", "ENUMS", "NAME", "TELECOMMANDS", "TELEMETRY", "TITLE", "decode_telecommand", "decode_telemetry",
)  # fmt: skip
_OF_PACKAGE = (
    "NODES", "FieldInfo", "IcdError", "LengthError", "Message", "OpenEnum", "RangeError", "Struct", "UnknownIdError",
    "is_special",
)  # fmt: skip


def declared(node: NodeDescription) -> list[tuple[str, str]]:
    """Return the names that can be imported from a node, and their modules, in the
    order of the modules.
    """
    declared = [
        (PYTHON_NAMES.symbol(part, "class"), names.import_path(part, node.name, ".."))
        for part in node.usable
    ]
    declared += [("LINK", "._link")] if node.is_linked else []
    return sorted(declared, key=lambda pair: pair[::-1])


def public_of_node(node: NodeDescription) -> list[str]:
    """Return the names that can be imported from a node."""
    own = [name for name, _ in declared(node)]
    own += [names.PROCEDURES] if node.procedures else []
    return sorted({*_OF_NODE, *_optional_constants(node.model), *own})


def enum_classes(node: NodeDescription) -> list[tuple[str, str]]:
    """Return the names of enumerations in the ICD, and their classes."""
    return [
        (enum.model.name, PYTHON_NAMES.symbol(enum, "class")) for enum in node.enums
    ]


def by_id(node: NodeDescription, direction: str) -> list[tuple[int, str]]:
    """Return the ids of a direction, each with a literal: the class of its message, or
    a row for each message that shares it.
    """
    return sorted(
        (under_id.id, _messages_literal(under_id)) for under_id in node.ids(direction)
    )


def _messages_literal(under: MessagesOfId) -> str:
    if not under.is_shared:
        return literal(PYTHON_NAMES.symbol(under.first.message, "class"))
    rows = []
    for candidate in under.messages:
        signs = "".join(
            f"({sign.byte}, 0x{sign.mask:02X}, 0x{sign.value:02X}), "
            for sign in candidate.constant_bytes
        )
        name = PYTHON_NAMES.symbol(candidate.message, "class")
        rows.append(
            f"({literal(name)}, {_lengths_literal(candidate.message.model)}, ({signs.rstrip(' ')})),"
        )
    return "(\n        " + "\n        ".join(rows) + "\n    )"


def _lengths_literal(message: Message) -> str:
    lengths = message.layout.lengths
    return f"range({lengths.start}, {lengths.stop}{f', {lengths.step}' if lengths.step > 1 else ''})"


def _optional_constants(node: Node) -> list[str]:
    """Return the names of the constants that only some nodes have."""
    optional = {
        "NODE_TYPE": node.node_type,
        "INTERFACE_VERSION": node.interface_version,
    }
    return [name for name, value in optional.items() if value is not None]


def public(nodes: Iterable[NodeDescription]) -> list[str]:
    """Return the names that can be imported from the package."""
    return sorted({*_OF_PACKAGE, *(node.name for node in nodes)})


def listing(names: Iterable[str]) -> str:
    """Return the literal of a list of names."""
    return exploded("[", [literal(name) for name in names], "]")


def mapping(pairs: Sequence[tuple[str, str]]) -> str:
    """Return the literal of a dictionary of names."""
    return literals((literal(key), literal(value)) for key, value in pairs)


def literals(pairs: Iterable[tuple[str | int, str]]) -> str:
    """Return a dictionary whose values are literals already."""
    return exploded("{", [f"{key}: {value}" for key, value in pairs], "}")


def node_docstring(node: Node) -> str:
    """Return the docstring of the module of a node."""
    source = dict(node.document)
    cited = [source[key] for key in ("document", "version", "date") if key in source]
    # The slice is empty if nothing is cited, so that this does not need a test.
    cited[-1:] = [
        f"{last}, section {source['section']}" if "section" in source else last
        for last in cited[-1:]
    ]
    paragraphs = [
        sentence(node.title),
        sentence(node.summary),
        sentence(f"From {', '.join(cited)}") if cited else "",
    ]
    paragraphs += (
        f"Missing: {message.kind} {message.id}, {sentence(message.name)} {sentence(message.why)}"
        for message in node.missing
    )
    return docstring(0, (paragraph(text) for text in paragraphs if text))


def imports_of(composite: Composite[Any]) -> list[str]:
    """Return the imports of enumerations and structs for a message or struct."""
    used_by: tuple[EnumDescription | StructDescription, ...] = (
        *composite.enums,
        *composite.structs,
    )
    return sorted(_import(used, composite) for used in used_by)


def _import(used: EnumDescription | StructDescription, by: Composite[Any]) -> str:
    module = names.module_name(used)
    if used.node is not by.node:
        module = f"..{used.node.name}.{names.TYPES}.{module}"
    return f"from .{module} import {PYTHON_NAMES.symbol(used, 'class')}"
