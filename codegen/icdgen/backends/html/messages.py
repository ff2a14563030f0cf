"""The page of a message."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from icdgen.backends.html import drawing, fields, plan, texts, wire
from icdgen.backends.html.examples import examples, frames
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.usage import snippets
from icdgen.describe import describe
from icdgen.describe.errata import errata_of_message
from icdgen.describe.fresh import fresh_values
from icdgen.icd import wire_ids
from icdgen.icd.model import Message, Node

if TYPE_CHECKING:
    from icdgen.render import Renderer


def values(relations: Relations, node: Node, message: Message, render: Renderer) -> dict[str, Any]:
    """Values of the page of a message that ``node`` declares."""
    anchors = relations.anchors(message)
    picture = drawing.draw(message, node, anchors)
    travels = relations.wire(message)
    shown = examples(message, node)
    data = shown[0].frame if shown and message.telemetry_id is not None else _fresh(message, node)
    return {
        "message": message,
        "node": node,
        "url": relations.links.message(message),
        "ids": texts.ids(message),
        "facts": _facts(relations, node, message),
        "drawing": picture,
        "rows": fields.rows(message, node, relations.links, anchors),
        "buses": wire.buses(message, travels, data),
        "example_data": message.telemetry_id is not None and bool(data),
        "examples": shown,
        "frames": frames(message, node),
        "snippets": snippets(describe(relations.icd).message(message), render),
        "contains": relations.contains.get((message.node, message.name), []),
        "contained_in": relations.contained_in.get((message.node, message.name), []),
        "errata": errata_of_message(message),
        "plan": _script_json(_plan(relations, node, message, picture, travels)),
    }


def _facts(relations: Relations, node: Node, message: Message) -> list[tuple[str, str, str]]:
    """Label, text, and where a link leads."""
    facts = [("Length", texts.count(message.length, "byte"), ""), ("Fields", str(len(message.fields)), "")]
    if message.group:
        facts.append(("Group", message.group, ""))
    if message.telecommand_id is not None:
        facts.append(("Acknowledged", "yes" if message.acknowledge else "no", ""))
    for owner, row in relations.logged.get((message.node, message.name), []):
        facts.append(("Log mask", f"bit {row.bit}", relations.links.node(owner.name) + "#log-mask"))
    source = [f"table {message.table}"] if message.table else []
    source += [f"page {message.page}"] if message.page else []
    if source:
        facts.append(("Manual", ", ".join(source), ""))
    others = [one.title for one in relations.speakers[node.name] if one is not node]
    if others:
        facts.append(("Spoken by", ", ".join(others), ""))
    return facts


def _fresh(message: Message, node: Node) -> bytes:
    """The frame of a new message: zeros, and what is constant."""
    from icdgen import codec

    return codec.encode(node, message, fresh_values(message))


def _plan(
    relations: Relations, node: Node, message: Message, picture: drawing.Drawing | None, travels: wire.Wire
) -> dict[str, object]:
    enums = {field.enum.name: plan.enum_plan(field.enum) for field in message.fields if field.enum is not None}
    return {
        **plan.message_plan(message, node),
        "enums": enums,
        "drawing": picture.plan if picture else None,
        "wire": {**wire.page_facts(message, travels), "id_bytes": wire_ids.size(node.id_bits)},
    }


def _script_json(value: object) -> str:
    """JSON that may stand in a script element, whatever is in it."""
    text = json.dumps(value, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
