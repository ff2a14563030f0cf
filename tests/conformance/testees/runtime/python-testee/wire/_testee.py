"""What the testee answers about the wire layer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .._errors import LengthError, RangeError, UnknownIdError
from . import _testee_scripts
from ._testee_link import (
    Refusal,
    flag,
    hex_bytes,
    link_of,
    mappings,
    number,
    octets,
    rows,
    text,
)
from .can import CanJoiner, CanMessage, CanPacket, can_split
from .crc import crc8, crc16
from .errors import ChecksumError, TooLongError, UnsupportedError, need
from .files import HoleMap, IndexEntry, read_index, write_index
from .i2c import i2c_read_length, i2c_reply, i2c_write
from .identity import identify
from .logs import LogMessage, LogReader, LogWriter
from .times import DosTime, dos_time_pack, dos_time_unpack
from .uart import UartDecoder, uart_encode, uart_kind

if TYPE_CHECKING:
    from collections.abc import Callable

    from .can import CanEvent
    from .link import CanKind, Link
    from .logs import LogFrame

    Answer = dict[str, Any]
    Request = dict[str, Any]

_CAN_BYTES = 8  # of a classic CAN frame
_KINDS: dict[str, CanKind] = {
    "telecommand": "telecommand",
    "acknowledge": "acknowledge",
    "refusal": "refusal",
    "request": "request",
    "reply": "reply",
    "request_refusal": "request_refusal",
}


def answer(request: Request) -> Answer:
    """The answer to a request whose ``op`` is one of `OPERATIONS`."""
    try:
        return {"ok": True, **OPERATIONS[request["op"]](link_of(request), request)}
    except Refusal as refusal:
        return refusal.answer
    except UnsupportedError:
        return {"ok": False, "error": "unsupported"}
    except UnknownIdError:
        return {"ok": False, "error": "unknown-id"}
    except LengthError as error:
        return _counted("length", error)
    except TooLongError as error:
        return _counted("too-long", error)
    except ChecksumError as error:
        return _counted("checksum", error)
    except RangeError as error:
        field = {"field": error.field} if request["op"] == "dos_time" else {}
        return {"ok": False, "error": "range", **field}


def _counted(name: str, error: LengthError | TooLongError | ChecksumError) -> Answer:
    counts = {"expected": error.expected, "actual": error.actual}
    return {"ok": False, "error": name, **counts}


def _crc8(link: Link, request: Request) -> Answer:
    return {"crc": crc8(link, octets(request))}


def _crc16(link: Link, request: Request) -> Answer:
    return {"crc": crc16(link, octets(request))}


def _uart_encode(link: Link, request: Request) -> Answer:
    return {"bytes": uart_encode(link, octets(request)).hex()}


def _uart_decode(link: Link, request: Request) -> Answer:
    stream = octets(request)
    found = UartDecoder(link).feed(stream)
    return {"frames": [one.message.hex() for one in found if one.event == "message"]}


def _uart_events(link: Link, request: Request) -> Answer:
    limit = number(request, "limit", 1, link.longest, link.longest)
    chunks = [hex_bytes(chunk) for chunk in rows(request, "chunks")]
    decoder = UartDecoder(link, limit)
    events: list[Answer] = []
    for chunk in chunks:
        for found in decoder.feed(chunk):
            event: Answer = {"event": found.event}
            if found.event == "message":
                event["kind"] = uart_kind(link, found.message)
                event["bytes"] = found.message.hex()
            events.append(event)
    counts = {"discarded": decoder.discarded, "pending": decoder.pending}
    return {"events": events, **counts}


def _can_split(link: Link, request: Request) -> Answer:
    name, data = text(request, "kind"), octets(request)
    if name not in _KINDS:
        raise Refusal("request")
    kind = _KINDS[name]
    keys = ("id", "source", "destination")
    id, source, destination = (number(request, key, 0, 255) for key in keys)
    packets = can_split(link, CanMessage(kind, id, source, destination, data))
    return {"packets": [{"id": one.id, "bytes": one.data.hex()} for one in packets]}


def _can_join(link: Link, request: Request) -> Answer:
    address = number(request, "address", 0, 255) if "address" in request else None
    senders = number(request, "senders", 1, 16, 4)
    packets = []
    for row in mappings(request, "packets"):
        packet = CanPacket(number(row, "id", 0, (1 << 29) - 1), octets(row))
        if len(packet.data) > _CAN_BYTES:
            raise Refusal("request")
        packets.append((number(row, "at", default=0), packet))
    joiner = CanJoiner(link, address, senders)
    events = [event for at, packet in packets for event in joiner.feed(at, packet)]
    if "end" in request:
        events += joiner.expire(number(request, "end"))
    return {"events": [_can_event(event) for event in events]}


def _can_event(event: CanEvent) -> Answer:
    row: Answer = {"event": event.event, "id": event.id, "source": event.source}
    if event.message:
        row["kind"] = event.message.kind
        row["destination"] = event.message.destination
        row["bytes"] = event.message.data.hex()
    if event.event == "incomplete":
        row["missing"] = event.missing
    return row


def _i2c_request(link: Link, request: Request) -> Answer:
    kind, id = text(request, "kind"), number(request, "id", 0, 255)
    crc = flag(request, "crc")
    if kind == "telemetry":
        read = i2c_read_length(link, id, crc)
        return {"write": i2c_write(link, id).hex(), "read": read}
    if kind != "telecommand":
        raise Refusal("request")
    return {"write": i2c_write(link, id, octets(request), crc).hex(), "read": 0}


def _i2c_reply(link: Link, request: Request) -> Answer:
    id, data, crc = number(request, "id", 0, 255), octets(request), flag(request, "crc")
    return {"bytes": i2c_reply(link, id, data, crc).hex()}


def _log_decode(link: Link, request: Request) -> Answer:
    data = octets(request)
    reader = LogReader(link)
    entries = [
        {
            "seconds": entry.seconds,
            "milliseconds": entry.milliseconds,
            "frames": [_log_frame(frame) for frame in entry.frames],
        }
        for entry in reader.feed(data)
    ]
    mask = None if reader.mask is None else reader.mask.hex()
    return {"mask": mask, "entries": entries, "truncated": reader.truncated}


def _log_frame(frame: LogFrame) -> Answer:
    return {"bit": frame.bit, "id": frame.id, "bytes": frame.data.hex()}


def _log_encode(link: Link, request: Request) -> Answer:
    entries = []
    for row in mappings(request, "entries"):
        seconds, part = number(row, "seconds"), number(row, "milliseconds", 0, 65535)
        frames = [hex_bytes(frame) for frame in rows(row, "frames")]
        entries.append((seconds, part, frames))
    writer = LogWriter(link, octets(request, "mask"))
    out = writer.header() + b"".join(writer.entry(*entry) for entry in entries)
    return {"bytes": out.hex()}


def _log_message_decode(link: Link, request: Request) -> Answer:
    log = LogMessage.decode(link, octets(request))
    return {"mask": log.mask.hex(), "frames": [_log_frame(one) for one in log.frames]}


def _log_message_encode(link: Link, request: Request) -> Answer:
    frames = [hex_bytes(frame) for frame in rows(request, "frames")]
    mask = octets(request, "mask")
    return {"bytes": LogMessage.encode(link, mask, frames).hex()}


def _dos_time(link: Link, request: Request) -> Answer:
    if "value" in request:
        time = dos_time_unpack(link, number(request, "value"))
        return {**time._asdict(), "valid": time.is_valid}
    parts = [number(request, name, 0, 9999) for name in DosTime._fields]
    return {"value": dos_time_pack(link, DosTime(*parts))}


def _hole_map(link: Link, request: Request) -> Answer:
    packets = number(request, "packets")
    if "bytes" in request:
        found = HoleMap.from_bytes(link, packets, octets(request))
        return {"missing": found.missing()}
    received = rows(request, "received")
    if any(type(one) is not int for one in received):
        raise Refusal("request")
    made = HoleMap(link, packets, received)
    return {
        "bytes": made.to_bytes().hex(),
        "messages": [piece.hex() for piece in made.messages()],
        "missing": made.missing(),
    }


def _index_decode(link: Link, request: Request) -> Answer:
    entries, truncated = read_index(link, octets(request))
    shown = [{**entry._asdict(), "meta": entry.meta.hex()} for entry in entries]
    return {"entries": shown, "truncated": truncated}


def _index_encode(link: Link, request: Request) -> Answer:
    entries = []
    for row in mappings(request, "entries"):
        numbers = {name: number(row, name) for name in IndexEntry._fields[:-1]}
        entries.append(IndexEntry(**numbers, meta=octets(row, "meta")))
    return {"bytes": write_index(link, entries).hex()}


def _identify(link: Link, request: Request) -> Answer:
    data = octets(request)
    need(link.identification, "identification")
    return identify(link, data)._asdict()


OPERATIONS: dict[str, Callable[[Link, Request], Answer]] = {
    "crc8": _crc8,
    "crc16": _crc16,
    "uart_encode": _uart_encode,
    "uart_decode": _uart_decode,
    "uart_events": _uart_events,
    "can_split": _can_split,
    "can_join": _can_join,
    "i2c_request": _i2c_request,
    "i2c_reply": _i2c_reply,
    "log_decode": _log_decode,
    "log_encode": _log_encode,
    "log_message_decode": _log_message_decode,
    "log_message_encode": _log_message_encode,
    "dos_time": _dos_time,
    "hole_map": _hole_map,
    "index_decode": _index_decode,
    "index_encode": _index_encode,
    "identify": _identify,
    "client": _testee_scripts.client,
    "file": _testee_scripts.file,
}
