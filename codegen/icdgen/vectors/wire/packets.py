"""Messages split into CAN packets, and put together from whatever arrives."""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen.protocol import can
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import CAN_KINDS, CAN_WITH_DATA
from icdgen.vectors.wire import Requests


def requests(known: Facts, source: Random) -> Requests:
    """Messages split into packets, and put together from whatever arrives."""
    form = known.can
    assert form
    node, other, third = form.node_address, 0x42, 0xFE
    samples: list[can.Message] = []
    for kind in CAN_KINDS:
        ids = known.telecommands if kind in ("telecommand", "acknowledge", "refusal") else known.telemetry
        if kind not in form.types:
            continue
        if kind not in CAN_WITH_DATA:
            samples += [can.Message(kind, id, node, other) for id in list(ids)[:2]]
            continue
        by_length = {m.length: id for id, m in reversed(ids.items())}
        for length, id in sorted(by_length.items()):
            ends = (other, node) if kind == "telecommand" else (node, other)
            samples.append(can.Message(kind, id, *ends, source.randbytes(length)))
    for message in samples:
        why = f"{message.kind} {message.id}, {len(message.data)} bytes"
        about = {"kind": message.kind, "id": message.id, "source": message.source, "destination": message.destination}
        yield why, {"op": "can_split", **about, "bytes": message.data.hex()}
        yield why, {"op": "can_join", "packets": [_row(packet) for packet in can.split(known, message)]}
    if form.extended:
        most = form.extended.bytes
        about = {"kind": "telecommand", "id": 0x7F, "source": other, "destination": node}
        for size in (most, most + 1):
            yield f"{size} bytes", {"op": "can_split", **about, "bytes": source.randbytes(size).hex()}
        yield "data where none is expected", {"op": "can_split", **about, "kind": "request", "bytes": "00"}
        yield from _joins(known, source, other, third)


def _row(packet: can.Packet, at: int = 0) -> dict[str, Any]:
    return {**({"at": at} if at else {}), "id": packet.id, "bytes": packet.data.hex()}


def _joins(known: Facts, source: Random, other: int, third: int) -> Requests:
    """Packets out of order, twice, lost, late, and from several senders."""
    form = known.can
    assert form and form.extended
    long = sorted((m.length, id) for id, m in known.telecommands.items() if m.length > form.extended.data_bytes * 2)
    if not long:
        return
    length, id = long[len(long) // 2]
    node, late = form.node_address, form.extended.packet_timeout

    def sent(sender: int, seed: str, length: int = length, id: int = id) -> list[can.Packet]:
        data = Random(f"{known.node.name} {seed}").randbytes(length)
        return can.split(known, can.Message("telecommand", id, sender, node, data))

    one, two = sent(other, "one"), sent(other, "two")
    alike = [*one[:2], *two[2:]]
    foreign = sent(third, "three")
    shuffled = source.sample(one, len(one))
    unknown_id = next(i for i in range(127, -1, -1) if i not in known.telecommands)
    unknown = sent(other, "unknown", 20, unknown_id)
    mixed = [packet for pair in zip(one, foreign, strict=True) for packet in pair]
    rows = [
        ("out of order", shuffled),
        ("each packet twice", [packet for packet in one for _ in range(2)]),
        ("two messages, one after the other", one + two),
        ("the same message twice", one + one),
        ("the last packet twice, then another message", [*one, one[-1], *two]),
        ("a lost packet, then the same message again", [*one[:1], *one[2:], *one]),
        ("a lost last packet, then another message", [*one[:-1], *two]),
        ("a lost last packet, then a message that begins alike", [*one[:-1], *alike]),
        ("two senders, in turn", mixed),
        ("two senders in turn, one packet lost", mixed[:1] + mixed[2:]),
        ("an unknown id", unknown),
        ("an unknown id, the first packet lost", unknown[1:]),
        ("a count that is too high", [can.Packet(one[0].id, one[0].data[:-1] + b"\xff"), *one]),
        ("a packet that is too short", [*one[:2], can.Packet(one[2].id, one[2].data[:-1]), *one]),
        ("a message type that does not exist", [can.Packet((1 << 29) - 1, b"\x01"), *one]),
    ]
    for why, row in rows:
        yield why, {"op": "can_join", "packets": [_row(packet) for packet in row], "end": late}
    yield "no receiver for them", {"op": "can_join", "address": node ^ 1, "packets": [_row(p) for p in one]}
    paused = [_row(packet, late - 1) for packet in one[1:]]
    yield "a pause just short enough", {"op": "can_join", "packets": [_row(one[0]), *paused]}
    paused = [_row(packet, late) for packet in one]
    yield "a pause that is too long", {"op": "can_join", "packets": [_row(one[0]), *paused]}
    crowd = [sent(sender, str(sender)) for sender in range(5)]
    turns = [packet for turn in zip(*crowd, strict=True) for packet in turn]
    for senders in (4, 5):
        asked = {"op": "can_join", "senders": senders, "packets": [_row(p) for p in turns]}
        yield f"five senders, room for {senders}", asked
    asked = {"op": "can_join", "senders": 1, "packets": [_row(p) for p in (*one, *foreign)]}
    yield "one after the other, room for one", asked
