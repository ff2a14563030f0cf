"""JSON requests on parts of a link: checksums, framing, packets, logs and index files.

``tests/conformance/README.md`` describes the requests and their responses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, cast, get_args

from icdgen_runtime._errors import LengthError, RangeError
from icdgen_runtime.wire import checks, stream
from icdgen_runtime.wire.can import CanEvent, CanJoiner, CanMessage, CanPacket
from icdgen_runtime.wire.can import can_split as split
from icdgen_runtime.wire.errors import need
from icdgen_runtime.wire.files import IndexEntry, read_index, write_index
from icdgen_runtime.wire.i2c import i2c_read_length, i2c_write
from icdgen_runtime.wire.i2c import i2c_reply as frame_of_reply
from icdgen_runtime.wire.identity import identify as identity_of
from icdgen_runtime.wire.link import CanKind, Link
from icdgen_runtime.wire.logs import LogFrame, LogMessage, LogReader, LogWriter
from icdgen_runtime.wire.packet_formats import Verdict
from icdgen_runtime.wire.sender import Sender
from icdgen_runtime.wire.times import DosTime, dos_time_pack, dos_time_unpack
from icdgen_runtime.wire.uart import UartDecoder, uart_kind
from icdgen_runtime.wire.uart import uart_encode as line_of

from icdgen.icd.responses import KINDS
from icdgen.protocol.packet_formats import DIRECTIONS, GIVEN
from icdgen.runtime_objects.refusals import Refusal, naming_the_field
from icdgen.runtime_objects.request_keys import (
    Request,
    choice,
    flag,
    hex_bytes,
    mappings,
    number,
    octets,
    rows,
    text,
)

VERDICTS: tuple[Verdict, ...] = cast(tuple[Verdict, ...], KINDS)
ANSWERED = ("message", "request", "unknown_id", "length", "checksum")
"""Events of a decoder of telecommands that a device can respond to."""
CAN_BYTES = 8  # of a classic CAN frame
CAN_KINDS: tuple[CanKind, ...] = get_args(CanKind)

AnyLink = Link[Any]
Response = dict[str, Any]
Operation = Callable[[AnyLink, Request], Response]


def checksum(link: AnyLink, request: Request) -> Response:
    name = text(request, "name")
    return {"crc": checks.checksum(link, name, octets(request))}


def uart_encode(link: AnyLink, request: Request) -> Response:
    return {"bytes": line_of(link, octets(request)).hex()}


def uart_decode(link: AnyLink, request: Request) -> Response:
    data = octets(request)
    events = UartDecoder(link).feed(data)
    messages = [event.message for event in events if event.event == "message"]
    return {"frames": [message.hex() for message in messages]}


def uart_events(link: AnyLink, request: Request) -> Response:
    limit = number(request, "limit", 1, link.longest, link.longest)
    chunks = [hex_bytes(chunk) for chunk in rows(request, "chunks")]
    decoder = UartDecoder(link, limit)
    events = []
    for chunk in chunks:
        for event in decoder.feed(chunk):
            row: Response = {"event": event.event}
            if event.event == "message":
                row["kind"] = uart_kind(link, event.message)
                row["bytes"] = event.message.hex()
            events.append(row)
    return {
        "events": events,
        "discarded": decoder.discarded,
        "pending": decoder.pending,
    }


def can_split(link: AnyLink, request: Request) -> Response:
    kind, data = choice(request, "kind", CAN_KINDS), octets(request)
    id, source, destination = (
        number(request, key, 0, 255) for key in ("id", "source", "destination")
    )
    packets = split(link, CanMessage(kind, id, source, destination, data))
    rows_of_packets = [{"id": each.id, "bytes": each.data.hex()} for each in packets]
    return {"packets": rows_of_packets}


def can_packet(row: Request) -> CanPacket:
    """Return the CAN packet of a row."""
    # Extended identifiers of CAN have 29 bits (ISO 11898-1).
    return CanPacket(number(row, "id", 0, (1 << 29) - 1), octets(row))


def can_join(link: AnyLink, request: Request) -> Response:
    address = number(request, "address", 0, 255) if "address" in request else None
    senders, packets = number(request, "senders", 1, 16, 4), []
    for row in mappings(request, "packets"):
        packet = can_packet(row)
        if len(packet.data) > CAN_BYTES:
            raise Refusal("request", detail="a packet has too many bytes")
        packets.append((number(row, "at", default=0), packet))
    joiner = CanJoiner(link, address, senders)
    events = [event for at, packet in packets for event in joiner.feed(at, packet)]
    if "end" in request:
        events += joiner.expire(number(request, "end"))
    return {"events": [_can_event(event) for event in events]}


def _can_event(event: CanEvent) -> Response:
    row: Response = {"event": event.event, "id": event.id, "source": event.source}
    if event.message:
        row["kind"] = event.message.kind
        row["destination"] = event.message.destination
        row["bytes"] = event.message.data.hex()
    if event.event == "incomplete":
        row["missing"] = event.missing
    return row


def i2c_request(link: AnyLink, request: Request) -> Response:
    kind = choice(request, "kind", DIRECTIONS)
    id, checked = number(request, "id", 0, 255), flag(request, "crc")
    if kind == "telemetry":
        read = i2c_read_length(link, id, checked)
        return {"write": i2c_write(link, id).hex(), "read": read}
    written = i2c_write(link, id, octets(request), checked)
    return {"write": written.hex(), "read": 0}


def i2c_reply(link: AnyLink, request: Request) -> Response:
    id, checked = number(request, "id", 0, 255), flag(request, "crc")
    return {"bytes": frame_of_reply(link, id, octets(request), checked).hex()}


def log_decode(link: AnyLink, request: Request) -> Response:
    data = octets(request)
    reader = LogReader(link)
    entries = [
        {**entry._asdict(), "frames": _frames(entry.frames)}
        for entry in reader.feed(data)
    ]
    mask = None if reader.mask is None else reader.mask.hex()
    return {"mask": mask, "entries": entries, "truncated": reader.truncated}


def _frames(frames: Iterable[LogFrame]) -> list[Response]:
    return [
        {"bit": frame.bit, "id": frame.id, "bytes": frame.data.hex()}
        for frame in frames
    ]


def log_encode(link: AnyLink, request: Request) -> Response:
    entries = [_log_entry(entry) for entry in mappings(request, "entries")]
    writer = LogWriter(link, octets(request, "mask"))
    log = writer.header() + b"".join(writer.entry(*entry) for entry in entries)
    return {"bytes": log.hex()}


def _log_entry(entry: Request) -> tuple[int, int, list[bytes]]:
    """Return seconds, milliseconds and frames of an entry."""
    frames = [hex_bytes(frame) for frame in rows(entry, "frames")]
    seconds = number(entry, "seconds")
    return seconds, number(entry, "milliseconds", 0, 65535), frames


def log_message_decode(link: AnyLink, request: Request) -> Response:
    log = LogMessage.decode(link, octets(request))
    return {"mask": log.mask.hex(), "frames": _frames(log.frames)}


def log_message_encode(link: AnyLink, request: Request) -> Response:
    frames = [hex_bytes(frame) for frame in rows(request, "frames")]
    return {"bytes": LogMessage.encode(link, octets(request, "mask"), frames).hex()}


def dos_time(link: AnyLink, request: Request) -> Response:
    if "value" in request:
        time = dos_time_unpack(link, number(request, "value"))
        return {**time._asdict(), "valid": time.is_valid}
    parts = {name: number(request, name, 0, 9999) for name in DosTime._fields}
    with naming_the_field():
        return {"value": dos_time_pack(link, DosTime(**parts))}


def index_decode(link: AnyLink, request: Request) -> Response:
    entries, truncated = read_index(link, octets(request))
    return {
        "entries": [{**entry._asdict(), "meta": entry.meta.hex()} for entry in entries],
        "truncated": truncated,
    }


def index_encode(link: AnyLink, request: Request) -> Response:
    entries = []
    for row in mappings(request, "entries"):
        numbers = {key: number(row, key) for key in IndexEntry._fields[:-1]}
        entries.append(IndexEntry(**numbers, meta=octets(row, "meta")))
    return {"bytes": write_index(link, entries).hex()}


def identify(link: AnyLink, request: Request) -> Response:
    return identity_of(link, octets(request))._asdict()


def link_data(link: AnyLink, request: Request) -> Response:
    """Return the facts that only user-defined code reads."""
    return {
        "boot_ms": link.boot_time,
        "log_file_type": link.log_file.file_type if link.log_file else None,
        "index_file_type": link.index_file.file_type if link.index_file else None,
    }


def stream_encode(link: AnyLink, request: Request) -> Response:
    need(link.stream, "stream")
    id, data, chosen = number(request, "id"), octets(request), _chosen(request)
    with naming_the_field():
        if request.get("direction") == "request":
            line = stream.stream_encode_request(link, id, **chosen)
        else:
            line = stream.stream_encode(
                link, id, data, choice(request, "direction", DIRECTIONS), **chosen
            )
    return {"bytes": line.hex()}


def stream_encode_packet(link: AnyLink, request: Request) -> Response:
    need(link.stream, "stream")
    packet, id = number(request, "packet"), number(request, "id")
    direction, chosen = choice(request, "direction", DIRECTIONS), _chosen(request)
    with naming_the_field():
        line = stream.stream_encode_packet(link, packet, id, direction, **chosen)
    return {"bytes": line.hex()}


def _chosen(request: Request) -> dict[str, int]:
    """Return the values of the fields that the sender chooses."""
    values = request.get("values", {})
    if not isinstance(values, dict) or not set(values) <= set(GIVEN):
        raise Refusal(
            "request", detail="`values` has the fields that the sender chooses, by role"
        )
    return {role: number(values, role) for role in values}


def stream_events(link: AnyLink, request: Request) -> Response:
    form = need(link.stream, "stream")
    direction = choice(request, "direction", DIRECTIONS)
    # A decoder must have room for a packet without data.
    least = max(packet.overhead for packet in form.packets)
    limit = number(request, "limit", least, link.longest, link.longest)
    decoder = stream.StreamDecoder(link, direction, limit)
    chunks = [hex_bytes(chunk) for chunk in rows(request, "chunks")]
    events = [_stream_row(event) for chunk in chunks for event in decoder.feed(chunk)]
    return {
        "events": events,
        "discarded": decoder.discarded,
        "pending": decoder.pending,
    }


def stream_respond(link: AnyLink, request: Request) -> Response:
    """Return the responses of a device to a stream of telecommands and requests."""
    need(link.stream, "stream")
    verdict = choice(request, "verdict", VERDICTS)
    reason = number(request, "reason") if "reason" in request else None
    telemetry, chosen = octets(request), _chosen(request)
    sender = Sender(link, "telemetry", chosen)
    decoder = stream.StreamDecoder(link, "telecommand")
    responses: list[Response] = []
    for chunk in rows(request, "chunks"):
        for event in decoder.feed(hex_bytes(chunk)):
            if event.event not in ANSWERED or event.id is None:
                continue
            try:
                line = sender.respond(event, verdict, reason, telemetry)
            except LengthError:
                responses.append({"error": "length"})
            except RangeError:
                responses.append({"error": "range"})
            else:
                response = {"error": "unsupported"}
                if line is not None:
                    response = {"bytes": line.hex()}
                responses.append(response)
    return {"responses": responses}


def _stream_row(event: stream.StreamEvent) -> Response:
    row: Response = {"event": event.event}
    if event.id is not None:
        row["id"] = event.id
    if event.packet is not None:
        row["packet"] = event.packet
    if event.event in ("message", "packet"):
        row["bytes"] = event.data.hex()
    row |= event.values
    if event.event == "gap":
        row["missing"] = event.missing
    return row


OPERATIONS: tuple[Operation, ...] = (
    checksum, uart_encode, uart_decode, uart_events, can_split, can_join, i2c_request, i2c_reply, log_decode,
    log_encode, log_message_decode, log_message_encode, dos_time, index_decode, index_encode, identify,
    link_data, stream_encode, stream_encode_packet, stream_events, stream_respond,
)  # fmt: skip
