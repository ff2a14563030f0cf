"""Recognition of CAN packets by the identifiers that the ICD describes.

`readings` is for links whose identifiers have parts (node, kind, packet number),
`by_identifier` for CAN frames whose identifier is the id of a message.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from icdgen_runtime.wire.can import CanEvent, CanJoiner, CanMessage, CanPacket

from icdgen.icd import wire_ids
from icdgen.protocol.sections import CAN_WITH_DATA
from icdgen.recognize import match
from icdgen.recognize.packets import Printed
from icdgen.recognize.reading import (
    ACKNOWLEDGE,
    REFUSAL,
    REQUEST,
    TELECOMMAND,
    TELEMETRY,
    Endpoint,
    FrameReading,
)
from icdgen.recognize.selection import Selection
from icdgen.values.errors import BadLength, NotFound
from icdgen.wording import count

_WHAT = {
    "telecommand": TELECOMMAND, "acknowledge": ACKNOWLEDGE, "refusal": REFUSAL, "request": REQUEST, "reply": TELEMETRY,
    "request_refusal": REFUSAL,
}  # fmt: skip


def readings(
    endpoints: Sequence[Endpoint], packets: Sequence[Printed], selection: Selection
) -> list[FrameReading]:
    """Return the messages in the packets, in their order.

    Raise `NotFound`, `BadLength` or `Ambiguous`.
    """
    if not all(packet.extended for packet in packets):
        text = "a packet has an 11-bit identifier, but the identifiers of the ICD have 29 bits"
        raise NotFound(text, "candump prints them with 8 digits")
    sent = [CanPacket(packet.id, packet.data) for packet in packets]
    times = [packet.time for packet in packets]
    can_endpoints = [endpoint for endpoint in endpoints if endpoint.facts.can]
    per_endpoint = [_of_endpoint(endpoint, sent, times) for endpoint in can_endpoints]
    # The right nodes are those that explain the most packets.
    most = max(len(result) for result in per_endpoint)
    if most == 0:
        raise _no_message_error(can_endpoints[0], sent)
    complete = [result for result in per_endpoint if len(result) == most]
    chosen = [
        _chosen([result[number] for result in complete], selection)
        for number in range(most)
    ]
    # Messages that the packets begin, known or unknown. A repeated packet begins none.
    events, waiting = _can_events(complete[0][0].endpoint, sent)
    begun = [event for event in events if event.event != "duplicate"]
    left = len(begun) + len(waiting) - most
    if not left:
        return chosen
    note = f"{left} of the CAN messages are no message of the ICD, or not complete"
    return [chosen[0].with_left_out(note), *chosen[1:]]


def by_identifier(
    endpoints: Sequence[Endpoint], packets: Sequence[Printed], selection: Selection
) -> list[FrameReading]:
    """Return the message of each packet whose CAN identifier is the id.

    Raise `NotFound`, `BadLength` or `Ambiguous` if no packet is a message.
    """
    matches, errors = match.read_each(
        packets, lambda packet: _by_identifier(endpoints, packet, selection)
    )
    reports = [
        f"{error} ({count(number, 'CAN packet')})"
        for error, number in Counter(map(str, errors)).items()
    ]
    return [matches[0].with_left_out(*reports), *matches[1:]]


def _by_identifier(
    endpoints: Sequence[Endpoint], packet: Printed, selection: Selection
) -> FrameReading:
    ids: list[tuple[Endpoint, int]] = []
    for endpoint in endpoints:
        id = wire_ids.of_can(packet.id, packet.extended, endpoint.node.id_bits)
        if id is not None:
            ids.append((endpoint, id))
    candidates = match.of_ids(ids, packet.data)
    if not candidates:
        text = f"no message of {match.nodes_of(endpoints)} has the CAN identifier {packet.identifier}"
        help = "`icdgen show NODE` lists what there is; name the message to have the bytes read all the same"
        raise match.data_error(
            [(endpoint, (id, packet.data)) for endpoint, id in ids],
            NotFound(text, help),
        )
    reading = match.most_likely(
        candidates, f"a packet with the CAN identifier {packet.identifier}", selection
    )
    return replace(reading, time=packet.time).with_remarks(
        f"CAN identifier {packet.identifier} removed"
    )


def _of_endpoint(
    endpoint: Endpoint, packets: list[CanPacket], times: list[str]
) -> list[FrameReading]:
    # A pasted text has no reception times: messages never time out, and any number of
    # senders may be mixed.
    joiner = CanJoiner(endpoint.link, senders=len(packets))
    result = []
    for packet, time in zip(packets, times, strict=True):
        for event in joiner.feed(0, packet):
            reading = _reading(endpoint, event.message) if event.message else None
            if reading is not None:
                # Time of the packet that completes the message.
                result.append(replace(reading, time=time))
    return result


def _reading(endpoint: Endpoint, can_message: CanMessage) -> FrameReading | None:
    """Return the message of the ICD; None for an unknown id or a wrong length."""
    is_telecommand = can_message.kind in ("telecommand", "acknowledge", "refusal")
    facts = endpoint.facts
    messages = facts.telecommands if is_telecommand else facts.telemetry
    message = messages.get(can_message.id)
    if message is None:
        return None
    # An acknowledge has the id of its message, but not its data.
    has_data = can_message.kind in CAN_WITH_DATA
    if has_data and len(can_message.data) != message.length:
        return None
    way = f"CAN, from address {can_message.source} to {can_message.destination}"
    return FrameReading(
        endpoint,
        _WHAT[can_message.kind],
        message,
        can_message.id,
        can_message.data,
        remarks=(way,),
    )


def _can_events(
    endpoint: Endpoint, packets: list[CanPacket]
) -> tuple[list[CanEvent], list[CanEvent]]:
    """Return the events of the packets, and the events of messages that lack packets."""
    joiner = CanJoiner(endpoint.link, senders=len(packets))
    events = [event for packet in packets for event in joiner.feed(0, packet)]
    # After an infinite time every incomplete message is overdue, so `expire` returns
    # all of them.
    return events, joiner.expire(math.inf)


def _received_count(endpoint: Endpoint, packets: list[CanPacket]) -> int:
    """Return the number of packets of the first incomplete message.

    All packets of a message have one identifier.
    """
    for id in dict.fromkeys(packet.id for packet in packets):
        # A packet that was captured twice counts once.
        own = list(dict.fromkeys(packet for packet in packets if packet.id == id))
        if _can_events(endpoint, own)[1]:
            return len(own)
    return 0


def _chosen(candidates: list[FrameReading], selection: Selection) -> FrameReading:
    # The reading of the node that declares a message replaces those of nodes that
    # include it.
    own = (reading for reading in candidates if reading.is_own)
    different = {reading.key: reading for reading in (*candidates, *own)}
    return match.most_likely(
        list(different.values()), f"a CAN message with id {candidates[0].id}", selection
    )


def _no_message_error(
    endpoint: Endpoint, packets: list[CanPacket]
) -> BadLength | NotFound:
    """Return the error for packets without a message of the node."""
    events, waiting = _can_events(endpoint, packets)
    event = events[0] if events else None
    if waiting and not any(candidate.message for candidate in events):
        received, missing = _received_count(endpoint, packets), waiting[0].missing
        text = f"{missing} of {received + missing} packets of the message with id {waiting[0].id} are missing"
        return BadLength(
            text, received + missing, received, "give all packets of the message"
        )
    if event and event.message:
        return match.no_match_error(
            [endpoint], bytes([event.message.id]) + event.message.data
        )
    text = event.event.replace("_", " ") if event else "no message"
    what = f"the packet with identifier 0x{packets[0].id:08X} is none of {endpoint.node.name}"
    return NotFound(f"{what}: {text}", "see the `can` section of its ICD")
