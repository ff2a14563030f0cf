"""Scripts of the client over a packet format: replies, time-outs, simultaneous requests
and unsolicited messages.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

from icdgen.protocol import stream
from icdgen.protocol.envelope import Stream, StreamRow
from icdgen.protocol.facts import Facts, need
from icdgen.vectors.wire import Requests, Script

SETTINGS = {"reply_timeout": 100, "retries": 2}


class Sample:
    """Rows of scripts with messages of the node."""

    def __init__(self, form: Stream, source: Random) -> None:
        self.form, self.source = form, source
        self._numbers = 0

    def ask(self, at: int, row: StreamRow, **more: object) -> dict[str, Any]:
        """Return a row that sends a telecommand."""
        return {
            "at": at,
            "telecommand": row.id,
            "bytes": self.source.randbytes(row.most).hex(),
            **more,
        }

    def come(self, at: int, row: StreamRow, lost: int = 0) -> dict[str, Any]:
        """Return a row that receives telemetry, after ``lost`` skipped sequence
        numbers.
        """
        field = self.form.of("sequence")
        self._numbers += lost + 1
        values = {"sequence": self._numbers & field.mask} if field else {}
        line = stream.encode(
            self.form, "telemetry", row.id, self.source.randbytes(row.most), values
        )
        return {"at": at, "receive": line.hex()}


def scripts(facts: Facts) -> Requests:
    """Yield the scripts of the client over a packet format."""
    form = need(facts.stream, "stream")
    sample = Sample(form, Random(f"{facts.node.name} client"))
    if not form.telecommands:
        return
    for why, rows in _single_requests(form, sample):
        yield f"client: {why}", {
            "op": "stream_client",
            "settings": SETTINGS,
            "script": rows,
        }
    for why, rows in _simultaneous_requests(form, sample):
        for requests in (1, 2, 3):
            request = {
                "op": "stream_client",
                "requests": requests,
                "settings": SETTINGS,
                "script": rows,
            }
            yield f"client of {requests}: {why}", request


def _single_requests(form: Stream, s: Sample) -> Iterator[tuple[str, Script]]:
    row = min(form.telecommands, key=lambda row: row.most)
    known_ids = {row_.id for row_ in (*form.telecommands, *form.telemetry)}
    # The smallest unused id fits into the id field whenever possible.
    unknown = next(id for id in range(len(known_ids) + 1) if id not in known_ids)
    yield "unknown ids", [
        {"at": 0, "telecommand": unknown, "bytes": ""},
        {"at": 0, "telemetry": unknown},
    ]
    yield "a reply of an unknown id", [s.ask(0, row, reply=unknown)]
    for size in {row.least - 1, row.most + 1} - {-1}:
        yield f"{size} bytes", [{"at": 0, "telecommand": row.id, "bytes": "00" * size}]
    silent = next((row_ for row_ in form.telecommands if row_.reply is None), None)
    if silent:
        yield "without a reply it is done when it is sent", [
            s.ask(0, silent),
            {"at": 500},
            s.ask(500, silent),
        ]
    for frame in form.telemetry[:1]:
        reply_argument: dict[str, object] = {"reply": frame.id}
        yield "what comes unasked", [
            s.come(0, frame),
            s.come(1, frame),
            s.come(2, frame, lost=3),
        ]
        yield from _requests_with_reply(form, s, row, frame, reply_argument)
    for frame in form.telemetry:
        asks = {"telemetry": frame.id}
        yield f"{frame.name} is requested", [
            {"at": 0, **asks},
            s.come(30, frame),
            {"at": 31, **asks},
            {"at": 131},
        ]
        yield f"{frame.name} never comes", [
            {"at": at, **asks} if not at else {"at": at} for at in range(0, 400, 100)
        ]
    for row in form.telecommands:
        frame = next((row_ for row_ in form.telemetry if row_.id == row.reply), row)
        if frame is not row:
            yield f"{row.name} is answered as the ICD says", [
                s.ask(0, row),
                s.come(30, frame),
            ]


def _requests_with_reply(
    form: Stream, s: Sample, row: StreamRow, frame: StreamRow, reply: dict[str, object]
) -> Iterator[tuple[str, Script]]:
    """Yield scripts of a telecommand with a reply that the caller specifies."""
    other = next(
        (telemetry for telemetry in form.telemetry if telemetry.id != frame.id), frame
    )
    untaken, cancel = {"untaken": True}, {"cancel": True}
    bad = bytearray.fromhex(s.come(0, frame)["receive"])
    # Delimited formats end with a delimiter, so a byte in the middle is damaged
    # instead.
    bad[-1 if form.delimited_by in ("length", "none") else len(bad) // 2] ^= 1
    yield "the reply comes", [
        s.ask(0, row, **reply),
        s.come(30, frame),
        s.come(31, frame),
        {"at": 500},
    ]
    yield "another message comes first", [
        s.ask(0, row, **reply),
        s.come(5, other),
        s.come(6, frame),
    ]
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


def _simultaneous_requests(form: Stream, s: Sample) -> Iterator[tuple[str, Script]]:
    """Yield scripts of requests that start while others are running."""
    row, (*_, last) = form.telecommands[0], form.telecommands
    untaken = {"untaken": True}
    silent = [row_ for row_ in form.telecommands if row_.reply is None][:2]
    if silent:
        yield "telecommands without a reply, taken together", [
            s.ask(0, silent[0], **untaken), s.ask(0, silent[-1], **untaken), s.ask(1, silent[0], **untaken), {"at": 2},
            s.ask(3, silent[0]),
        ]  # fmt: skip
    if len(form.telemetry) < 2:
        return
    first, second = form.telemetry[0], form.telemetry[-1]
    reply_a, reply_b = ({"reply": frame.id} for frame in (first, second))
    yield "two, answered in turn", [
        s.ask(0, row, **reply_a),
        s.ask(1, last, **reply_b),
        s.come(5, first),
        s.come(6, second),
    ]
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
