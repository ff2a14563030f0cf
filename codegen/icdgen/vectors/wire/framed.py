"""Messages in the packet format of a link: complete, in pieces, after noise, damaged,
truncated and nested.

`requests` yields requests to encode messages, to decode streams, and to respond as a
device. ``streams`` has the same for the UART of links without a packet format.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.errors import need
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.packet_formats import Direction
from icdgen_runtime.wire.packet_formats import StreamRow as WireRow
from icdgen_runtime.wire.stream import (
    stream_encode,
    stream_encode_packet,
    stream_encode_request,
)

from icdgen.icd.responses import BUSY, KINDS, NAK
from icdgen.protocol.packet_formats import (
    DATAGRAM,
    DIRECTIONS,
    GIVEN,
    NOTHING,
    Stream,
    StreamRow,
)
from icdgen.vectors.wire import Requests, pieces

_SPLITS = 40  # maximum number of split positions of a message
# Delimiter and escape bytes of SLIP, HDLC and COBS
_MARKERS = bytes((0x00, 0x7D, 0x7E, 0xC0, 0xDB, 0xDC, 0xDD, 0xFF))


def _markers(form: Stream) -> bytes:
    """Return the bytes that delimiters consist of."""
    escaping = form.escaping
    if escaping is None:
        return _MARKERS
    start = escaping.escape if escaping.start is None else escaping.start
    return bytes((escaping.escape, start, escaping.end, escaping.data, 0x55))


def requests(link: Link[Any], form: Stream, source: Random) -> Requests:
    """Yield the requests of a packet format."""
    for direction in DIRECTIONS:
        yield from _encoded(link, form, direction, source)
        if form.rows(direction):
            yield from _streams(link, form, direction, source)
    yield "no such message", _encode(DIRECTIONS[0], _unknown(form, DIRECTIONS[0]), b"")
    yield from _without_messages(link, form, source)
    yield from _responses(link, form, source)


def _without_messages(link: Link[Any], form: Stream, source: Random) -> Requests:
    """Yield requests of telemetry by packets, and packets without a message."""
    requested = [row for row in form.telemetry if row.is_requested]
    for row in requested:
        yield f"{row.name} is requested", _encode("request", row.id, b"")
    if len(form.packets) > 1 or form.request:
        unknown = _unknown(form, DIRECTIONS[1])
        yield "no such telemetry to request", _encode("request", unknown, b"")
    lines: dict[Direction, list[bytes]] = {direction: [] for direction in DIRECTIONS}
    lines["telecommand"] += [stream_encode_request(link, row.id) for row in requested]
    if len(form.packets) > 1:
        yield from _packets(form, source)
    for number, packet in enumerate(form.packets):
        if packet.content != NOTHING:
            continue
        for direction in DIRECTIONS:
            if direction in packet.directions:
                id = form.telemetry[0].id if packet.of("id") else 0
                values = {
                    field.role: source.randint(1, field.mask)
                    for field in packet.fields
                    if field.role in GIVEN and field.role != "sequence"
                }
                line = stream_encode_packet(link, number, id, direction, **values)
                lines[direction].append(line)
    for direction, sent in lines.items():
        rows = form.rows(direction)
        if not sent:
            continue
        sent += [_line(link, direction, row, source, 0) for row in rows[:2]]
        yield "packets of all formats, one after the other", _events(direction, sent)
        if form.delimited_by != DATAGRAM:
            stream = b"\x00\xff" + b"".join(sent) + b"noise" + b"".join(sent[::-1])
            for how, chunks in pieces("packets of all formats", stream, source):
                yield how, _events(direction, chunks)
        for why, damaged in _damaged(sent[0], source):
            yield (
                f"a packet without a message, {why}",
                _events(direction, [damaged, *sent]),
            )


def _responses(link: Link[Any], form: Stream, source: Random) -> Requests:
    """Yield what a device receives and responds to."""
    if not form.exchanges:
        return
    # A telecommand of each exchange, one without a response, and each second request.
    by_exchange = {row.exchange: row for row in reversed(form.telecommands)}
    lines = [_line(link, "telecommand", row, source, 0) for row in by_exchange.values()]
    requested = [row.id for row in form.telemetry if row.is_requested]
    lines += [stream_encode_request(link, id) for id in requested[::2]]
    damaged = [line for _, line in _damaged(lines[0], source)]
    responses = [each for exchange in form.exchanges for each in exchange.responses]
    reasons = sorted({value for each in responses for value, _ in each.reasons})
    # The sender counts the sequence; the response decides status and reason.
    set_elsewhere = {"sequence", "status", "reason"}
    values = {role: 1 for role in form.chosen("telemetry") if role not in set_elsewhere}
    refusing = (*reasons[:3], *reasons[-1:], 0xFFFFFFFF)
    for verdict in KINDS:
        for reason in (None, *(refusing if verdict in (NAK, BUSY) else ())):
            why = "" if reason is None else f" with the reason {reason}"
            yield (
                f"the device responds: {verdict}{why}",
                _respond(verdict, reason, b"", lines + damaged),
            )
        most = max((row.most for row in form.telemetry), default=0)
        for data in (source.randbytes(most), source.randbytes(2)):
            yield (
                f"the device responds: {verdict}, with data",
                _respond(verdict, None, data, lines, **values),
            )


def _respond(
    verdict: str, reason: int | None, data: bytes, chunks: list[bytes], **values: int
) -> dict[str, object]:
    return {
        "op": "stream_respond",
        "verdict": verdict,
        **({} if reason is None else {"reason": reason}),
        "bytes": data.hex(),
        "values": values,
        "chunks": [chunk.hex() for chunk in chunks],
    }


def _packets(form: Stream, source: Random) -> Requests:
    """Yield requests that encode packets without a message, and such as must be
    refused.
    """
    for number, packet in enumerate(form.packets):
        for direction in DIRECTIONS:
            if packet.content != NOTHING or direction not in packet.directions:
                yield (
                    f"{packet.name} of the {direction} is no packet without a message",
                    _encode_packet(direction, number, 0),
                )
                continue
            id_bits = sum(field.bits for field in packet.fields if field.role == "id")
            greatest = (1 << id_bits) - 1
            for id in sorted({0, source.randint(0, greatest), greatest}):
                yield f"{packet.name} of id {id}", _encode_packet(direction, number, id)
            if 0 < id_bits < 32:
                yield (
                    f"{packet.name} of an id that does not fit",
                    _encode_packet(direction, number, greatest + 1),
                )
            for field in packet.fields:
                if field.role not in GIVEN:
                    continue
                for value in sorted({0, 1, field.mask}):
                    yield (
                        f"{packet.name}: {field.role} {value}",
                        _encode_packet(
                            direction, number, greatest, **{field.role: value}
                        ),
                    )
                if field.bits < 32:
                    too_large = {field.role: field.mask + 1}
                    yield (
                        f"{packet.name}: a {field.role} that does not fit",
                        (_encode_packet(direction, number, 0, **too_large)),
                    )
    yield "no such packet", _encode_packet(DIRECTIONS[1], len(form.packets), 0)


def _encode_packet(
    direction: str, packet: int, id: int, **values: int
) -> dict[str, object]:
    return {
        "op": "stream_encode_packet",
        "direction": direction,
        "packet": packet,
        "id": id,
        "values": values,
    }


def _encode(direction: str, id: int, data: bytes, **values: int) -> dict[str, object]:
    return {
        "op": "stream_encode",
        "direction": direction,
        "id": id,
        "bytes": data.hex(),
        "values": values,
    }


def _unknown(form: Stream, direction: str) -> int:
    """Return an id that no message has, within the range of the id field if possible."""
    known_ids = {row.id for row in form.rows(direction)}
    return next(id for id in range(len(known_ids) + 1) if id not in known_ids)


def _data(form: Stream, row: StreamRow, source: Random) -> Iterator[tuple[str, bytes]]:
    """Yield data of a message in the lengths that it can have, each with its purpose."""
    for size in sorted({row.least, (row.least + row.most) // 2, row.most}):
        yield f"{size} random bytes", source.randbytes(size)
    yield "zeros", bytes(row.most)
    yield "ones", b"\xff" * row.most
    yield (
        "what delimiters are made of",
        bytes(source.choices(_markers(form), k=row.most)),
    )
    if row.most > 2:
        yield (
            "zeros at the end",
            source.randbytes(row.most // 2) + bytes(row.most - row.most // 2),
        )
        yield "one byte, then zeros", b"\x01" + bytes(row.most - 1)


def _encoded(
    link: Link[Any], form: Stream, direction: Direction, source: Random
) -> Requests:
    """Yield requests that encode messages, and such as must be refused."""
    for row in form.rows(direction):
        for why, data in _data(form, row, source):
            yield f"{row.name}: {why}", _encode(direction, row.id, data)
            line = stream_encode(link, row.id, data, direction)
            yield f"{row.name}: {why}, and back", _events(direction, [line])
        for size in {row.least - 1, row.most + 1} - {-1}:
            yield (
                f"{row.name}: a length that it does not have",
                _encode(direction, row.id, bytes(size)),
            )
    for row in form.rows(direction)[:1]:
        data = source.randbytes(row.most)
        packet = form.packets[row.packet]
        for field in packet.fields:
            if field.role in GIVEN:
                for value in sorted({0, 1, field.mask // 3, field.mask}):
                    yield (
                        f"{field.role} {value}",
                        _encode(direction, row.id, data, **{field.role: value}),
                    )
                    line = stream_encode(
                        link, row.id, data, direction, **{field.role: value}
                    )
                    yield f"{field.role} {value}, and back", _events(direction, [line])
                if field.bits < 32:
                    too_large = {field.role: field.mask + 1}
                    yield (
                        f"a {field.role} that does not fit",
                        _encode(direction, row.id, data, **too_large),
                    )
        absent = next((role for role in GIVEN if packet.of(role) is None), None)
        if absent:
            yield (
                "a value that no field takes",
                _encode(direction, row.id, data, **{absent: 7}),
            )


def _events(direction: str, chunks: list[bytes], **more: int) -> dict[str, object]:
    return {
        "op": "stream_events",
        "direction": direction,
        "chunks": [chunk.hex() for chunk in chunks],
        **more,
    }


def _streams(
    link: Link[Any], form: Stream, direction: Direction, source: Random
) -> Requests:
    """Yield streams that are cut, noisy, damaged or truncated."""
    rows = form.rows(direction)
    short = min(rows, key=lambda row: row.most)
    lines = [
        _line(link, direction, row, source, number)
        for number, row in enumerate(rows[:6])
    ]
    good = _line(link, direction, short, source, 0)
    if form.delimited_by == DATAGRAM:
        yield "packets, one after the other", _events(direction, lines)
        yield "a packet of nothing", _events(direction, [b"", good])
        yield "two messages in a packet", _events(direction, [good + good])
        for why, damaged in _damaged(good, source):
            yield why, _events(direction, [damaged, good])
        return
    streams = [
        ("messages, one after the other", b"".join(lines)),
        (
            "noise before, between and after",
            b"\x00\xff\x7f" + good + b"noise" + good + b"\x55",
        ),
        ("random bytes before", source.randbytes(300) + good + good),
        (
            "random bytes rich in delimiters before",
            bytes(source.choices(_markers(form), k=300)) + good + good,
        ),
        (
            "the header of a message, then whole ones",
            good[: max(1, form.packets[short.packet].header_bytes)] + good + good,
        ),
        ("a message that is cut off, then whole ones", good[:-1] + good + good + good),
        ("a message that has only begun", good + good[: len(good) // 2]),
        *((why, damaged + good + good) for why, damaged in _damaged(good, source)),
        *_nested(link, direction, rows, good),
        *_escapes(form, good),
        *_undefined_messages(link, form, direction, short, good),
        *_gaps(link, form, direction, short, source),
        ("nothing", b""),
    ]
    for why, line in streams:
        # The events must not depend on how the stream is cut.
        for how, chunks in pieces(why, line, source):
            yield how, _events(direction, chunks)
    two_messages = b"\x01" + good + good
    # Each split position once: a decoder must keep its state between two calls.
    for at in range(1, min(len(two_messages), _SPLITS)):
        yield (
            f"two messages after noise, cut behind byte {at}",
            _events(direction, [two_messages[:at], two_messages[at:]]),
        )
    for more in (-1, 0):
        limit = form.packets[short.packet].overhead + short.most + more
        # A decoder refuses a buffer that is smaller than header and trailer.
        if limit >= max(each.overhead for each in form.packets):
            why = "that it just fits" if more == 0 else "too small by one"
            yield (
                f"a buffer {why}",
                _events(direction, [good + lines[-1] + good + good], limit=limit),
            )


def _line(
    link: Link[Any], direction: Direction, row: StreamRow, source: Random, number: int
) -> bytes:
    """Return the transmitted bytes of a message with a sequence number."""
    has_number = need(link.stream, "stream").packets[row.packet].of("sequence")
    values = {"sequence": number} if has_number else {}
    data = source.randbytes(row.most)
    return stream_encode(link, row.id, data, direction, **values)


def _damaged(good: bytes, source: Random) -> Iterator[tuple[str, bytes]]:
    """Yield the message with one error each."""
    for at in sorted(
        {0, 1, 2, 3, 4, len(good) // 2, len(good) - 2, len(good) - 1}
        & set(range(len(good)))
    ):
        flipped = good[at] ^ 1 << source.randrange(8)
        yield f"byte {at} is damaged", good[:at] + bytes([flipped]) + good[at + 1 :]
    yield "a byte is lost", good[: len(good) // 2] + good[len(good) // 2 + 1 :]
    yield (
        "a byte comes twice",
        good[: len(good) // 2] + good[max(0, len(good) // 2 - 1) :],
    )


def _nested(
    link: Link[Any], direction: Direction, rows: tuple[StreamRow, ...], good: bytes
) -> Iterator[tuple[str, bytes]]:
    """Yield a message within the data of another message, which is complete, damaged or
    truncated.
    """
    outer = max(rows, key=lambda row: row.most)
    if outer.most < len(good):
        return
    line = stream_encode(link, outer.id, (good * outer.most)[: outer.most], direction)
    yield "a message within another one", line + good
    yield (
        "a message within a damaged one",
        line[:-1] + bytes([line[-1] ^ 0x10]) + good + good,
    )
    yield "messages within a truncated message", line[:-3] + good + good


def _escapes(form: Stream, good: bytes) -> Iterator[tuple[str, bytes]]:
    """Yield escape bytes where they have another meaning, or none."""
    if form.escaping is None:
        return
    escape, end, data = (
        bytes((byte,))
        for byte in (form.escaping.escape, form.escaping.end, form.escaping.data)
    )
    half = len(good) // 2
    other = bytes((next(byte for byte in range(256) if byte not in _markers(form)),))
    yield "escape bytes before a message", escape * 3 + good + escape * 4 + good
    yield "no message", escape + end + escape + data + end + good
    yield "a message that begins within another one", good[:half] + good + good
    yield (
        "any byte after the escape byte",
        good[:-2] + escape + other + escape + end + good,
    )
    yield (
        "an escape byte before the start of a message",
        good[:-2] + escape + escape + good + good,
    )
    yield "an empty packet", good[:2] + escape + end + good
    yield (
        "a message that is too long",
        good[:-2] + bytes(3 * form.longest) + good[-2:] + good,
    )
    yield (
        "escape bytes in a message that is too long",
        good[:-2] + 2 * form.longest * (escape + data) + good[-2:] + good,
    )


def _undefined_messages(
    link: Link[Any], form: Stream, direction: Direction, row: StreamRow, good: bytes
) -> Iterator[tuple[str, bytes]]:
    """Yield messages with an unknown id or length, encoded with a packet format that
    defines them.
    """
    place = form.packets[row.packet].of("id")
    ids = {row_.id for row_ in form.rows(direction)}
    id = next((candidate for candidate in range(1, 1000) if candidate not in ids), 0)
    variants = []
    if place and id <= place.mask:
        variants.append(("of an unknown id", id, row.most, 0))
    if form.longest_data > row.most:
        variants.append(("that is too long by one", row.id, row.most + 1, row.seed))
    if row.most:
        variants.append(("that is too short by one", row.id, row.most - 1, row.seed))
    for why, id, size, seed in variants:
        # The encoder refuses messages that it does not know, so this is the only one in
        # its table.
        only = (WireRow(id, 0, size, False, seed, packet=row.packet),)
        stream = need(link.stream, "stream")._replace(telecommands=only, telemetry=only)
        try:
            line = stream_encode(
                link._replace(stream=stream), id, b"\x2a" * size, direction
            )
        except RangeError:  # the length field cannot represent this length
            continue
        yield f"a message {why}", good + line + good


def _gaps(
    link: Link[Any], form: Stream, direction: Direction, row: StreamRow, source: Random
) -> Iterator[tuple[str, bytes]]:
    """Yield messages with gaps and repetitions of their sequence numbers."""
    place = form.packets[row.packet].of("sequence")
    if place is None:
        return
    for why, numbers in (
        ("sequence numbers that run over", (place.mask - 1, place.mask, 0, 1)),
        ("a gap in the sequence", (3, 4, 9, 10)),
        ("the same message twice", (3, 3, 4)),
        ("the sequence restarts", (7, 0, 1)),
    ):
        # A narrow field has only the lower bits of these numbers.
        fitting = [number & place.mask for number in numbers]
        yield (
            why,
            b"".join(_line(link, direction, row, source, number) for number in fitting),
        )
    sequence_rows = form.rows(direction)[:2]
    turns = [
        _line(link, direction, row_, source, number)
        for number in (1, 2, 3)
        for row_ in sequence_rows
    ]
    yield "messages in turn", b"".join(turns)
