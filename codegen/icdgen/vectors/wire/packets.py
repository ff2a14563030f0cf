"""Requests that split messages into CAN packets and join received packets.

`requests` takes the link and the protocol facts of a node with CAN, and a random
source. It yields ``can_split`` and ``can_join`` requests for each kind of message and
length of data. If messages can have several packets, some are lost, repeated, out of
order or from several senders. `icdgen.vectors.protocol` adds the expected responses.
"""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen_runtime.wire.can import CanMessage, CanPacket, can_split

from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import CAN_WITH_DATA
from icdgen.runtime_objects.operations import CAN_KINDS, AnyLink
from icdgen.vectors.wire import Requests


def requests(link: AnyLink, facts: Facts, source: Random) -> Requests:
    """Yield requests that split messages into packets and join received packets."""
    form = facts.can
    assert form
    node, other, third = form.node_address, 0x42, 0xFE
    samples: list[CanMessage] = []
    for kind in CAN_KINDS:
        ids = (
            facts.telecommands
            if kind in ("telecommand", "acknowledge", "refusal")
            else facts.telemetry
        )
        if kind not in form.types:
            continue
        if kind not in CAN_WITH_DATA:
            samples += [CanMessage(kind, id, node, other) for id in list(ids)[:2]]
            continue
        # Reversed, so that the first message of each length remains.
        by_length = {m.length: id for id, m in reversed(ids.items())}
        for length, id in sorted(by_length.items()):
            ends = (other, node) if kind == "telecommand" else (node, other)
            samples.append(CanMessage(kind, id, *ends, source.randbytes(length)))
    for message in samples:
        why = f"{message.kind} {message.id}, {len(message.data)} bytes"
        about = {
            "kind": message.kind,
            "id": message.id,
            "source": message.source,
            "destination": message.destination,
        }
        yield why, {"op": "can_split", **about, "bytes": message.data.hex()}
        yield (
            why,
            {
                "op": "can_join",
                "packets": [_row(packet) for packet in can_split(link, message)],
            },
        )
        if message.kind not in CAN_WITH_DATA:
            (packet,) = can_split(link, message)
            yield (
                f"{why}, received with a byte",
                {"op": "can_join", "packets": [_row(CanPacket(packet.id, b"\x05"))]},
            )
    if form.extended:
        most = form.extended.bytes
        about = {
            "kind": "telecommand",
            "id": 0x7F,
            "source": other,
            "destination": node,
        }
        for size in (most, most + 1):
            yield (
                f"{size} bytes",
                {"op": "can_split", **about, "bytes": source.randbytes(size).hex()},
            )
        yield (
            "data where none is expected",
            {"op": "can_split", **about, "kind": "request", "bytes": "00"},
        )
        yield from _joins(link, facts, source, other, third)


def _row(packet: CanPacket, at: int = 0) -> dict[str, Any]:
    return {**({"at": at} if at else {}), "id": packet.id, "bytes": packet.data.hex()}


def _joins(
    link: AnyLink, facts: Facts, source: Random, other: int, third: int
) -> Requests:
    """Yield received packets: out of order, repeated, lost, late and from several
    senders.
    """
    form = facts.can
    assert form and form.extended
    long = sorted(
        (m.length, id)
        for id, m in facts.telecommands.items()
        if m.length > form.extended.data_bytes * 2
    )
    if not long:
        return
    length, id = long[len(long) // 2]
    node, late = form.node_address, form.extended.packet_timeout

    def sent(
        sender: int, seed: str, length: int = length, id: int = id
    ) -> list[CanPacket]:
        data = Random(f"{facts.node.name} {seed}").randbytes(length)
        return can_split(link, CanMessage("telecommand", id, sender, node, data))

    first, second = sent(other, "one"), sent(other, "two")
    # A second message that starts with the packets of the first one.
    alike = [*first[:2], *second[2:]]
    foreign = sent(third, "three")
    shuffled = source.sample(first, len(first))
    unknown_id = next(i for i in range(127, -1, -1) if i not in facts.telecommands)
    unknown = sent(other, "unknown", 20, unknown_id)
    mixed = [packet for pair in zip(first, foreign, strict=True) for packet in pair]
    rows = [
        ("out of order", shuffled),
        ("each packet twice", [packet for packet in first for _ in range(2)]),
        ("two messages, one after the other", first + second),
        ("the same message twice", first + first),
        ("the last packet twice, then another message", [*first, first[-1], *second]),
        (
            "a lost packet, then the same message again",
            [*first[:1], *first[2:], *first],
        ),
        ("a lost last packet, then another message", [*first[:-1], *second]),
        ("a lost last packet, then a message that begins alike", [*first[:-1], *alike]),
        ("two senders, in turn", mixed),
        ("two senders in turn, one packet lost", mixed[:1] + mixed[2:]),
        ("an unknown id", unknown),
        ("an unknown id, the first packet lost", unknown[1:]),
        (
            "a count that is too high",
            [CanPacket(first[0].id, first[0].data[:-1] + b"\xff"), *first],
        ),
        (
            "a packet that is too short",
            [*first[:2], CanPacket(first[2].id, first[2].data[:-1]), *first],
        ),
        (
            "a message type that does not exist",
            # ISO 11898-1: an extended identifier has 29 bits.
            [CanPacket((1 << 29) - 1, b"\x01"), *first],
        ),
    ]
    for why, row in rows:
        yield (
            why,
            {
                "op": "can_join",
                "packets": [_row(packet) for packet in row],
                "end": late,
            },
        )
    yield (
        "no receiver for them",
        {"op": "can_join", "address": node ^ 1, "packets": [_row(p) for p in first]},
    )
    paused = [_row(packet, late - 1) for packet in first[1:]]
    yield (
        "a pause just short enough",
        {"op": "can_join", "packets": [_row(first[0]), *paused]},
    )
    paused = [_row(packet, late) for packet in first]
    yield (
        "a pause that is too long",
        {"op": "can_join", "packets": [_row(first[0]), *paused]},
    )
    # One sender more than a joiner can handle by default.
    crowd = [sent(sender, str(sender)) for sender in range(5)]
    turns = [packet for turn in zip(*crowd, strict=True) for packet in turn]
    for senders in (4, 5):
        request = {
            "op": "can_join",
            "senders": senders,
            "packets": [_row(p) for p in turns],
        }
        yield f"five senders, room for {senders}", request
    request = {
        "op": "can_join",
        "senders": 1,
        "packets": [_row(p) for p in (*first, *foreign)],
    }
    yield "one after the other, room for one", request
