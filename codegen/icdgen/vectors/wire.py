"""What the protocol layer is asked: requests made from the protocol facts of a node."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from icdgen.protocol import can, uart
from icdgen.protocol import files as reference
from icdgen.protocol import logs as log_files
from icdgen.protocol.facts import Facts

Requests = Iterator[tuple[str, dict]]

CHECKED = b"123456789"  # what check values of CRCs are computed over


def checksums(known: Facts, source: Random) -> Requests:
    """CRCs of nothing, of single bytes, and of random data."""
    data = [
        ("nothing", b""),
        ("the check value", CHECKED),
        ("a zero", b"\0"),
        ("zeros", bytes(20)),
        ("ones", b"\xff" * 20),
    ]
    data += [(f"bit {bit}", bytes([1 << bit])) for bit in range(8)]
    data += [(f"{size} random bytes", source.randbytes(size)) for size in (2, 7, 22, 255, 1000)]
    for op, there in (("crc8", known.checksum), ("crc16", known.crc16)):
        for why, one in data if there else ():
            yield why, {"op": op, "bytes": one.hex()}


def _messages(known: Facts, source: Random) -> Iterator[tuple[str, bytes]]:
    """Messages as they are framed: id and data."""
    framing = known.framing
    assert framing
    escape, end, start = framing.escape, framing.end, framing.start
    yield "an id alone", b"\x80"
    yield "an id that is the escape byte", bytes([escape, 0])
    yield "nothing but escape bytes", bytes([escape] * 5)
    yield "what looks like an end within the data", bytes([1, escape, escape, end, escape, end, 2])
    yield "what looks like a start within the data", bytes([1, escape, start, 2, escape])
    yield "the markers as data", bytes([end, start, end])
    yield "every byte", bytes([0x90, *range(256)])[: known.longest]
    for id in sorted({min(known.telecommands, default=0), max(known.telecommands, default=0)}):
        yield f"telecommand {id}", bytes([id]) + source.randbytes(known.telecommands[id].length)
    longest = known.longest
    yield "the longest message", bytes([0x80]) + source.randbytes(longest - 1)
    yield "the longest message, all escaped", bytes([escape] * longest)


def encoded(known: Facts, source: Random) -> Requests:
    """Messages on the line, and back."""
    yield "no id", {"op": "uart_encode", "bytes": ""}
    for why, message in _messages(known, source):
        yield why, {"op": "uart_encode", "bytes": message.hex()}
        yield why, {"op": "uart_decode", "bytes": uart.encode(known.framing, message).hex()}


def streams(known: Facts, source: Random) -> Requests:
    """Streams that are cut, noisy, broken off."""
    framing = known.framing
    assert framing
    escape, start, end = framing.escape, framing.start, framing.end
    begin, finish = bytes([escape, start]), bytes([escape, end])

    def line(*data: int) -> bytes:
        return uart.encode(framing, bytes(data))

    good = line(0x90, 1, escape, end, 2)
    whole = [
        ("two messages", good + line(0x91)),
        ("noise before, between and after", b"\x00\xff\x7f" + good + b"noise" + good + b"\x55"),
        ("an escape byte before the start", bytes([escape]) + good),
        ("many escape bytes before the start", bytes([escape] * 5) + good),
        ("an end without a start", finish + good),
        ("a start within a message", begin + b"\x90\x01\x02" + good),
        ("two starts in a row", begin + good),
        ("an escape byte before another byte", begin + bytes([0x90, escape, 0x55, 0x01]) + finish + good),
        ("a message without an id", begin + finish + good),
        ("an escape byte at the very end", good + bytes([escape])),
        ("an escape byte at the very end of a started message", good + begin + bytes([0x90, escape])),
        ("a message that is not finished", good + begin + b"\x90\x01"),
        ("nothing", b""),
        ("random bytes", source.randbytes(600)),
        ("random bytes rich in markers", bytes(source.choices([escape, start, end, 0, 0x90], k=600)) + good),
    ]
    for why, stream in whole:
        yield why, {"op": "uart_decode", "bytes": stream.hex()}
        yield why, {"op": "uart_events", "chunks": [stream.hex()]}
        yield f"{why}, byte by byte", {"op": "uart_events", "chunks": [f"{byte:02x}" for byte in stream]}
        cuts = sorted(source.sample(range(len(stream) + 1), min(5, len(stream))))
        pieces = [stream[a:b].hex() for a, b in zip([0, *cuts], [*cuts, len(stream)], strict=True)]
        yield f"{why}, cut at odd places", {"op": "uart_events", "chunks": pieces}
    long = line(0x90, *range(1, 9), escape)
    for limit in (9, 10):
        yield f"ten bytes in a buffer of {limit}", {
            "op": "uart_events",
            "limit": limit,
            "chunks": [(long + good[:-2]).hex(), finish.hex()],
        }
    too_long = uart.encode(framing, bytes([0x90]) * (known.longest + 1))
    yield "a message that is too long by one", {"op": "uart_events", "chunks": [(too_long + good).hex()]}
    for why, message in _kinds(known, source):
        yield why, {"op": "uart_events", "chunks": [uart.encode(framing, message).hex()]}


def _kinds(known: Facts, source: Random) -> Iterator[tuple[str, bytes]]:
    """Messages of each kind, and such as are none."""
    if known.acknowledge:
        ids = sorted({min(known.telecommands, default=0), known.framing.escape if known.framing else 0})
        for id in ids:
            yield f"the acknowledge of telecommand {id}", bytes([id, *bytes(known.acknowledge.length - 1)])
        yield "an acknowledge that is too long", bytes([ids[0], *bytes(known.acknowledge.length)])
    files = known.files
    if files and "uart" in files.packet_ids:
        size = files.counter_bytes + files.packet_bytes
        for more in (-1, 0, 1):
            yield f"a download packet{('', ' too long', ' too short')[more]}", bytes(
                [files.packet_ids["uart"]]
            ) + source.randbytes(size + more)
    for id, message in list(known.telemetry.items())[:3]:
        yield f"telemetry {id}", bytes([id]) + source.randbytes(message.length)
    if known.log_message and known.mask:
        for mask in _masks(known)[:4]:
            data = [source.randbytes(slot.length) for slot in known.mask.selected(mask)]
            message = log_files.encode_message(known, mask, data)
            yield "an unsolicited log", message
            yield "an unsolicited log that is too short", message[:-1]


def packets(known: Facts, source: Random) -> Requests:
    """Messages split into packets, and put together from whatever arrives."""
    form = known.can
    assert form
    node, other, third = form.node_address, 0x42, 0xFE
    samples: list[can.Message] = []
    for kind in can.KINDS:
        ids = known.telecommands if kind in ("telecommand", "acknowledge", "refusal") else known.telemetry
        if kind not in form.types:
            continue
        if kind not in can.WITH_DATA:
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
        yield "data where there are none", {"op": "can_split", **about, "kind": "request", "bytes": "00"}
        yield from _joins(known, source, other, third)


def _row(packet: can.Packet, at: int = 0) -> dict:
    return (
        {"at": at, "id": packet.id, "bytes": packet.data.hex()} if at else {"id": packet.id, "bytes": packet.data.hex()}
    )


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
    for why, packets in rows:
        yield why, {"op": "can_join", "packets": [_row(packet) for packet in packets], "end": late}
    yield "nobody is there for them", {"op": "can_join", "address": node ^ 1, "packets": [_row(p) for p in one]}
    paused = [_row(packet, at) for packet, at in zip(one, [late - 1] * len(one), strict=True)]
    yield "a pause just short enough", {"op": "can_join", "packets": [_row(one[0]), *paused[1:]]}
    paused = [_row(packet, late) for packet in one]
    yield "a pause that is too long", {"op": "can_join", "packets": [_row(one[0]), *paused]}
    crowd = [sent(sender, str(sender)) for sender in range(5)]
    turns = [packet for turn in zip(*crowd, strict=True) for packet in turn]
    for senders in (4, 5):
        yield f"five senders, room for {senders}", {
            "op": "can_join",
            "senders": senders,
            "packets": [_row(p) for p in turns],
        }
    yield "one after the other, room for one", {
        "op": "can_join",
        "senders": 1,
        "packets": [_row(p) for p in (*one, *foreign)],
    }


def i2c(known: Facts, source: Random) -> Requests:
    """What is written and read, with and without a checksum."""
    for id, message in list(known.telecommands.items())[:5]:
        for checked in (False, True) if known.checksum else (False,):
            data = source.randbytes(message.length)
            yield f"telecommand {id}", {
                "op": "i2c_request",
                "kind": "telecommand",
                "id": id,
                "bytes": data.hex(),
                "crc": checked,
            }
    for id, message in list(known.telemetry.items())[:3]:
        frame = source.randbytes(message.length)
        for checked in (False, True) if known.checksum else (False,):
            yield f"telemetry {id}", {"op": "i2c_request", "kind": "telemetry", "id": id, "crc": checked}
            from icdgen.protocol.i2c import telecommand

            data = telecommand(known, id, frame, checked)[1:]
            about = {"op": "i2c_reply", "id": id, "crc": checked}
            yield f"telemetry {id}", {**about, "bytes": data.hex()}
            yield f"telemetry {id}, too short", {**about, "bytes": data[:-1].hex()}
            yield f"telemetry {id}, one bit wrong", {**about, "bytes": (bytes([data[0] ^ 1]) + data[1:]).hex()}
    step = known.identification
    if step:
        for change in range(2):
            frame = bytes([(known.node.node_type or 0) + change, known.node.interface_version or 0])
            yield "who the node is", {"op": "identify", "bytes": frame.ljust(step.message.length, b"\0").hex()}
        yield "a frame that is too short", {"op": "identify", "bytes": "00"}


def _masks(known: Facts) -> list[bytes]:
    layout = known.mask
    assert layout
    none = bytes(layout.size)
    masks = [none]
    masks += [(1 << bit).to_bytes(layout.size, "little") for bit in sorted(layout.bits)[::7]]
    short = [bit for bit, row in layout.bits.items() if row.length < layout.slot_bytes]
    free = [bit for bit in range(layout.size * 8) if bit not in layout.bits]
    masks += [(1 << bit).to_bytes(layout.size, "little") for bit in (*short, *free[:1], *free[-1:])]
    some = sum(1 << bit for bit in (*sorted(layout.bits)[1:20:3], *short, *free[:1]))
    return [*masks, some.to_bytes(layout.size, "little"), b"\xff" * layout.size]


def logs(known: Facts, source: Random) -> Requests:
    """Log files and unsolicited logs, whole and truncated."""
    layout = known.mask
    if not layout:
        return
    for mask in _masks(known):
        slots = layout.selected(mask)
        data = [[source.randbytes(slot.length) for slot in slots] for _ in range(2)]
        if known.log_file:
            times = [(0, 0), (0xFFFFFFFF, 999)]
            entries = [
                {"seconds": s, "milliseconds": ms, "frames": [f.hex() for f in one]}
                for (s, ms), one in zip(times, data, strict=True)
            ]
            file = log_files.encode(known, mask, [(s, ms, one) for (s, ms), one in zip(times, data, strict=True)])
            yield "two entries", {"op": "log_encode", "mask": mask.hex(), "entries": entries}
            for size in sorted({0, len(mask) - 1, len(mask), len(mask) + 1, len(file) - 1, len(file)}):
                yield f"{size} of {len(file)} bytes", {"op": "log_decode", "bytes": file[:size].hex()}
        if known.log_message:
            message = log_files.encode_message(known, mask, data[0])
            yield "an unsolicited log", {
                "op": "log_message_encode",
                "mask": mask.hex(),
                "frames": [f.hex() for f in data[0]],
            }
            for size in (len(message), len(message) - 1, 3):
                yield f"{size} of {len(message)} bytes", {"op": "log_message_decode", "bytes": message[:size].hex()}
    one = (1 << min(layout.bits, default=0)).to_bytes(layout.size, "little").hex()
    wrong = [
        ("a frame too few", []),
        ("a frame too many", ["00" * layout.slot_bytes] * 2),
        ("a frame too short", ["00"]),
    ]
    for why, data_ in wrong:
        yield why, {"op": "log_encode", "mask": one, "entries": [{"seconds": 1, "milliseconds": 2, "frames": data_}]}
    yield "a mask that is too short", {"op": "log_encode", "mask": "01", "entries": []}


def files(known: Facts, source: Random) -> Requests:
    """Packed times, hole maps, the index file."""
    if known.time:
        for value in (
            0,
            0xFFFFFFFF,
            0x00210000,
            *(1 << bit for bit in range(32)),
            *(source.getrandbits(32) for _ in range(20)),
        ):
            yield f"{value:08x}", {"op": "dos_time", "value": value}
        dates = [
            (1980, 1, 1, 0, 0, 0), (2000, 2, 29, 12, 30, 31), (2020, 11, 3, 23, 59, 59), (2107, 12, 31, 23, 59, 58),
            (1979, 12, 31, 0, 0, 0), (2108, 1, 1, 0, 0, 0), (2100, 2, 29, 0, 0, 0), (2021, 4, 31, 0, 0, 0),
            (2021, 0, 1, 0, 0, 0), (2021, 13, 1, 0, 0, 0), (2021, 1, 0, 0, 0, 0), (2021, 1, 1, 24, 0, 0),
            (2021, 1, 1, 0, 60, 0), (2021, 1, 1, 0, 0, 60),
        ]  # fmt: skip
        for date in dates:
            yield "a date", {
                "op": "dos_time",
                **dict(zip(("year", "month", "day", "hour", "minute", "second"), date, strict=True)),
            }
    if known.hole_map and known.files:
        most, first = known.hole_map.bytes * 8, known.files.first_packet
        for count in (0, 1, 3, 8, 9, most - 1, most):
            every = range(first, first + count)
            for received in ([], list(every), [n for n in every if n % 3], source.sample(every, count // 2)):
                yield f"{count} packets", {"op": "hole_map", "packets": count, "received": received}
        yield "too many packets", {"op": "hole_map", "packets": most + 1, "received": []}
        yield "a packet beyond the end", {"op": "hole_map", "packets": 3, "received": [first + 3]}
        for count in (0, 5, most):
            yield "any map", {"op": "hole_map", "packets": count, "bytes": source.randbytes(known.hole_map.bytes).hex()}
        yield "a map that is too short", {"op": "hole_map", "packets": 1, "bytes": "00"}
    if known.index:
        index = known.index
        entries = []
        for _ in range(3):
            sizes = {role: place.bytes for role, place in index.fields.items()}
            entries.append(
                {r: source.randbytes(n).hex() if r == "meta" else source.getrandbits(8 * n) for r, n in sizes.items()}
            )
        made = [reference.IndexEntry(**{**e, "meta": bytes.fromhex(e["meta"])}) for e in entries]
        data = reference.index_encode(known, made)
        yield "three entries", {"op": "index_encode", "entries": entries}
        for size in (0, 1, index.entry_bytes, len(data) - 1, len(data)):
            yield f"{size} of {len(data)} bytes", {"op": "index_decode", "bytes": data[:size].hex()}
        yield "meta-data that are too short", {"op": "index_encode", "entries": [{**entries[0], "meta": "00"}]}
        yield "a number that does not fit", {"op": "index_encode", "entries": [{**entries[0], "counter": 256}]}
