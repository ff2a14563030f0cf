"""Answer requests about framing."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

from .._errors import LengthError, RangeError, UnknownIdError
from .._testee_words import (
    Refusal,
    Words,
    counted,
    maybe,
    number,
    numbers,
    octets,
    row,
)
from . import _testee_scripts
from ._testee_scripts import packet
from .can import CanEvent, CanJoiner, CanMessage, can_split
from .checks import checksum
from .errors import ChecksumError, TooLongError, UnsupportedError
from .files import IndexEntry, read_index, write_index
from .i2c import i2c_read_length, i2c_reply, i2c_write
from .identity import identify
from .link import CanKind, Link
from .logs import LogFrame, LogMessage, LogReader, LogWriter
from .packet_formats import CHOSEN_ROLES, Direction, Verdict
from .sender import Sender
from .stream import (
    StreamDecoder,
    StreamEvent,
    stream_encode,
    stream_encode_packet,
    stream_encode_request,
)
from .times import DosTime, dos_time_pack, dos_time_unpack
from .uart import UartDecoder, uart_encode, uart_kind

_KINDS: dict[str, CanKind] = {
    "telecommand": "telecommand",
    "acknowledge": "acknowledge",
    "refusal": "refusal",
    "request": "request",
    "reply": "reply",
    "request_refusal": "request_refusal",
}


def answer(name: str, node: Any, words: Words) -> str:
    """Return the answer to a request about the link of a node."""
    if name not in _OPERATIONS:
        raise Refusal("request")
    try:
        return _OPERATIONS[name](node.LINK, words)
    except UnsupportedError:
        raise Refusal("unsupported") from None
    except UnknownIdError:
        raise Refusal("unknown-id") from None
    except LengthError as error:
        raise Refusal(counted("length", error)) from None
    except TooLongError as error:
        raise Refusal(counted("too-long", error)) from None
    except ChecksumError as error:
        raise Refusal(counted("checksum", error)) from None
    except RangeError as error:
        raise Refusal(f"range field={error.field.encode().hex()}") from None


def _checksum(link: Link, words: Words) -> str:
    return f" crc={checksum(link, octets(words).decode(), octets(words))}"


def _uart_encode(link: Link, words: Words) -> str:
    return f" bytes={uart_encode(link, octets(words)).hex()}"


def _uart_events(link: Link, words: Words) -> str:
    decoder = UartDecoder(link, number(words))
    reply = []
    for chunk in words:
        for event in decoder.feed(bytes.fromhex(chunk)):
            reply.append(f" {event.event}")
            if event.event == "message":
                kind = uart_kind(link, event.message)
                reply.append(f" kind={kind} bytes={event.message.hex()}")
    counts = f" ok discarded={decoder.discarded} pending={decoder.pending}"
    return "".join(reply) + counts


def _can_split(link: Link, words: Words) -> str:
    kind = _KINDS[next(words)]
    id, source, destination = number(words), number(words), number(words)
    message = CanMessage(kind, id, source, destination, octets(words))
    packets = can_split(link, message)
    return "".join(
        f" packet id={packet.id} bytes={packet.data.hex()}" for packet in packets
    )


def _can_join(link: Link, words: Words) -> str:
    address, senders, end = maybe(words), number(words), maybe(words)
    joiner = CanJoiner(link, address, senders)
    events: list[CanEvent] = []
    for at in words:
        events += joiner.feed(int(at), packet(words))
    if end is not None:
        events += joiner.expire(end)
    return "".join(map(_can_event, events))


def _can_event(event: CanEvent) -> str:
    reply = f" {event.event} id={event.id} source={event.source}"
    if event.message:
        message = event.message
        reply += f" kind={message.kind} destination={message.destination}"
        reply += f" bytes={message.data.hex()}"
    return f"{reply} missing={event.missing}" if event.event == "incomplete" else reply


def _i2c_read(link: Link, words: Words) -> str:
    id, checked = number(words), number(words) == 1
    read = i2c_read_length(link, id, checked)
    return f" write={i2c_write(link, id).hex()} read={read}"


def _i2c_write(link: Link, words: Words) -> str:
    id, checked = number(words), number(words) == 1
    return f" write={i2c_write(link, id, octets(words), checked).hex()}"


def _i2c_reply(link: Link, words: Words) -> str:
    id, checked = number(words), number(words) == 1
    return f" bytes={i2c_reply(link, id, octets(words), checked).hex()}"


def _frames(frames: Iterable[LogFrame]) -> str:
    return "".join(
        row(
            "frame",
            bit=frame.bit,
            id="" if frame.id is None else frame.id,
            bytes=frame.data,
        )
        for frame in frames
    )


def _log_decode(link: Link, words: Words) -> str:
    reader = LogReader(link)
    reply = []
    for piece in words:
        for entry in reader.feed(bytes.fromhex(piece)):
            times = {"seconds": entry.seconds, "milliseconds": entry.milliseconds}
            reply.append(row("entry", **times) + _frames(entry.frames))
    return "".join(reply) + row("ok", truncated=reader.truncated, mask=reader.mask)


def _log_encode(link: Link, words: Words) -> str:
    writer = LogWriter(link, octets(words))
    out = writer.header()
    for seconds in words:
        milliseconds = number(words)
        frames = [octets(words) for _ in range(number(words))]
        out += writer.entry(int(seconds), milliseconds, frames)
    return f" bytes={out.hex()}"


def _log_message_decode(link: Link, words: Words) -> str:
    log = LogMessage.decode(link, octets(words))
    return f" mask={log.mask.hex()}" + _frames(log.frames)


def _log_message_encode(link: Link, words: Words) -> str:
    mask = octets(words)
    frames = [octets(words) for _ in range(number(words))]
    return f" bytes={LogMessage.encode(link, mask, frames).hex()}"


def _dos_time_unpack(link: Link, words: Words) -> str:
    time = dos_time_unpack(link, number(words))
    return row("ok", **time._asdict(), valid=int(time.is_valid))


def _dos_time_pack(link: Link, words: Words) -> str:
    return f" value={dos_time_pack(link, DosTime(*numbers(words)))}"


def _index_decode(link: Link, words: Words) -> str:
    entries, truncated = read_index(link, octets(words))
    reply = "".join(row("entry", **entry._asdict()) for entry in entries)
    return f" truncated={truncated}" + reply


def _index_encode(link: Link, words: Words) -> str:
    entries = []
    for type in words:
        counter, checksum = number(words), number(words)
        size, time = number(words), number(words)
        entry = IndexEntry(int(type), counter, checksum, size, time, octets(words))
        entries.append(entry)
    return f" bytes={write_index(link, entries).hex()}"


def _identify(link: Link, words: Words) -> str:
    identity = identify(link, octets(words))._asdict()
    return row("ok", **{key: int(value) for key, value in identity.items()})


def _link_data(link: Link, words: Words) -> str:
    log, index = link.log_file, link.index_file
    return row(
        "ok",
        boot_ms=link.boot_time,
        log_file_type=log and log.file_type,
        index_file_type=index and index.file_type,
    )


_DIRECTIONS: tuple[Direction, ...] = ("telecommand", "telemetry")
_REQUEST = len(_DIRECTIONS)
_VERDICTS: tuple[Verdict, ...] = ("ack", "reply", "nak", "busy", "progress")
_ANSWERED = ("message", "request", "unknown_id", "length", "checksum")


def _stream_encode(link: Link, words: Words) -> str:
    direction, id, data = number(words), number(words), octets(words)
    values = _values(words)
    if direction == _REQUEST:
        return f" bytes={stream_encode_request(link, id, **values).hex()}"
    line = stream_encode(link, id, data, _DIRECTIONS[direction], **values)
    return f" bytes={line.hex()}"


def _stream_encode_packet(link: Link, words: Words) -> str:
    direction, packet, id = number(words), number(words), number(words)
    line = stream_encode_packet(
        link, packet, id, _DIRECTIONS[direction], **_values(words)
    )
    return f" bytes={line.hex()}"


def _values(words: Words) -> dict[str, int]:
    values = {role: maybe(words) for role in CHOSEN_ROLES}
    return {role: value for role, value in values.items() if value is not None}


def _stream_events(link: Link, words: Words) -> str:
    decoder = StreamDecoder(link, _DIRECTIONS[number(words)], number(words))
    reply = "".join(
        _stream_event(event)
        for chunk in words
        for event in decoder.feed(bytes.fromhex(chunk))
    )
    return f"{reply} ok discarded={decoder.discarded} pending={decoder.pending}"


def _stream_respond(link: Link, words: Words) -> str:
    verdict, has_reason = _VERDICTS[number(words)], number(words)
    reason_word, data = maybe(words), octets(words)
    reason = reason_word if has_reason else None
    sender = Sender(link, "telemetry", _values(words))
    decoder = StreamDecoder(link, "telecommand")
    reply = ""
    for chunk in words:
        for event in decoder.feed(bytes.fromhex(chunk)):
            if event.event in _ANSWERED and event.id is not None:
                reply += f" response {_response(sender, event, verdict, reason, data)}"
    return reply


def _response(
    sender: Sender,
    event: StreamEvent,
    verdict: Verdict,
    reason: Optional[int],
    data: bytes,
) -> str:
    try:
        line = sender.respond(event, verdict, reason, data)
    except LengthError:
        return "error=length"
    except RangeError:
        return "error=range"
    return "error=unsupported" if line is None else f"bytes={line.hex()}"


def _stream_event(event: StreamEvent) -> str:
    reply = f" {event.event}" + ("" if event.id is None else f" id={event.id}")
    if event.packet is not None:
        reply += f" packet={event.packet}"
    if event.event in ("message", "packet"):
        reply += f" bytes={event.data.hex()}"
    reply += "".join(f" {role}={value}" for role, value in event.values.items())
    return f"{reply} missing={event.missing}" if event.event == "gap" else reply


_OPERATIONS = {
    "checksum": _checksum,
    "uart_encode": _uart_encode,
    "uart_events": _uart_events,
    "can_split": _can_split,
    "can_join": _can_join,
    "i2c_read": _i2c_read,
    "i2c_write": _i2c_write,
    "i2c_reply": _i2c_reply,
    "log_decode": _log_decode,
    "log_encode": _log_encode,
    "log_message_decode": _log_message_decode,
    "log_message_encode": _log_message_encode,
    "dos_time_unpack": _dos_time_unpack,
    "dos_time_pack": _dos_time_pack,
    "index_decode": _index_decode,
    "index_encode": _index_encode,
    "identify": _identify,
    "link_data": _link_data,
    "stream_encode": _stream_encode,
    "stream_encode_packet": _stream_encode_packet,
    "stream_events": _stream_events,
    "stream_respond": _stream_respond,
    "stream_client": _testee_scripts.stream_client,
    "client": _testee_scripts.client,
    "procedure": _testee_scripts.procedure,
}
