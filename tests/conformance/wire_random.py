"""Random requests about the wire layer, such as no vector holds: streams cut anywhere,
packets in any order, long scripts.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from icdgen.icd.model import Icd
from icdgen.protocol import can, facts, i2c, uart
from icdgen.protocol.facts import Facts

MOST_PACKET_GAP_MS = 700


def requests(icd: Icd, count: int, seed: int = 1) -> Iterator[dict]:
    """``count`` requests of each kind for each node that has a protocol."""
    source = random.Random(seed)
    for node in icd.nodes:
        if not icd.protocol_of(node):
            continue
        known = facts.of(icd, node)
        for _ in range(count):
            for make in (stream, _packets, _client, _transfer):
                yield {"node": node.name, **make(known, source)}


def _cut(data: bytes, source: random.Random) -> list[bytes]:
    """The bytes in pieces of any size."""
    cuts = sorted(
        source.randrange(len(data) + 1)
        for _ in range(source.randrange(1 + len(data) // 4))
    )
    return [data[a:b] for a, b in zip([0, *cuts], [*cuts, len(data)], strict=True)]


def _noise(known: Facts, source: random.Random, most: int) -> bytes:
    form = known.framing
    assert form
    marks = [form.escape, form.escape, form.start, form.end, form.escaped]
    return bytes(
        source.choice(marks) if source.random() < 0.6 else source.randrange(256)
        for _ in range(source.randrange(most))
    )


def stream(known: Facts, source: random.Random) -> dict:
    """A stream of messages and noise, cut anywhere."""
    assert known.framing
    stream = b""
    for _ in range(source.randrange(4)):
        message = bytes(
            [source.choice([31, 119, 146, 255, source.randrange(256)])]
        ) + _noise(known, source, 24)
        stream += _noise(known, source, 12) + uart.encode(known.framing, message)
        stream = stream[: -source.randrange(1, 5)] if source.random() < 0.2 else stream
    chunks = [piece.hex() for piece in _cut(stream, source)]
    return {
        "op": "uart_events",
        "chunks": chunks,
        "limit": min(source.choice([1, 2, 8, known.longest]), known.longest),
    }


def _packets(known: Facts, source: random.Random) -> dict:
    rows, now = [], 0
    long = [
        id for id, message in known.telemetry.items() if 8 < message.length < 60
    ] or [200]
    for _ in range(source.randrange(1, 5)):
        id = source.choice([source.choice(long), 3, source.randrange(256)])
        message = can.Message(
            "reply",
            id,
            source.choice([1, 2]),
            source.choice([0, 9]),
            source.randbytes(source.randrange(60)),
        )
        found = can.split(known, message)
        found = [one for one in found if source.random() < 0.95] + source.choices(
            found, k=source.randrange(3)
        )
        if source.random() < 0.5:
            source.shuffle(found)
        rows += [[one.id, one.data] for one in found]
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


def _client(known: Facts, source: random.Random) -> dict:
    bus, checked = source.choice(["uart", "i2c", "can"]), source.random() < 0.5
    now, script = source.choice([0, 0, 1000]), []
    asked: tuple[str, int] = ("telemetry", 128)
    for _ in range(source.randrange(2, 30)):
        now += source.choice([0, 1, 5, 20, 20, 100, 1000])
        row: dict = {"at": now}
        kind = source.random()
        if kind < 0.3:
            if source.random() < 0.5:
                asked = ("telemetry", source.choice([*known.telemetry, 128, 128, 3]))
                row["telemetry"] = asked[1]
            else:
                asked = ("telecommand", source.choice([*known.telecommands, 31, 200]))
                message = known.telecommands.get(asked[1])
                size = (
                    message.length
                    if message and source.random() < 0.95
                    else source.randrange(9)
                )
                row |= {
                    "telecommand": asked[1],
                    "bytes": source.randbytes(size).hex(),
                    "repeat": source.random() < 0.5,
                }
        elif kind < 0.85:
            row["receive"] = _heard(known, bus, checked, asked, source)
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
    known: Facts, bus: str, checked: bool, asked: tuple[str, int], source: random.Random
) -> object:
    kind, id = asked
    message = (known.telecommands if kind == "telecommand" else known.telemetry).get(id)
    size = message.length if message and source.random() < 0.9 else source.randrange(12)
    code = source.choice([0, 0, 1, 4, 4, 9])
    if bus == "uart":
        assert known.framing
        answer = (
            bytes([id, code])
            if kind == "telecommand"
            else bytes([id]) + source.randbytes(size)
        )
        if source.random() < 0.1:
            answer = bytes([119]) + source.randbytes(22)
        stream = uart.encode(known.framing, answer) * source.choice([1, 1, 2, 3])
        return (
            stream
            if source.random() < 0.8
            else stream[: source.randrange(len(stream))] + _noise(known, source, 9)
        ).hex()
    if bus == "can":
        answer_kind = source.choice(
            ["acknowledge", "refusal"]
            if kind == "telecommand"
            else ["reply", "reply", "request_refusal"]
        )
        data = source.randbytes(min(size, 300)) if answer_kind == "reply" else b""
        found = source.choice(
            can.split(
                known,
                can.Message(answer_kind, id, source.choice([1, 1, 1, 2]), 9, data),
            )
            or [None]
        )
        return {"id": found.id, "bytes": found.data.hex()}
    if source.random() < 0.15:
        return None
    polled = known.polled
    assert polled
    if kind == "telecommand" and source.random() < 0.6:
        id, data = (
            polled.message.ids[0],
            bytes([id, source.choice([1, 1, 0]), code, 7])[: polled.message.length],
        )
    else:
        data = source.randbytes(size if kind == "telemetry" else 0)
    checks = (
        checked
        and known.checksum is not None
        and "i2c" in known.checksum.telemetry_buses
    )
    if checks and data and source.random() < 0.9:
        data += bytes([i2c.checksum(known, id, data)])
    return data.hex()


def _transfer(known: Facts, source: random.Random) -> dict:
    uploads = ["upload", "upload"] if known.files and known.files.upload else []
    operations = (
        ["program_copy", "program_information"]
        if known.program_copy and known.program_information
        else []
    )
    what = source.choice(
        [
            "list",
            "download",
            "download",
            "download",
            "erase",
            "format",
            *uploads,
            *operations,
        ]
    )
    request: dict = {"op": "file", "do": what}
    if what == "download":
        request |= {
            "bus": source.choice(["uart", "uart", "i2c", "can"]),
            "type": 2,
            "counter": 1,
        }
        request |= source.choice([{}, {"size": source.choice([0, 5, 60, 90])}])
    if what == "upload":
        request |= {
            "destination": 3,
            "bytes": source.randbytes(source.choice([0, 1, 30, 85])).hex(),
        }
    if what in operations:
        request["program"] = source.choice([3, 9])
    if what == "erase":
        request |= {"type": 1, "counter": 2, "all": source.random() < 0.5}
    if source.random() < 0.6:
        request["block"] = source.choice([1, 20, 45])
    return {**request, "script": _played(known, request, source)}


def _played(known: Facts, request: dict, source: random.Random) -> list[dict]:
    """A script whose outcomes fit what the procedure asks for, most of the time."""
    from icdgen.protocol import crc, scripts, transfer

    procedure = scripts.procedure_of(known, request)
    script: list[dict] = []
    now = 0
    content: dict[int, bytes] = {}
    pending: dict | None = None
    loaded = b""
    for _ in range(source.choice([10, 60, 150])):
        now += source.choice([0, 1, 10, 50, 50, 500])
        row: dict = {"at": now}
        chance = source.random()
        packets = (
            isinstance(procedure, transfer.Download) and procedure.count and not pending
        )
        if pending and chance < 0.9:
            row["event"], pending = pending, None
        elif packets and chance < 0.9:
            position = source.choice(
                [n for n in range(procedure.count) if n not in procedure.packets] or [0]
            )
            piece = loaded[position * 20 : position * 20 + 20].ljust(20, b"\xee")
            row["event"] = {
                "event": "packet",
                "number": position + (chance < 0.03),
                "bytes": piece.hex(),
            }
        if "event" in row:
            procedure.event(now, row["event"])
        asked = procedure.next(now)
        script.append(row)
        if asked is None:
            continue
        message = (
            known.telecommands if asked.kind == "telecommand" else known.telemetry
        )[asked.id]
        pending = {"event": source.choice(["done"] * 30 + ["refused", "timeout"])}
        if pending["event"] != "done":
            continue
        data = b""
        if asked.kind == "telemetry":
            data = source.choice(
                [
                    bytes(message.length),
                    source.randbytes(message.length),
                    b"\xff" * message.length,
                ]
            )
            if (
                isinstance(procedure, transfer.Download)
                and message.length == 5
                and source.random() < 0.9
            ):
                want = (
                    procedure.block
                    if procedure.size is None
                    else min(procedure.block, procedure.size - procedure.offset)
                )
                size = (
                    want
                    if procedure.size is not None or source.random() < 0.5
                    else source.randrange(want + 1)
                )
                loaded = content.setdefault(procedure.offset, source.randbytes(size))[
                    :want
                ]
                check = crc.compute(known.crc16, loaded) ^ (source.random() < 0.1)
                data = (
                    bytes([source.choice([1, 1, 0])])
                    + check.to_bytes(2, "little")
                    + len(loaded).to_bytes(2, "little")
                )
            elif (
                isinstance(procedure, transfer.Download)
                and message.length == 22
                and procedure.count
            ):
                position = source.randrange(procedure.count)
                data = position.to_bytes(2, "little") + loaded[
                    position * 20 : position * 20 + 20
                ].ljust(20, b"\xee")
            elif (
                isinstance(procedure, transfer.Upload)
                and message.length == 2
                and source.random() < 0.8
            ):
                block = procedure.data[
                    procedure.sent : procedure.sent + procedure.block
                ]
                filled = block.ljust(-(-len(block) // 20) * 20, b"\xff")
                data = crc.compute(known.crc16, filled).to_bytes(2, "little")
        pending["bytes"] = data.hex()
    return script
