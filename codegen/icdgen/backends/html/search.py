"""The index of the search: everything that has a name, with the words it is found by and the way there."""

from __future__ import annotations

import json
from collections.abc import Iterator

from icdgen.backends.html import texts
from icdgen.backends.html.relations import Relations
from icdgen.icd.model import Message

_MOST = 300  # characters of a name that is searched

Entry = tuple[str, str, str, str, str]  # kind, title, context, further words, url


def entries(relations: Relations) -> Iterator[Entry]:
    """Nodes, messages, enumerations, units and errata, then fields and members."""
    icd, links = relations.icd, relations.links
    for node in icd.nodes:
        yield "node", node.title, node.summary, node.name, links.node(node.name)
    for node in icd.nodes:
        for message in node.messages:
            yield "message", message.name, _about(node.title, message), _numbers(message), links.message(message)
        for enum in node.enums:
            yield "enumeration", enum.name, node.title, "", links.enum(enum)
    for unit, _ in relations.units.values():
        yield "unit", unit.symbol, unit.quantity, unit.identifier, links.unit(unit)
    for node in icd.nodes:
        for message in node.messages:
            for field in message.fields:
                words = f"{field.unit.symbol} {field.unit.identifier}" if field.unit else ""
                yield "field", field.name, f"{message.name} · {node.title}", words, links.field(message, field)
        for enum in node.enums:
            for member in enum.members:
                url = f"{links.enum(enum)}#{links.anchor(enum, str(member.value))}"
                yield "member", member.name, f"{enum.name} = {member.value} · {node.title}", "", url
        for erratum in node.errata:
            yield erratum.label.lower(), f"{erratum.id} {erratum.title}", node.title, "", links.erratum(erratum)


def script(relations: Relations) -> str:
    """The index as a script, since a page opened from a folder may not fetch anything else."""
    rows = [[texts.clip(part, _MOST) for part in entry[:4]] + [entry[4]] for entry in entries(relations)]
    lines = ",\n".join(json.dumps(row, separators=(",", ":")) for row in rows)
    return f'"use strict";\nglobalThis.icdgenSearchIndex = [\n{lines}\n];\n'


def _about(title: str, message: Message) -> str:
    ids = "/".join(f"{id} (0x{id:02X})" for _, id in texts.ids(message))
    return f"{message.kind} {ids} · {title}"


def _numbers(message: Message) -> str:
    """Ids in every spelling: decimal, hexadecimal with and without prefix."""
    return " ".join(f"{id} 0x{id:02x} {id:02x}h" for id in message.ids)
