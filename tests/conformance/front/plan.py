"""The plan of a set of ICDs as JSON: names and types by index, all that the front
needs.
"""

from __future__ import annotations

from typing import Any

from icdgen.describe import describe
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import scalars_in
from icdgen.protocol import facts
from icdgen.protocol.procedures import Procedure


def plan(icd: Icd) -> dict[str, Any]:
    """Return the plan of a set of ICDs. Nodes, messages and enumerations have the order
    of the description.
    """
    description = describe(icd)
    every = [message for node in description.nodes for message in node.messages]
    places = {
        (message.model.node, message.model.name): place
        for place, message in enumerate(every)
    }
    return {
        "messages": [_message(message.model) for message in every],
        "nodes": [
            {
                "name": node.name,
                "id_bits": node.id_bits,
                "speaks": [
                    places[message.model.node, message.model.name]
                    for message in node.all_messages
                ],
                "enums": [enum.model.name for enum in node.enums],
                "link": _link(icd, node.model) if node.is_linked else None,
            }
            for node in description.nodes
        ],
    }


def _message(message: Message) -> dict[str, Any]:
    return {
        "name": message.name,
        "telecommand": message.telecommand_id,
        "telemetry": message.telemetry_id,
        "configuration": [message.set_id, message.get_id],
        "fields": [
            {
                "name": field.name,
                "type": field.type,
                "bits": field.bits,
                "scaled": field.has_formula or field.type == "text",
                "settable": (
                    (field.has_formula and field.is_invertible) or field.type == "text"
                )
                and not field.is_read_only,
                "view": field.is_read_only,
                "conditional": bool(field.conditions),
            }
            for field in sorted(
                scalars_in(message.layout), key=lambda field: field.is_read_only
            )
        ],
    }


def _procedure(procedure: Procedure) -> dict[str, Any]:
    return {
        "name": procedure.name,
        "inputs": [
            {"name": each.name, "is_optional": each.is_optional}
            for each in procedure.inputs
            if not each.is_bytes
        ],
        "outputs": [each.name for each in procedure.outputs],
        "receives": procedure.blocks is not None and not procedure.blocks.sends,
        "lists": procedure.entry is not None,
    }


def _link(icd: Icd, node: Node) -> dict[str, Any]:
    link_facts = facts.of(icd, node)
    framing, stream = link_facts.framing, link_facts.stream
    chosen = stream.chosen("telemetry") if stream else {}
    around = max(packet.overhead for packet in stream.packets) if stream else 0
    return {
        "longest": link_facts.longest,
        "around": around,
        "of_device": {role: field.mask for role, field in chosen.items()},
        "framing": [framing.escape, framing.end] if framing else None,
        "procedures": [_procedure(each) for each in link_facts.procedures],
    }
