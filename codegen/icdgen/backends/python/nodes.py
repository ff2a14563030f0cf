"""One node, or one enumeration -> the values of its template."""

from __future__ import annotations

from icdgen.backends.python import names
from icdgen.backends.python.black import WIDTH, bracketed, by_module, display, exploded, imported
from icdgen.backends.python.text import docstring, literal, prose, sentence
from icdgen.icd.model import Enum, Icd, Node


def values(icd: Icd, node: Node) -> dict[str, object]:
    """What the node template needs."""
    homes = []
    enums = []
    classes: dict[tuple[str, str], str] = {}
    for owner in (*icd.included(node), node):
        for one in (*owner.messages, *owner.enums):
            module = names.module_name(one, owner)
            home = f".{names.TYPES}.{module}" if owner is node else f"..{owner.name}.{names.TYPES}.{module}"
            homes.append((home, names.class_name(one, owner)))
        for message in owner.messages:
            classes[owner.name, message.name] = names.class_name(message, owner)
    for enum in node.enums:
        enums.append(f'{literal(enum.name)}: "{names.class_name(enum, node)}"')
    homes.sort(key=by_module)
    linked = [("._link", "LINK")] if icd.protocol_of(node) else []
    messages = [(m, classes[m.node, m.name]) for m in icd.messages_of(node)]
    return {
        "doc": docstring(0, _documentation(node)),
        "imports": [f"    {imported(4, home, name, name)}" for home, name in sorted(homes + linked, key=by_module)],
        "constants": _constants(node),
        "linked": bool(linked),
        "homes": exploded(0, "{", [f'"{name}": "{home}"' for home, name in homes], "}"),
        "telecommands": _by_id((m.telecommand_id, name) for m, name in messages),
        "telemetry": _by_id((m.telemetry_id, name) for m, name in messages),
        "enums": exploded(0, "{", enums, "}"),
    }


def _by_id(pairs) -> str:
    found = sorted((id, name) for id, name in pairs if id is not None)
    return exploded(0, "{", [f'{id}: "{name}"' for id, name in found], "}")


def _documentation(node: Node) -> list[str]:
    paragraphs = [sentence(node.title)]
    if node.summary:
        paragraphs.append(sentence(node.summary))
    source = dict(node.document)
    if source:
        known = [source[key] for key in ("document", "version", "date") if key in source]
        section = f", section {source['section']}" if "section" in source else ""
        paragraphs.append(f"From {sentence(', '.join(known) + section)}")
    for one in node.missing:
        paragraphs.append(f"Missing: {one.kind} {one.id}, {prose(one.name)}. {sentence(one.why)}")
    return paragraphs


def _constants(node: Node) -> list[str]:
    found = [f'NAME = "{node.name}"', f"TITLE = {literal(node.title)}"]
    if node.node_type is not None:
        found.append(f"NODE_TYPE = {node.node_type}")
    if node.interface_version is not None:
        found.append(f"INTERFACE_VERSION = {node.interface_version}")
    found += [f'DIGEST = "{node.digest}"', '"""SHA-256 of the ICD that this was generated from."""']
    return found


def enum_values(enum: Enum, node: Node) -> dict[str, object]:
    """What the enumeration template needs."""
    table = f", table {enum.table}" if enum.table is not None else ""
    paragraphs = [f"{prose(enum.name)}{table}."]
    if enum.summary:
        paragraphs.append(sentence(enum.summary))
    paragraphs += [f"{e.label} {prose(e.id)}: {sentence(e.title)}" for e in enum.errata]
    members = []
    for member in enum.members:
        notes = [sentence(member.summary)] if member.summary else []
        notes += [f"{e.label} {prose(e.id)}: {sentence(e.title)}" for e in member.errata]
        declaration = member_declaration(names.member(member, node), str(member.value), literal(member.name))
        members.append((declaration, docstring(4, notes) if notes else ""))
    return {
        "head": bracketed(0, f"class {names.class_name(enum, node)}(", ["_enumeration.OpenEnum"], "):"),
        "module_doc": docstring(0, [f"{prose(enum.name)}, an enumeration of {prose(node.title)}."]),
        "doc": docstring(4, paragraphs),
        "members": members,
    }


def member_declaration(name: str, value: str, label: str) -> str:
    """``IDLE = 0, "Idle"``"""
    line = f"{name} = {value}, {label}"
    return line if len(line) + 4 <= WIDTH else exploded(4, f"{name} = (", [value, label], ")").lstrip()


def listed(icd: Icd) -> dict[str, object]:
    """What the package's own files say of the nodes."""
    found = sorted(node.name for node in icd.nodes)
    return {
        "imports": [imported(4, ".", name, name) for name in found],
        "nodes": display(0, "NODES = (", [f'"{name}"' for name in found], ")"),
        "titles": [(node.name, prose(node.title)) for node in icd.nodes],
    }
