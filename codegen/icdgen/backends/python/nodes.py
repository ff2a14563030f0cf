"""One node, or one enumeration -> the values of its template."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.lines import exploded
from icdgen.backends.python import names
from icdgen.backends.python.text import docstring, literal, paragraph, prose
from icdgen.describe import Description, EnumDescription, MessageDescription, NodeDescription
from icdgen.describe.comments import sentence
from icdgen.icd.model import Node


def values(node: NodeDescription, description: Description) -> dict[str, object]:
    """What the node template needs."""
    declared: list[tuple[str, str]] = []
    for owner in map(description.node, (*description.icd.included(node.model), node.model)):
        both: tuple[MessageDescription | EnumDescription, ...] = (*owner.messages, *owner.enums)
        declared += ((names.home(one, node.name, ".."), names.class_name(one)) for one in both)
    linked = [("._link", "LINK")] if node.is_linked else []
    return {
        "doc": docstring(0, _documentation(node.model)),
        "imports": sorted(f"from {home} import {name} as {name}" for home, name in declared + linked),
        "constants": _constants(node.model),
        "linked": node.is_linked,
        "homes": exploded("{", [f'"{name}": "{home}"' for home, name in sorted(declared)], "}"),
        "telecommands": _by_id((one.model.telecommand_id, one) for one in node.telecommands),
        "telemetry": _by_id((one.model.telemetry_id, one) for one in node.telemetry),
        "enums": exploded("{", [f'{literal(one.model.name)}: "{names.class_name(one)}"' for one in node.enums], "}"),
    }


def _by_id(pairs: Iterable[tuple[int | None, MessageDescription]]) -> str:
    found = sorted((id, names.class_name(one)) for id, one in pairs if id is not None)
    return exploded("{", [f'{id}: "{name}"' for id, name in found], "}")


def _documentation(node: Node) -> list[str]:
    source = dict(node.document)
    known = [source[key] for key in ("document", "version", "date") if key in source]
    known[-1:] = [f"{last}, section {source['section']}" if "section" in source else last for last in known[-1:]]
    paragraphs = [sentence(node.title), sentence(node.summary), sentence(f"From {', '.join(known)}") if known else ""]
    paragraphs += (f"Missing: {one.kind} {one.id}, {sentence(one.name)} {sentence(one.why)}" for one in node.missing)
    return [paragraph(text) for text in paragraphs if text]


def _constants(node: Node) -> list[str]:
    found = [f'NAME = "{node.name}"', f"TITLE = {literal(node.title)}"]
    if node.node_type is not None:
        found.append(f"NODE_TYPE = {node.node_type}")
    if node.interface_version is not None:
        found.append(f"INTERFACE_VERSION = {node.interface_version}")
    found += [f'DIGEST = "{node.digest}"', '"""SHA-256 of the ICD that this was generated from."""']
    return found


def enum_values(enum: EnumDescription) -> dict[str, object]:
    """What the enumeration template needs."""
    members = []
    for one in enum.members:
        notes = [
            paragraph(text) for text in one.comment.paragraphs[1:]
        ]  # the head says name and value, as the code does
        declaration = f"{one.name.upper()} = {one.model.value}, {literal(one.model.name)}"
        members.append((declaration, docstring(4, notes) if notes else ""))
    return {
        "name": names.class_name(enum),
        "module_doc": docstring(0, [f"{prose(enum.model.name)}, an enumeration of {prose(enum.node.title)}."]),
        "doc": docstring(4, map(paragraph, enum.comment.paragraphs)),
        "members": members,
    }


def listed(description: Description) -> dict[str, object]:
    """What the package's own files say of the nodes."""
    found = sorted(node.name for node in description.nodes)
    return {
        "imports": [f"from . import {name} as {name}" for name in found],
        "nodes": exploded("NODES = (", [f'"{name}"' for name in found], ")"),
        "titles": [(node.name, prose(node.model.title)) for node in description.nodes],
    }
