"""The page of a message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from icdgen.backends.html import drawing, fields, plan, sections, texts, wire
from icdgen.backends.html.examples import examples, frames
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.usage import names, snippets
from icdgen.describe import describe
from icdgen.describe.errata import errata_of_message
from icdgen.describe.numbers import count_text, length_text
from icdgen.describe.shared_ids import sharing
from icdgen.icd import wire_ids
from icdgen.icd.model import Message, Node

if TYPE_CHECKING:
    from icdgen.render import Renderer


def values(relations: Relations, node: Node, message: Message, render: Renderer) -> dict[str, Any]:
    """Values of the page of a message that ``node`` declares."""
    anchors = relations.anchors(message)
    parts = sections.bands(relations, message)
    shares = parts or sections.shares(message)
    pictures = _pictures(message, node, anchors, parts)
    rows = fields.rows(message, node, relations.links, anchors)
    travels = relations.wire(message)
    shown = examples(message, node)
    data = shown[0].frame if shown and message.telemetry_id is not None else _fresh(message, node)
    return {
        "message": message,
        "node": node,
        "url": relations.links.message(message),
        "ids": texts.ids(message),
        "names": names(describe(relations.icd).message(message)),
        "facts": _facts(relations, node, message),
        "drawings": pictures,
        "keyed": any(picture.keyed for picture in pictures),
        "rows": rows,
        "columns": fields.columns_of(rows),
        "bands": [(one, fields.between(rows, one), picture) for one, picture in zip(parts, pictures, strict=False)],
        "shares": [(one, fields.between(rows, one)) for one in shares],
        "buses": wire.buses(message, travels, data),
        "example_data": message.telemetry_id is not None and bool(data),
        "examples": shown,
        "frames": frames(message, node),
        "snippets": snippets(describe(relations.icd).message(message), render),
        "contains": relations.contains.get((message.node, message.name), []),
        "contained_in": relations.contained_in.get((message.node, message.name), []),
        "errata": errata_of_message(message),
        "plan": texts.script_json(_plan(node, message, pictures, shares, travels)),
    }


def _facts(relations: Relations, node: Node, message: Message) -> list[tuple[str, str, str]]:
    """Label, text, and where a link leads."""
    facts = [("Length", length_text(message), ""), ("Fields", str(message.field_count), "")]
    arrays = {one.path[0].name for one in message.fields if one.path}
    for part in message.open_parts:
        is_told = message.counter is not None and message.counter.implied and part is message.tail
        until = "up to the end" if is_told else f"as many as {count_text(part)} says"
        what = "element" if part.step > 1 or part.name in arrays else "byte"
        label = "Open end" if part is message.tail else "Open part"
        facts.append((label, f"{part.name}: up to {texts.count(part.most, what)}, {until}", ""))
    if message.may_end_early:
        facts.append(("End", "may be left out as far as it is zeros", ""))
    if message.reserved:
        facts.append(("Reserved", f"last {texts.count(message.reserved, 'byte')}", ""))
    shared = describe(relations.icd).node(node).known_ids
    told = sharing(shared, message)
    if told:
        facts.append(("Id", told, ""))
    if message.group:
        facts.append(("Group", message.group, ""))
    protocol = relations.icd.protocol_of(node) or {}
    reply = protocol.get("stream", {}).get("replies", {}).get(message.name)
    answer = next((one for one in relations.icd.messages_of(node) if one.name == reply), None)
    if answer is not None:
        facts.append(("Answered with", answer.name, relations.links.message(answer)))
    elif message.telecommand_id is not None and "stream" not in protocol:
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

    return codec.encode(node, message, message.fresh)


def _pictures(message: Message, node: Node, anchors: list[str], parts: list[sections.Section]) -> list[drawing.Drawing]:
    """One of each part; of what has none, one of the message."""
    places = [(one.first, one.end) for one in parts] or [(0, message.length)]
    made = [drawing.draw(message, node, anchors, first, end) for first, end in places]
    return [picture for picture in made if picture is not None]


def _plan(
    node: Node,
    message: Message,
    pictures: list[drawing.Drawing],
    shares: list[sections.Section],
    travels: wire.Wire,
) -> dict[str, object]:
    enums = {field.enum.name: plan.enum_plan(field.enum) for field in message.fields if field.enum is not None}
    shown = [one for one in shares if one.keys]
    return {
        **plan.message_plan(message, node),
        "enums": enums,
        "drawings": [picture.plan for picture in pictures],
        "sections": [{"title": f"{s.title}, {s.about}", "keys": s.keys, "open": s.open} for s in shown],
        "wire": {**wire.page_facts(message, travels), "id_bytes": wire_ids.size(node.id_bits)},
    }
