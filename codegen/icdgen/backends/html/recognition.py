"""What pages need to know to recognise any frame: all messages with their ids, and how each node talks."""

from __future__ import annotations

import json
from typing import Any

from icdgen import layout
from icdgen.backends.html import envelopes, wire
from icdgen.backends.html.relations import Relations
from icdgen.icd import wire_ids
from icdgen.icd.model import Message, Node
from icdgen.icd.places import places_in
from icdgen.icd.variants import Variant, ids_of
from icdgen.layout import constant_bytes
from icdgen.protocol import facts


def index(relations: Relations) -> dict[str, Any]:
    """``messages`` as name, page, length and owner; ``speakers`` with the number of the message of each id."""
    messages = [message for node in relations.icd.nodes for message in node.messages]
    numbers = {(message.node, message.name): number for number, message in enumerate(messages)}
    return {
        "messages": [[m.name, relations.links.message(m), m.length, m.node, *_tail(relations, m)] for m in messages],
        "speakers": [_speaker(relations, node, numbers) for node in relations.icd.nodes],
    }


def _tail(relations: Relations, message: Message) -> list[dict[str, Any]]:
    """Where frames differ in length: what these are, and the bits that count the elements."""
    own, parts = message.layout, message.layout.parts
    if message.may_end_early:
        return [{"least": own.shortest, "step": 1, "pieces": []}]
    if not parts:
        return []
    if len(parts) > 1:  # what its frames say themselves, their decoder looks at
        return [{"least": own.shortest, "step": own.lengths.step, "pieces": []}]
    tail, node = parts[-1], relations.icd.node(message.node)
    counter = next((place for place in places_in(own) if place.name == tail.counter and not tail.is_rest), None)
    pieces = () if counter is None else layout.pieces(counter, node)
    found = {"least": own.shortest, "step": tail.step, "pieces": [[p.byte, p.shift, p.bits, p.at] for p in pieces]}
    return [found | ({"low": tail.low} if tail.low else {})]


def script(relations: Relations) -> str:
    """The index as a script, since a page opened from a folder may not fetch anything else."""
    return f'"use strict";\nglobalThis.icdgenFrameIndex = {json.dumps(index(relations), separators=(",", ":"))};\n'


def numbers_of(ids: dict[int, tuple[Variant, ...]], numbers: dict[tuple[str, str], int]) -> dict[str, Any]:
    """The number of the message of each id; where several share it, each with the bytes that its constants are in."""
    found = {
        id: [(numbers[one.message.node, one.message.name], constant_bytes(one)) for one in those]
        for id, those in ids.items()
    }
    return {str(id): those if len(those) > 1 else those[0][0] for id, those in found.items()}


def _speaker(relations: Relations, node: Node, numbers: dict[tuple[str, str], int]) -> dict[str, Any]:
    known, ids = facts.of(relations.icd, node), ids_of(relations.icd, node)
    found: dict[str, Any] = {
        "node": node.name,
        "title": node.title,
        "telecommands": numbers_of(ids.telecommand, numbers),
        "telemetry": numbers_of(ids.telemetry, numbers),
        "id_bytes": wire_ids.size(node.id_bits),
        "id_bits": node.id_bits,
        "errors": {str(code): key.replace("_", " ") for key, code in known.errors.items()},
    }
    found |= wire.framing_facts(known)
    if known.stream:
        found["stream"] = envelopes.script_facts(known.stream)
    if known.checksum:
        found["crc"] = wire.crc_facts(known)
    if known.can:
        found["can"] = wire.can_facts(known.can)
    if known.acknowledge:
        form = known.acknowledge
        found["acknowledge"] = [form.length, form.id_at, form.error_at]
    return found
