"""JSON requests and responses of the protocol, as used by golden vectors and
conformance tests.

``tests/conformance/README.md`` describes them. `answer` is the reference implementation
of all but framed links, whose reference is the runtime
(`icdgen.runtime_objects.reference`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from icdgen import codec
from icdgen.icd.model import Icd
from icdgen.protocol import (
    can,
    crc,
    errors,
    files,
    i2c,
    logs,
    scripts,
    times,
    uart,
)
from icdgen.protocol.facts import Facts, Unsupported, need, of
from icdgen.protocol.request_keys import (
    Refusal,
    Request,
    flag,
    mappings,
    number,
    octets,
    rows,
    text,
)
from icdgen.protocol.request_keys import hex_bytes as _hex
from icdgen.protocol.sections import CAN_KINDS

CAN_BYTES = 8  # of a classic CAN frame


Operation = Callable[[Facts, Request], dict[str, Any]]


def answer(
    icd: Icd, request: Request, operations: Mapping[str, Operation] | None = None
) -> dict[str, Any]:
    """Return the response to a request.

    ``op`` must be one of `OPS`, or of ``operations``.
    """
    operation = (operations or OPS)[request["op"]]
    try:
        return {"ok": True, **operation(_facts(icd, request), request)}
    except errors.Refused as refusal:
        return refusal.answer
    except errors.RangeError as error:
        # Only the operation with a time defines which field a range error names;
        # elsewhere it would be an implementation detail.
        return {"ok": False, "error": "range"} | (
            {"field": error.field} if error.field in times.PARTS else {}
        )
    except OverflowError:
        return {"ok": False, "error": "range"}


def _facts(icd: Icd, request: Request) -> Facts:
    """Return the facts of the node in the request, by default of the last node with a
    protocol section.
    """
    if "node" in request:
        name = text(request, "node")
        if name not in {node.name for node in icd.nodes}:
            raise Refusal("unknown-node")
        return of(icd, icd.node(name))
    for node in reversed(icd.nodes):
        if icd.protocol_of(node):
            return of(icd, node)
    raise Unsupported("no node has a protocol")


def crc8(facts: Facts, request: Request) -> dict[str, Any]:
    data = octets(request)
    return {"crc": crc.compute(need(facts.checksum, "crc8").crc, data)}


def crc16(facts: Facts, request: Request) -> dict[str, Any]:
    data = octets(request)
    return {"crc": crc.compute(need(facts.crc16, "crc16"), data)}


def uart_encode(facts: Facts, request: Request) -> dict[str, Any]:
    message, framing = octets(request), need(facts.framing, "uart")
    if not message:
        raise errors.LengthError(1, 0)
    return {"bytes": uart.encode(framing, message).hex()}


def uart_decode(facts: Facts, request: Request) -> dict[str, Any]:
    stream = octets(request)
    events = uart.Decoder(need(facts.framing, "uart"), facts.longest).feed(stream)
    return {
        "frames": [
            event.message.hex() for event in events if event.event == uart.MESSAGE
        ]
    }


def uart_events(facts: Facts, request: Request) -> dict[str, Any]:
    limit = number(request, "limit", 1, facts.longest, facts.longest)
    chunks = [_hex(chunk) for chunk in rows(request, "chunks")]
    decoder = uart.Decoder(need(facts.framing, "uart"), limit)
    events = []
    for chunk in chunks:
        for event in decoder.feed(chunk):
            row: dict[str, Any] = {"event": event.event}
            if event.event == uart.MESSAGE:
                row.update(
                    kind=uart.kind(facts, event.message), bytes=event.message.hex()
                )
            events.append(row)
    return {
        "events": events,
        "discarded": decoder.discarded,
        "pending": decoder.pending,
    }


def can_split(facts: Facts, request: Request) -> dict[str, Any]:
    packets = can.split(facts, _message(request))
    return {
        "packets": [{"id": packet.id, "bytes": packet.data.hex()} for packet in packets]
    }


def _message(request: Request) -> can.Message:
    kind, data = text(request, "kind"), octets(request)
    if kind not in CAN_KINDS:
        raise Refusal("request", detail="there is no such kind")
    id, source, destination = (
        number(request, key, 0, 255) for key in ("id", "source", "destination")
    )
    return can.Message(kind, id, source, destination, data)


def can_join(facts: Facts, request: Request) -> dict[str, Any]:
    address = number(request, "address", 0, 255) if "address" in request else None
    senders, packets = number(request, "senders", 1, 16, 4), []
    for row in mappings(request, "packets"):
        packet = can.Packet(number(row, "id", 0, (1 << 29) - 1), octets(row))
        if len(packet.data) > CAN_BYTES:
            raise Refusal("request", detail="a packet has too many bytes")
        packets.append((number(row, "at", default=0), packet))
    joiner = can.Joiner(facts, address, senders)
    events = [event for at, packet in packets for event in joiner.feed(at, packet)]
    if "end" in request:
        events += joiner.expire(number(request, "end"))
    return {"events": [_can_event(event) for event in events]}


def _can_event(event: can.Event) -> dict[str, Any]:
    row: dict[str, Any] = {"event": event.event, "id": event.id, "source": event.source}
    if event.message:
        row.update(
            kind=event.message.kind,
            destination=event.message.destination,
            bytes=event.message.data.hex(),
        )
    if event.event == can.INCOMPLETE:
        row["missing"] = event.missing
    return row


def i2c_request(facts: Facts, request: Request) -> dict[str, Any]:
    kind, id, checked = (
        text(request, "kind"),
        number(request, "id", 0, 255),
        flag(request, "crc"),
    )
    if kind == "telemetry":
        if id not in facts.telemetry:
            raise errors.UnknownIdError
        return {
            "write": bytes([id]).hex(),
            "read": i2c.read_length(facts, facts.telemetry[id], checked),
        }
    if kind != "telecommand":
        raise Refusal("request", detail="there is no such kind")
    return {
        "write": i2c.telecommand(facts, id, octets(request), checked).hex(),
        "read": 0,
    }


def i2c_reply(facts: Facts, request: Request) -> dict[str, Any]:
    id, data, checked = (
        number(request, "id", 0, 255),
        octets(request),
        flag(request, "crc"),
    )
    if id not in facts.telemetry:
        raise errors.UnknownIdError
    return {"bytes": i2c.reply(facts, id, data, checked).hex()}


def log_decode(facts: Facts, request: Request) -> dict[str, Any]:
    log = logs.decode(facts, octets(request))
    entries = [
        {**e._asdict(), "frames": [_frame(f) for f in e.frames]} for e in log.entries
    ]
    return {
        "mask": None if log.mask is None else log.mask.hex(),
        "entries": entries,
        "truncated": log.truncated,
    }


def _frame(frame: logs.Frame) -> dict[str, Any]:
    return {"bit": frame.bit, "id": frame.id, "bytes": frame.data.hex()}


def _log_entry(entry: Request) -> tuple[int, int, list[bytes]]:
    """Return seconds, milliseconds and frames of an entry."""
    return (
        number(entry, "seconds"),
        number(entry, "milliseconds", 0, 65535),
        [_hex(frame) for frame in rows(entry, "frames")],
    )


def log_encode(facts: Facts, request: Request) -> dict[str, Any]:
    entries = [_log_entry(entry) for entry in mappings(request, "entries")]
    return {"bytes": logs.encode(facts, octets(request, "mask"), entries).hex()}


def log_message_decode(facts: Facts, request: Request) -> dict[str, Any]:
    mask, log_frames = logs.decode_message(facts, octets(request))
    return {"mask": mask.hex(), "frames": [_frame(frame) for frame in log_frames]}


def log_message_encode(facts: Facts, request: Request) -> dict[str, Any]:
    data = [_hex(frame) for frame in rows(request, "frames")]
    return {"bytes": logs.encode_message(facts, octets(request, "mask"), data).hex()}


def dos_time(facts: Facts, request: Request) -> dict[str, Any]:
    if "value" in request:
        parts = times.unpack(facts, number(request, "value"))
        return {
            **{name: parts[name] for name in times.PARTS},
            "valid": times.invalid_part(parts) is None,
        }
    return {
        "value": times.pack(
            facts, {name: number(request, name, 0, 9999) for name in times.PARTS}
        )
    }


def hole_map(facts: Facts, request: Request) -> dict[str, Any]:
    packets = number(request, "packets")
    if "bytes" in request:
        map_ = octets(request)
        return {"missing": files.missing(facts, packets, map_)}
    received = rows(request, "received")
    if any(type(item) is not int for item in received):
        raise Refusal("request", detail="`received` holds numbers")
    map_ = files.hole_map(facts, packets, received)
    return {
        "bytes": map_.hex(),
        "messages": [piece.hex() for piece in files.in_messages(facts, map_)],
        "missing": files.missing(facts, packets, map_),
    }


def index_decode(facts: Facts, request: Request) -> dict[str, Any]:
    entries, truncated = files.read_index(facts, octets(request))
    return {
        "entries": [{**e._asdict(), "meta": e.meta.hex()} for e in entries],
        "truncated": truncated,
    }


def index_encode(facts: Facts, request: Request) -> dict[str, Any]:
    entries = []
    for row in mappings(request, "entries"):
        numbers = {key: number(row, key) for key in files.IndexEntry._fields[:-1]}
        entries.append(files.IndexEntry(**numbers, meta=octets(row, "meta")))
    return {"bytes": files.write_index(facts, entries).hex()}


def identify(facts: Facts, request: Request) -> dict[str, Any]:
    data = octets(request)
    step = need(facts.identification, "identification")
    try:
        raw = codec.decode(facts.node, step.message, data)
    except codec.LengthError as error:
        raise errors.LengthError(error.expected, error.actual) from None
    identified = {role: raw[name] for role, name in step.fields.items()}
    # A node type or version that the ICD does not state matches any value.
    expected = {
        "node_type": facts.node.node_type,
        "interface_version": facts.node.interface_version,
    }
    matches = all(expected[role] in (None, identified[role]) for role in expected)
    return {**identified, "matches": matches}


def link_data(facts: Facts, request: Request) -> dict[str, Any]:
    """Return the facts that only user-defined code reads."""
    download = facts.files.download if facts.files else None
    return {
        "boot_ms": facts.boot_ms,
        "log_file_type": facts.log_file.file_type if facts.log_file else None,
        "index_file_type": facts.index.file_type if facts.index else None,
        "index_counter": download.index_counter if download else None,
    }


OPS: dict[str, Operation] = {
    op.__name__: op
    for op in (
        crc8, crc16, uart_encode, uart_decode, uart_events, can_split, can_join, i2c_request, i2c_reply, log_decode,
        log_encode, log_message_decode, log_message_encode, dos_time, hole_map, index_decode, index_encode, identify,
        link_data, scripts.client, scripts.file,
    )
}  # fmt: skip
