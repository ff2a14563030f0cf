"""Data by which pages recognize any frame: all messages with their ids, and the
protocol of each node.

Output is the script ``frame-index.js``. The site has no server, so the scripts of each
page decide with this index which message a pasted frame is.
"""

from __future__ import annotations

import json
from typing import Any

from icdgen import frame_bits
from icdgen.backends.html import packet_formats, wire
from icdgen.backends.html.relations import Relations
from icdgen.frame_bits import constant_bytes
from icdgen.icd import wire_ids
from icdgen.icd.buses import UART
from icdgen.icd.model import Message, Node
from icdgen.icd.places import places_in
from icdgen.icd.variants import Variant, ids_of
from icdgen.protocol import facts


def frame_index(relations: Relations) -> dict[str, Any]:
    """Return ``messages`` with name, page, length and owner, and ``speakers`` with the
    message number of each id.
    """
    messages = [message for node in relations.icd.nodes for message in node.messages]
    numbers = {
        (message.node, message.name): number for number, message in enumerate(messages)
    }
    return {
        "messages": [
            [
                m.name,
                relations.links.message(m),
                m.length,
                m.node,
                *_variable_lengths(relations, m),
            ]
            for m in messages
        ],
        "speakers": [
            _speaker_data(relations, node, numbers) for node in relations.icd.nodes
        ],
    }


def _variable_lengths(relations: Relations, message: Message) -> list[dict[str, Any]]:
    """Return the lengths of frames of variable length, and the bits of the counter."""
    own, parts = message.layout, message.layout.parts
    # Any length down to the shortest is possible, and nothing counts the bytes.
    if message.may_end_early:
        return [{"least": own.shortest, "step": 1, "pieces": []}]
    if not parts:
        return []
    if own.has_inner_gaps:  # the decoder evaluates the counters in the frame
        return [{"least": own.shortest, "step": own.lengths.step, "pieces": []}]
    tail, node = parts[-1], relations.icd.node(message.node)
    # A part up to the end of the frame has no counter.
    counter = next(
        (
            place
            for place in places_in(own)
            if place.name == tail.counter and not tail.is_rest
        ),
        None,
    )
    pieces = () if counter is None else frame_bits.pieces(counter, node)
    tail_data = {
        "least": own.shortest,
        "step": tail.step,
        "pieces": [[p.byte, p.shift, p.bits, p.at] for p in pieces],
    }
    return [tail_data | ({"low": tail.low} if tail.low else {})]


def script(relations: Relations) -> str:
    """Return the index as a script.

    A page opened from a folder cannot load other data.
    """
    return f'"use strict";\nglobalThis.icdgenFrameIndex = {json.dumps(frame_index(relations), separators=(",", ":"))};\n'


def message_numbers(
    ids: dict[int, tuple[Variant, ...]], numbers: dict[tuple[str, str], int]
) -> dict[str, Any]:
    """Return the message number of each id.

    For a shared id, each message has the bytes of its constants.
    """
    numbers_by_id: dict[str, Any] = {}
    for id, variants in ids.items():
        candidates = [
            (numbers[each.message.node, each.message.name], constant_bytes(each))
            for each in variants
        ]
        # Most ids have one message: its number alone keeps the index small.
        is_shared = len(candidates) > 1
        numbers_by_id[str(id)] = candidates if is_shared else candidates[0][0]
    return numbers_by_id


def _speaker_data(
    relations: Relations, node: Node, numbers: dict[tuple[str, str], int]
) -> dict[str, Any]:
    node_facts, ids = facts.of(relations.icd, node), ids_of(relations.icd, node)
    speaker_data: dict[str, Any] = {
        "node": node.name,
        "title": node.title,
        "telecommands": message_numbers(ids.telecommand, numbers),
        "telemetry": message_numbers(ids.telemetry, numbers),
        "id_bytes": wire_ids.size(node.id_bits),
        "id_bits": node.id_bits,
    }
    speaker_data |= wire.framing_facts(node_facts)
    if node_facts.stream:
        stream = packet_formats.script_facts(node_facts.stream, with_responses=True)
        speaker_data["stream"] = stream
        if "responses" in stream:  # they need not be about a message
            speaker_data["protocol"] = relations.links.protocol(node.name)
    if node_facts.checksum:
        speaker_data["crc"] = wire.crc_facts(node_facts)
    if node_facts.can:
        speaker_data["can"] = wire.can_facts(node_facts.can)
    uart = node_facts.bus_exchanges.get(UART)
    for response in uart.command.responses if uart and uart.command else ():
        size = node_facts.acknowledge and node_facts.acknowledge.overhead
        if size and response.reason:
            places = response.echoes[0].place.at, response.reason.at
            speaker_data["acknowledge"] = [size, *places, dict(response.reasons)]
    return speaker_data
