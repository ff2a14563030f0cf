"""Random requests about framing that the vectors do not contain: streams cut anywhere,
packets in any order, long scripts.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.can import CanMessage, can_split
from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.uart import uart_encode

from icdgen.icd.model import Icd
from icdgen.procedures.actions import Listing
from icdgen.procedures.blocks import BlockReading
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.vectors.wire.recording import ClientReport, RecordedDevice, record
from tests import links

MOST_PACKET_GAP_MS = 700


def requests(icd: Icd, count: int, seed: int = 1) -> Iterator[dict]:
    """Yield ``count`` requests of each kind for each node that has a protocol."""
    source = random.Random(seed)
    for node in icd.nodes:
        if not icd.protocol_of(node):
            continue
        facts_of_node, link = facts.of(icd, node), links.link(icd, node.name)
        for _ in range(count):
            for make in (stream, _packets, _client):
                yield {"node": node.name, **make(link, source)}
            yield {"node": node.name, **_procedure(facts_of_node, link, source)}


def _cut(data: bytes, source: random.Random) -> list[bytes]:
    """Split the bytes into chunks of any size."""
    cuts = sorted(
        source.randrange(len(data) + 1)
        for _ in range(source.randrange(1 + len(data) // 4))
    )
    return [data[a:b] for a, b in zip([0, *cuts], [*cuts, len(data)], strict=True)]


def _noise(link: Link, source: random.Random, most: int) -> bytes:
    form = link.framing
    assert form
    marks = [form.escape, form.escape, form.start, form.end, form.escaped]
    return bytes(
        source.choice(marks) if source.random() < 0.6 else source.randrange(256)
        for _ in range(source.randrange(most))
    )


def stream(link: Link, source: random.Random) -> dict:
    """Return a stream of messages and noise, cut anywhere."""
    assert link.framing
    stream = b""
    for _ in range(source.randrange(4)):
        message = bytes(
            [source.choice([31, 119, 146, 255, source.randrange(256)])]
        ) + _noise(link, source, 24)
        stream += _noise(link, source, 12) + uart_encode(link, message)
        stream = stream[: -source.randrange(1, 5)] if source.random() < 0.2 else stream
    chunks = [piece.hex() for piece in _cut(stream, source)]
    return {
        "op": "uart_events",
        "chunks": chunks,
        "limit": min(source.choice([1, 2, 8, link.longest]), link.longest),
    }


def _packets(link: Link, source: random.Random) -> dict:
    rows, now = [], 0
    long = [id for id, length in link.frames.items() if 8 < length < 60] or [200]
    for _ in range(source.randrange(1, 5)):
        id = source.choice([source.choice(long), 3, source.randrange(256)])
        message = CanMessage(
            "reply",
            id,
            source.choice([1, 2]),
            source.choice([0, 9]),
            source.randbytes(source.randrange(60)),
        )
        sent_packets = can_split(link, message)
        sent_packets = [
            packet for packet in sent_packets if source.random() < 0.95
        ] + source.choices(sent_packets, k=source.randrange(3))
        if source.random() < 0.5:
            source.shuffle(sent_packets)
        rows += [[packet.id, packet.data] for packet in sent_packets]
    if source.random() < 0.5:
        source.shuffle(rows)
    packets = []
    for id, data in rows:
        now += source.choice([0, 1, 10, MOST_PACKET_GAP_MS])
        if source.random() < 0.05:
            id, data = source.randrange(1 << 29), source.randbytes(source.randrange(9))
        packets.append({"at": now, "id": id, "bytes": data.hex()})
    more: dict[str, object] = {"end": now + 5000} if source.random() < 0.5 else {}
    if source.random() < 0.3:
        more["address"] = source.choice([0, 9])
    return {
        "op": "can_join",
        "packets": packets,
        "senders": source.randrange(1, 5),
        **more,
    }


def _client(link: Link, source: random.Random) -> dict:
    bus, checked = source.choice(["uart", "i2c", "can"]), source.random() < 0.5
    now, script = source.choice([0, 0, 1000]), []
    expected: tuple[str, int] = ("telemetry", 128)
    for _ in range(source.randrange(2, 30)):
        now += source.choice([0, 1, 5, 20, 20, 100, 1000])
        row: dict = {"at": now}
        kind = source.random()
        if kind < 0.3:
            if source.random() < 0.5:
                expected = ("telemetry", source.choice([*link.frames, 128, 128, 3]))
                row["telemetry"] = expected[1]
            else:
                expected = ("telecommand", source.choice([*link.commands, 31, 200]))
                command = link.commands.get(expected[1])
                size = (
                    command.length
                    if command and source.random() < 0.95
                    else source.randrange(9)
                )
                row |= {
                    "telecommand": expected[1],
                    "bytes": source.randbytes(size).hex(),
                    "repeat": source.random() < 0.5,
                }
        elif kind < 0.85:
            row["receive"] = _heard(link, bus, checked, expected, source)
        elif kind < 0.9:
            row["cancel"] = True
        script.append(row)
    settings = {
        "reply_timeout": source.choice([30, 500]),
        "retries": source.choice([0, 2]),
        "poll_timeout": 200,
    }
    more = {"settings": settings} if source.random() < 0.7 else {}
    return {
        "op": "client",
        "bus": bus,
        "crc": checked,
        "address": 9,
        "script": script,
        **more,
    }


def _heard(
    link: Link,
    bus: str,
    checked: bool,
    expected: tuple[str, int],
    source: random.Random,
) -> object:
    kind, id = expected
    command = link.commands.get(id)
    length = command and command.length
    if kind == "telemetry":
        length = link.frames.get(id)
    is_whole = length is not None and source.random() < 0.9
    size = length if is_whole else source.randrange(12)
    code = source.choice([0, 0, 1, 4, 4, 9])
    if bus == "uart":
        assert link.framing
        answer = (
            bytes([id, code])
            if kind == "telecommand"
            else bytes([id]) + source.randbytes(size)
        )
        if source.random() < 0.1:
            answer = bytes([119]) + source.randbytes(22)
        stream = uart_encode(link, answer) * source.choice([1, 1, 2, 3])
        return (
            stream
            if source.random() < 0.8
            else stream[: source.randrange(len(stream))] + _noise(link, source, 9)
        ).hex()
    if bus == "can":
        answer_kind = source.choice(
            ["acknowledge", "refusal"]
            if kind == "telecommand"
            else ["reply", "reply", "request_refusal"]
        )
        data = source.randbytes(min(size, 300)) if answer_kind == "reply" else b""
        packet = source.choice(
            can_split(
                link,
                CanMessage(answer_kind, id, source.choice([1, 1, 1, 2]), 9, data),
            )
            or [None]
        )
        return {"id": packet.id, "bytes": packet.data.hex()}
    if source.random() < 0.15:
        return None
    command = link.bus_exchanges["i2c"].command
    assert command and command.poll
    polled = command.poll
    if kind == "telecommand" and source.random() < 0.6:
        about = bytes([id, source.choice([1, 1, 0]), code, 7])
        id, data = polled.telemetry, about[: link.frames[polled.telemetry]]
    else:
        data = source.randbytes(size if kind == "telemetry" else 0)
    checks = (
        checked and link.checksum is not None and "i2c" in link.checksum.telemetry_buses
    )
    if checks and data and source.random() < 0.9:
        data = i2c_write(link, id, data, crc=True)[1:]
    return data.hex()


def _procedure(facts_of_node: Facts, link: Link, source: random.Random) -> dict:
    """Return a request for a procedure with a device that sometimes behaves
    differently.
    """
    procedure = source.choice(facts_of_node.procedures)
    form = link.procedures[procedure.name]
    request: dict = {"op": "procedure", "name": procedure.name}
    inputs = {}
    for each in form.inputs:
        if each.is_bytes:
            size = source.choice([0, 1, 30, 85, 300])
            request["bytes"] = source.randbytes(size).hex()
        elif not each.is_optional or source.random() < 0.5:
            values = each.values or (0, 1, 5, 60, 90)
            inputs[each.name] = min(source.choice(values), each.most)
    request |= {"inputs": inputs} if inputs else {}
    if not facts_of_node.stream:
        request["bus"] = source.choice(["uart", "uart", "i2c", "can"])
    if source.random() < 0.6:
        request["block"] = source.choice([1, 20, 45, 100])
    return {**request, "script": _played(facts_of_node, link, request, source)}


def _played(
    facts_of_node: Facts, link: Link, request: dict, source: random.Random
) -> list[dict]:
    """Return a script whose events usually match the requests of the procedure."""
    loss = source.choice([0, 0, 0.1, 0.5])
    device = RecordedDevice(facts_of_node, request.get("bus", "uart"), source, loss)
    run = device.counterpart.runs[request["name"]]
    if isinstance(run, BlockReading):
        inputs = request.get("inputs", {})
        key = tuple(inputs.get(name, 0) for name in run.effect.names)
        content = source.randbytes(source.choice([0, 5, 60, 90]))
        device.device.objects.put(run.effect.kind, key, content)
    if isinstance(run, Listing):
        length = facts_of_node.telemetry[link.procedures[request["name"]].entry].length
        run.entries = [source.randbytes(length) for _ in range(source.randrange(5))]
        run.entries += run.entries[-1:] * source.choice([0, 0, 0, 9])
    odd = source.choice([0, 0.02, 0.2])

    def respond(now: int, request: Request) -> list[ClientReport]:
        reports = device.respond(now, request)
        changed = [
            _changed(report, request, source) if source.random() < odd else report
            for report in reports
        ]
        return [
            report._replace(after=source.choice([0, 1, 10, 50, 500]))
            for report in changed
        ]

    script, _ = record(link, request, respond)
    return script[: source.choice([10, 60, 150])]


def _changed(
    report: ClientReport, request: Request, source: random.Random
) -> ClientReport:
    """Return another event in place of the given one."""
    data = bytes.fromhex(report.event.get("bytes", ""))
    if report.event["event"] == "arrived":
        data = source.choice([data[:-1], source.randbytes(len(data)), data + b"\0"])
        return ClientReport({**report.event, "bytes": data.hex()})
    outcomes = ["refused", "timeout", "busy", "damaged", "sent", "done", "done"]
    event: dict = {"event": source.choice(outcomes)}
    if event["event"] == "done":
        event["bytes"] = source.choice(
            [bytes(len(data)), source.randbytes(len(data))]
        ).hex()
    return ClientReport(event)
