"""Scripts of the client over a packet format: replies, time-outs, simultaneous requests
and unsolicited messages.

A script is a list of rows with a time ``at`` in milliseconds: what the program requests
(``telecommand``, ``telemetry``) or what arrives (``receive``). Each `yield` names the
situation and gives its script. Clients of single buses are in ``clients``.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.packet_formats import NumberPlace as WirePlace
from icdgen_runtime.wire.stream import (
    stream_encode,
    stream_encode_packet,
    stream_encode_request,
    values_of,
)

from icdgen.icd.responses import ID_BYTES, NEEDED, PROGRESS
from icdgen.protocol.exchange import Exchange, NumberPlace, Response
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.packet_formats import REQUESTED, Stream, StreamRow
from icdgen.protocol.sections import Settings
from icdgen.vectors.wire import Requests, Row, Script

SETTINGS = {"reply_timeout": 100, "retries": 2, "late": 100}
MOST_MOMENTS = 100  # of a script
OUTCOME_SETTINGS = {"busy_pause": 30, "progress_for": 250}


def wire_place(place: NumberPlace) -> WirePlace:
    """Return the place in the runtime, which reads and writes numbers."""
    return WirePlace(place.at, place.size, place.shift, place.bits, place.little)


class StreamSample:
    """Rows of scripts with messages of the node."""

    def __init__(self, link: Link[Any], form: Stream, source: Random) -> None:
        self.link, self.form, self.source = link, form, source
        self._numbers = 0

    def ask(self, at: int, row: StreamRow, **more: object) -> dict[str, Any]:
        """Return a row that sends a telecommand, or requests telemetry by a packet."""
        if row.is_requested:
            return {"at": at, "telemetry": row.id, **more}
        return {
            "at": at,
            "telecommand": row.id,
            "bytes": self.source.randbytes(row.most).hex(),
            **more,
        }

    def come(
        self, at: int, row: StreamRow, lost: int = 0, data: bytes | None = None
    ) -> dict[str, Any]:
        """Return a row that receives telemetry, after ``lost`` skipped sequence
        numbers, with random data unless they are given.
        """
        if data is None:
            data = self.source.randbytes(row.most)
        field = self.form.packets[row.packet].of("sequence")
        self._numbers += lost + 1
        values = {"sequence": self._numbers & field.mask} if field else {}
        line = stream_encode(self.link, row.id, data, "telemetry", **values)
        return {"at": at, "receive": line.hex()}

    def respond(
        self,
        at: int,
        request_row: dict[str, Any],
        exchange: Exchange,
        response: Response,
        status: int | None = None,
        foreign: bool = False,
    ) -> dict[str, Any]:
        """Return a row that receives a response to the telecommand of a row.

        ``foreign``: each echo differs from the telecommand in its lowest bit.
        """
        id: int = request_row[
            "telecommand" if "telecommand" in request_row else "telemetry"
        ]
        telecommand = id.to_bytes(ID_BYTES, "big") + bytes.fromhex(
            request_row.get("bytes", "")
        )
        telemetry = id if response.telemetry is None else response.telemetry
        row = next((row for row in self.form.telemetry if row.id == telemetry), None)
        if response.packet is not None:
            packet = self.form.packets[response.packet]
            data = bytearray(packet.overhead + packet.reserved)
        else:
            assert row is not None
            data = bytearray(self.source.randbytes(row.most))
        header = self.header_of(request_row) if exchange.in_header else b""
        for echo in response.echoes:
            in_header = exchange.is_in_header(echo.source)
            sent = header if in_header else telecommand
            number = wire_place(exchange.sources[echo.source]).of(sent)
            wire_place(echo.place).put(number ^ int(foreign), data)
        if response.status and status is not None:
            wire_place(response.status).put(status, data)
        if response.packet is not None:
            # A status that is the reason as well is already set.
            is_decided = response.reason == response.status and status is not None
            if response.reason and not is_decided:
                place = wire_place(response.reason)
                place.put(self.source.randrange(1, 1 << place.bits), data)
            line = self.packet(response.packet, bytes(data))
            return {"at": at, "receive": line.hex()}
        assert row is not None
        return self.come(at, row, data=bytes(data))

    def header_of(self, request_row: Row) -> bytes:
        """Return the header of what a row sends, with the first sequence number."""
        stream = need(self.link.stream, "stream")
        # Without delimiters and byte stuffing, the header begins with the first byte.
        link = self.link._replace(stream=stream._replace(delimited_by="datagram"))
        if "telecommand" not in request_row:
            return stream_encode_request(link, request_row["telemetry"])
        data = bytes.fromhex(request_row["bytes"])
        return stream_encode(link, request_row["telecommand"], data)

    def packet(self, number: int, draft: bytes) -> bytes:
        """Return a packet without a message, with the id and values of a draft."""
        stream = need(self.link.stream, "stream")
        id, values = values_of(stream.packets[number], draft)
        field = self.form.packets[number].of("sequence")
        if field:
            self._numbers += 1
            values["sequence"] = self._numbers & field.mask
        return stream_encode_packet(self.link, number, id, "telemetry", **values)


def scripts(link: Link[Any], facts: Facts) -> Requests:
    """Yield the scripts of the client over a packet format."""
    form = need(facts.stream, "stream")
    sample = StreamSample(link, form, Random(f"{facts.node.name} client"))
    if not form.telecommands and form.request is None:
        return
    for why, rows in _single_requests(form, sample) if form.telecommands else ():
        yield (
            f"client: {why}",
            {"op": "stream_client", "settings": SETTINGS, "script": rows},
        )
    for why, rows in _simultaneous_requests(form, sample) if form.telecommands else ():
        for requests in (1, 2, 3):
            request = {
                "op": "stream_client",
                "requests": requests,
                "settings": {**SETTINGS, "in_flight": requests},
                "script": rows,
            }
            yield f"client of {requests}: {why}", request
    for exchange in form.exchanges:
        rows_of_link = (*form.telecommands, *form.telemetry)
        row = next(
            (row for row in rows_of_link if form.exchange_of(row) == exchange), None
        )
        if row is None:
            continue  # no telemetry can be requested
        for why, more, rows in _outcomes(row, exchange, sample):
            request = {
                "op": "stream_client",
                "requests": 3,
                "settings": {**SETTINGS, **OUTCOME_SETTINGS, **more},
                "script": rows,
            }
            yield f"client: {row.name}, {why}", request
        if row.is_requested and form.packets[row.packet].content == REQUESTED:
            for why, rows in _nameless_responses(form, row, sample):
                yield (
                    f"client: {row.name}, {why}",
                    {
                        "op": "stream_client",
                        "requests": 3,
                        "settings": {**SETTINGS, "in_flight": 3},
                        "script": rows,
                    },
                )
        # These have the times of the ICD.
        for why, rows in _declared_times(row, exchange, sample, facts.client):
            request = {"op": "stream_client", "requests": 3, "script": rows}
            yield f"client: {row.name}, {why}", request


def _nameless_responses(
    form: Stream, row: StreamRow, s: StreamSample
) -> Iterator[tuple[str, Script]]:
    """Yield scripts of requests whose telemetry comes in a packet without its id."""
    request_row = s.ask(0, row)
    for other in form.telemetry:
        if other.packet != row.packet:
            continue
        yield f"the data of {other.name} come", [
            request_row, s.come(30, other), s.come(31, row), s.come(32, other), {"at": 100},
        ]  # fmt: skip
        yield f"the data of {other.name} come late", [
            request_row, s.ask(1, other), {"at": 100}, s.come(110, other), {"at": 200}, {"at": 300}, {"at": 400},
            s.come(401, other), {"at": 500},
        ]  # fmt: skip
        yield f"then {other.name} is requested", [
            request_row, s.ask(1, other), s.come(10, row), s.come(20, other), s.come(30, other),
        ]  # fmt: skip
        yield f"cancelled, then {other.name} is requested", [
            request_row, {"at": 5, "cancel": True}, s.ask(6, other), s.come(10, other), s.come(20, row), {"at": 200},
            s.come(210, other),
        ]  # fmt: skip
    yield "without a request", [s.come(0, row)]


def _single_requests(form: Stream, s: StreamSample) -> Iterator[tuple[str, Script]]:
    row = min(form.telecommands, key=lambda row: row.most)
    known_ids = {row_.id for row_ in (*form.telecommands, *form.telemetry)}
    # The smallest unused id fits into the id field whenever possible.
    unknown = next(id for id in range(len(known_ids) + 1) if id not in known_ids)
    yield (
        "unknown ids",
        [
            {"at": 0, "telecommand": unknown, "bytes": ""},
            {"at": 0, "telemetry": unknown},
        ],
    )
    yield "a reply of an unknown id", [s.ask(0, row, reply=unknown)]
    for size in {row.least - 1, row.most + 1} - {-1}:
        yield f"{size} bytes", [{"at": 0, "telecommand": row.id, "bytes": "00" * size}]
    silent = next((row_ for row_ in form.telecommands if row_.exchange is None), None)
    if silent:
        yield (
            "without a reply it is done when it is sent",
            [s.ask(0, silent), {"at": 500}, s.ask(500, silent)],
        )
    for frame in form.telemetry[:1]:
        reply_argument: dict[str, object] = {"reply": frame.id}
        yield (
            "what comes unasked",
            [s.come(0, frame), s.come(1, frame), s.come(2, frame, lost=3)],
        )
        yield from _requests_with_reply(form, s, row, frame, reply_argument)
    for frame in form.telemetry:
        asks = {"telemetry": frame.id}
        yield (
            f"{frame.name} is requested",
            [{"at": 0, **asks}, s.come(30, frame), {"at": 31, **asks}, {"at": 131}],
        )
        yield (
            f"{frame.name} never comes",
            [{"at": at, **asks} if not at else {"at": at} for at in range(0, 400, 100)],
        )
    for row in form.telecommands:
        if row.exchange is None:
            continue
        id = row.exchange.reply
        reply = next((frame for frame in form.telemetry if frame.id == id), None)
        if reply is not None:
            script = [s.ask(0, row), s.come(30, reply)]
            yield f"{row.name} is answered as the ICD says", script


def _requests_with_reply(
    form: Stream,
    s: StreamSample,
    row: StreamRow,
    frame: StreamRow,
    reply: dict[str, object],
) -> Iterator[tuple[str, Script]]:
    """Yield scripts of a telecommand with a reply that the caller specifies."""
    other = next(
        (telemetry for telemetry in form.telemetry if telemetry.id != frame.id), frame
    )
    untaken, cancel = {"untaken": True}, {"cancel": True}
    bad = bytearray.fromhex(s.come(0, frame)["receive"])
    # Delimited formats end with a delimiter, so a byte in the middle is damaged
    # instead.
    bad[-1 if form.delimited_by in ("length", "datagram") else len(bad) // 2] ^= 1
    yield (
        "the reply comes",
        [s.ask(0, row, **reply), s.come(30, frame), s.come(31, frame), {"at": 500}],
    )
    yield (
        "another message comes first",
        [s.ask(0, row, **reply), s.come(5, other), s.come(6, frame)],
    )
    yield "the reply is damaged, then right", [
        s.ask(0, row, **reply), {"at": 5, "receive": bad.hex()}, s.come(6, frame), s.come(7, frame), s.come(8, frame),
    ]  # fmt: skip
    yield "no reply", [s.ask(0, row, **reply), {"at": 99}, {"at": 100}, {"at": 101}]
    yield "no reply, and it may be repeated", [
        s.ask(0, row, repeat=True, **reply), {"at": 100}, {"at": 200}, {"at": 299}, {"at": 300}, {"at": 1000},
    ]  # fmt: skip
    yield "a late reply is not that of the next", [
        s.ask(0, row, **reply), {"at": 100}, s.ask(120, row, **reply), s.come(130, frame), {"at": 199}, {"at": 200},
        s.come(210, frame), s.ask(211, row, **reply), s.come(212, frame),
    ]  # fmt: skip
    yield "two responses to a repeated request", [
        s.ask(0, row, repeat=True, **reply), {"at": 100}, s.come(110, frame), s.ask(120, row, **reply), s.come(130, frame),
        {"at": 210}, s.come(220, frame),
    ]  # fmt: skip
    yield "time stands still, then jumps", [
        s.ask(0, row, repeat=True, **reply), {"at": 5000}, {"at": 5000}, s.come(5001, frame),
    ]  # fmt: skip
    yield "what was not sent is not answered", [
        s.ask(0, row, **reply, **untaken), s.come(5, frame) | untaken, {"at": 6}, s.come(7, frame),
    ]  # fmt: skip
    yield "what is never taken times out, and is not sent then", [
        s.ask(0, row, repeat=True, **reply, **untaken), *({"at": at, **untaken} for at in (100, 200, 300)), {"at": 301},
        s.ask(302, row, **reply), s.come(303, frame),
    ]  # fmt: skip
    yield "what is sent again was not taken when the reply comes", [
        s.ask(0, row, repeat=True, **reply), {"at": 100, **untaken}, s.come(110, frame), {"at": 111},
    ]  # fmt: skip
    yield "cancelled", [
        s.ask(0, row, **reply), {"at": 5, **cancel}, s.come(6, frame), s.ask(7, row, **reply), {"at": 199}, {"at": 200},
        s.come(201, frame),
    ]  # fmt: skip
    yield "cancelled before it was sent", [
        s.ask(0, row, **reply, **untaken), {"at": 5, **cancel}, s.ask(7, row, **reply), s.come(8, frame),
    ]  # fmt: skip
    yield "cancelled while it is delayed", [
        s.ask(0, row, **reply), {"at": 100}, s.ask(110, row, **reply), {"at": 120, **cancel}, s.ask(130, row, **reply),
        {"at": 200}, s.come(210, frame),
    ]  # fmt: skip
    yield "another request is cancelled, and one that does not exist", [
        s.ask(0, row, **reply), {"at": 5, **cancel, "telecommand": row.id + 1}, {"at": 6, **cancel, "telemetry": row.id},
        s.come(7, frame), {"at": 8, **cancel},
    ]  # fmt: skip


def _simultaneous_requests(
    form: Stream, s: StreamSample
) -> Iterator[tuple[str, Script]]:
    """Yield scripts of requests that start while others are running."""
    row, (*_, last) = form.telecommands[0], form.telecommands
    untaken = {"untaken": True}
    silent = [row_ for row_ in form.telecommands if row_.exchange is None][:2]
    if silent:
        yield "telecommands without a reply, taken together", [
            s.ask(0, silent[0], **untaken), s.ask(0, silent[-1], **untaken), s.ask(1, silent[0], **untaken), {"at": 2},
            s.ask(3, silent[0]),
        ]  # fmt: skip
    if len(form.telemetry) < 2:
        return
    first, second = form.telemetry[0], form.telemetry[-1]
    reply_a, reply_b = ({"reply": frame.id} for frame in (first, second))
    yield (
        "two, answered in turn",
        [
            s.ask(0, row, **reply_a),
            s.ask(1, last, **reply_b),
            s.come(5, first),
            s.come(6, second),
        ],
    )
    yield "two, answered the other way round", [
        s.ask(0, row, **reply_a), s.ask(1, last, **reply_b), s.come(5, second), s.come(6, first), s.come(7, second),
    ]  # fmt: skip
    yield "two with the same reply", [
        s.ask(0, row, **reply_a), s.ask(1, last, **reply_a), s.come(5, first), s.ask(6, last, **reply_a), s.come(7, first),
    ]  # fmt: skip
    yield "each has a time-out of its own", [
        s.ask(0, row, repeat=True, **reply_a), s.ask(50, last, **reply_b), {"at": 100}, {"at": 149}, {"at": 150},
        s.come(160, first),
    ]  # fmt: skip
    yield "two time out at once, and are delayed", [
        s.ask(0, row, **reply_a), s.ask(0, last, **reply_b), {"at": 100}, s.ask(110, row, **reply_a), s.ask(111, last, **reply_b),
        {"at": 200}, s.come(201, second), s.come(202, first),
    ]  # fmt: skip
    yield "one is cancelled", [
        s.ask(0, row, **reply_a), s.ask(0, last, **reply_b), {"at": 5, "cancel": True, "telecommand": last.id}, s.come(6, second),
        s.come(7, first),
    ]  # fmt: skip
    yield "sent in the order in which they began, also what is sent again", [
        s.ask(0, row, repeat=True, **reply_a), s.ask(1, last, repeat=True, **reply_b), {"at": 100, **untaken},
        {"at": 101, **untaken}, {"at": 102}, {"at": 150, "cancel": True}, s.ask(400, last, **reply_b, **untaken),
        s.ask(401, row, **reply_a, **untaken), {"at": 402},
    ]  # fmt: skip
    if silent:
        yield "what has no reply needs no room when it is sent", [
            s.ask(0, row, **reply_a), s.ask(1, silent[0]), s.ask(2, silent[0], **untaken), s.ask(3, silent[0], **untaken),
            {"at": 4}, s.come(5, first),
        ]  # fmt: skip


def _outcomes(
    row: StreamRow, exchange: Exchange, s: StreamSample
) -> Iterator[tuple[str, dict[str, int], Script]]:
    """Yield scripts of a telecommand and its responses: purpose, settings and rows."""
    request_row = s.ask(0, row)
    for response in exchange.responses:
        if response.status is None:
            yield from _responses(row, s, exchange, response, None, response.verdict)
            continue
        meanings = dict(response.meanings)
        other = next(value for value in range(256) if value not in meanings)
        for status, verdict in {**meanings, other: response.verdict}.items():
            what = f"{verdict} by the status {status}"
            yield from _responses(row, s, exchange, response, status, what)
    two = s.ask(10, row)
    yield "the next of its kind waits until nothing late can come", {}, [
        request_row, {"at": 100}, two | {"at": 110}, {"at": 199}, {"at": 200}, {"at": 300}, {"at": 400},
    ]  # fmt: skip
    yield "two at a time", {"in_flight": 2}, [
        request_row, two, *(s.respond(30, request_row, exchange, each) for each in exchange.responses),
        *(s.respond(40, two, exchange, each) for each in exchange.responses), {"at": 100}, {"at": 110}, {"at": 300},
    ]  # fmt: skip
    yield "a gap between two", {"gap": 20}, [
        request_row, two, *(s.respond(15, request_row, exchange, each) for each in exchange.responses), {"at": 19}, {"at": 20},
        *(s.respond(25, two, exchange, each) for each in exchange.responses), {"at": 130},
    ]  # fmt: skip
    needed = [each for each in exchange.responses if each.verdict in NEEDED]
    for why, order in (("in order", needed), ("in reverse", needed[::-1])):
        if len(needed) > 1:
            yield f"all responses {why}", {}, [
                request_row, *(s.respond(30, request_row, exchange, each) for each in order), {"at": 100},
            ]  # fmt: skip


def _declared_times(
    row: StreamRow, exchange: Exchange, s: StreamSample, settings: Settings
) -> Iterator[tuple[str, Script]]:
    """Yield scripts whose moments are just before and after the times of the ICD."""
    request_row = s.ask(0, row)
    end = exchange.timeout or settings.reply_timeout
    late = end + settings.late
    for response in exchange.responses:
        at = [end - 1, end, late - 1, late]
        yield f"{response.verdict} in time, late and too late", [
            request_row, *(s.respond(moment, request_row, exchange, response) for moment in at[2:]),
        ]  # fmt: skip
        yield f"{response.verdict} at the time-out", [
            request_row, *(s.respond(moment, request_row, exchange, response) for moment in at[:2]),
        ]  # fmt: skip
        pause = settings.busy_pause
        yield f"{response.verdict}, then the pause of a busy device", [
            request_row, s.respond(0, request_row, exchange, response), {"at": pause - 1}, {"at": pause},
        ]  # fmt: skip
        statuses = [value for value, what in response.meanings if what == PROGRESS]
        # Each report comes just before the time-out, which it extends.
        moments = range(end - 1, settings.progress_for + end, end - 1)
        if (response.verdict == PROGRESS or statuses) and len(moments) <= MOST_MOMENTS:
            status = statuses[0] if statuses else None
            yield "progress until it no longer extends the time", [
                request_row, *(s.respond(moment, request_row, exchange, response, status) for moment in moments),
            ]  # fmt: skip


def _responses(
    row: StreamRow,
    s: StreamSample,
    exchange: Exchange,
    response: Response,
    status: int | None,
    what: str,
) -> Iterator[tuple[str, dict[str, int], Script]]:
    """Yield scripts in which one response arrives, at different times."""
    request_row = s.ask(0, row)

    def come(at: int, foreign: bool = False) -> Row:
        return s.respond(at, request_row, exchange, response, status, foreign)

    yield f"{what}", {}, [request_row, come(30), come(31), {"at": 100}, {"at": 130}]
    yield f"{what} comes late", {}, [
        request_row, {"at": 100}, come(110), come(111), come(112), {"at": 200},
    ]  # fmt: skip
    yield f"{what} comes after the late time", {}, [
        request_row, {"at": 100}, {"at": 200}, come(201),
    ]  # fmt: skip
    yield f"{what} of another telecommand", {}, [
        request_row, come(30, foreign=True), come(40), {"at": 100},
    ]  # fmt: skip
    yield f"{what} after the first attempt, which was late", {}, [
        request_row | {"repeat": True}, {"at": 100}, come(110), come(120), {"at": 200}, {"at": 310},
    ]  # fmt: skip
    yield f"{what} each time", {}, [
        request_row, *(come(at) for at in range(30, 400, 60)), {"at": 500},
    ]  # fmt: skip
    yield f"{what} while it is to be sent again", {"gap": 50}, [
        request_row | {"repeat": True}, s.ask(10, row), {"at": 50}, {"at": 100}, come(101), {"at": 150}, come(160),
        {"at": 200}, {"at": 300}, {"at": 400},
    ]  # fmt: skip
    yield f"{what} after it was cancelled", {}, [
        request_row, {"at": 20, "cancel": True}, s.ask(21, row), come(30), come(31), {"at": 131}, {"at": 200},
    ]  # fmt: skip
