"""Conversations of a procedure and a device in virtual time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any, NamedTuple

from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.events import Arrived, Done, Event, Refused, Timeout
from icdgen_runtime.wire.failures import FailedError
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.procedures import Procedure
from icdgen_runtime.wire.session import Session
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen.runtime_objects.links import responses_on
from icdgen.runtime_objects.procedures import procedure_of, row_of
from tests.hostile.bounds import most_of
from tests.hostile.devices import Device, Kind

Row = dict[str, Any]
IDLE = 60  # ms between events of a device while the line is idle

FILE = {"type": 2, "counter": 1}
PROCEDURES: tuple[Row, ...] = (
    {"name": "list"},
    {"name": "download", "inputs": FILE},
    {"name": "download", "inputs": {**FILE, "size": 130}},
    {"name": "download", "bus": "i2c", "inputs": FILE, "block": 20},
    {"name": "download", "bus": "can", "inputs": {**FILE, "size": 130}},
    {"name": "upload", "inputs": {"store": 1}, "bytes": bytes(range(90)).hex()},
    {"name": "erase", "inputs": {**FILE, "all": 1}},
    {"name": "program_information", "inputs": {"program": 1}},
)


def longest_request(link: Link[Any]) -> int:
    """Return the longest time that a client spends on one request, in milliseconds.

    It is a wait for a late response, and each attempt with its polls.
    """
    form = link.settings
    attempt = 2 * form.reply_timeout + form.poll_timeout + form.poll_interval
    return int(form.reply_timeout + (form.retries + 1) * attempt)


class Conversation(NamedTuple):
    """A procedure that has ended, and what led to it."""

    procedure: Procedure
    script: list[Row]
    request_times: list[int]

    @property
    def requests(self) -> int:
        """Number of requests."""
        return len(self.request_times)


def stored(procedure: Procedure) -> int:
    """Return the number of bytes or entries that a procedure stores."""
    return len(procedure.frames) + len(procedure.data)


def converse(link: Link[Any], row: Row, kind: Kind, latency: int = 1) -> Conversation:
    """Run a procedure against a device whose responses take ``latency`` ms.

    Fail as soon as the procedure exceeds its bound.
    """
    procedure = procedure_of(link, row)
    device = Device(link, row["name"], kind, row.get("bus", "uart"))
    most, longest = most_of(procedure), longest_request(link)
    now, waited = 0, 0
    request_times: list[int] = []
    script: list[Row] = []

    def pass_on(event: Event | None) -> Request | None:
        if event is not None:
            procedure.event(now, event)
        following = procedure.next(now)
        script.append({"at": now, **({"event": row_of(event)} if event else {})})
        return following

    request = pass_on(None)
    while procedure.result is None:
        if request:
            request_times.append(now)
            events, request = device.answer(request), None
            for event in events:
                now += longest if isinstance(event, Timeout) else latency
                request = pass_on(event) or request
        else:
            deadline = procedure.deadline
            assert deadline is not None, "no request and no deadline"
            events = device.answer(None)
            until = int(min(deadline, now + IDLE) if events else deadline)
            waited += max(0, until - now)
            now = max(now, until)
            for event in events or [None]:
                request = pass_on(event) or request
        assert len(request_times) <= most.requests, "too many requests"
        assert waited <= most.waiting, "too long"
        assert stored(procedure) <= most.stored, "too much"
    assert procedure.next(now) is None and procedure.deadline is None
    return Conversation(procedure, script, request_times)


def _request_row(request: Request) -> Row:
    if request.kind == "telemetry":
        return {"telemetry": request.id}
    return {
        "telecommand": request.id,
        "bytes": request.data.hex(),
        "repeat": request.repeat,
    }


class Line:
    """UART of a device, in virtual time."""

    def __init__(self, link: Link[Any], device: Device) -> None:
        self.link, self.device, self.now, self.requests = link, device, 0.0, 0
        self._decoder = UartDecoder(link)
        self._sent: Iterator[bytes] = iter(())

    def clock(self) -> float:
        return self.now / 1000

    def write(self, data: bytes) -> None:
        for event in self._decoder.feed(data):
            assert event.event == "message"
            id = event.message[0]
            kind = "telemetry" if id in self.link.frames else "telecommand"
            self.requests += 1
            # A telecommand that is not acknowledged has no outcome.
            request = Request(kind, id, event.message[1:], True)  # type: ignore[arg-type]
            answers = self.device.answer(request)
            self._sent = chain(self._sent, self._lines(answers))

    def read(self, seconds: float) -> bytes:
        data = next(self._sent, b"")
        if not data:
            data = b"".join(self._lines(self.device.answer(None)))
        self.now += min(1000 * seconds, IDLE) if data else max(1000 * seconds, 0.001)
        return data

    def _lines(self, events: list[Event]) -> Iterator[bytes]:
        """Return the messages that make the client report the events."""
        link = self.link
        assert link.acknowledge_bytes
        (response,) = responses_on(link, "uart")
        listed = dict(response.meanings)
        success = next(code for code, verdict in listed.items() if verdict == "ack")
        refusal = next(code for code, _ in response.reasons if code not in listed)
        for event in events:
            if isinstance(event, Arrived):
                heads = {telemetry: id for id, telemetry in link.unsolicited.items()}
                yield uart_encode(link, bytes((heads[event.id],)) + event.data)
            elif isinstance(event, Done) and event.id in link.frames:
                yield uart_encode(link, bytes((event.id,)) + event.data)
            elif isinstance(event, (Done, Refused)):
                if (
                    event.id in link.commands
                    and not link.commands[event.id].acknowledged
                ):
                    continue
                code = success if isinstance(event, Done) else event.code
                acknowledge = bytearray(link.acknowledge_bytes)
                response.echoes[0].place.put(event.id, acknowledge)
                response.status.put(refusal if code is None else code, acknowledge)
                yield uart_encode(link, bytes(acknowledge))


def over_a_session(
    link: Link[Any], row: Row, kind: Kind
) -> tuple[str, Line, list[Row]]:
    """Run a procedure with a `Session`; return its result, its line, and the script of
    its client.

    Fail as soon as the procedure exceeds its bound.
    """
    procedure = procedure_of(link, row)
    line = Line(link, Device(link, row["name"], kind))
    session = Session(link, line.write, line.read, clock=line.clock)
    script: list[Row] = []
    client, most = session.client, most_of(procedure)
    attempts = 1 + link.settings.retries
    started, received, ticked = client.start, client.received, client.tick

    def start(now: float, request: Request) -> list[Event]:
        script.append({"at": round(now), **_request_row(request)})
        return started(round(now), request)

    def receive(now: float, data: bytes) -> list[Event]:
        assert line.requests <= most.requests * attempts, "too many requests"
        # Each attempt has its time-out, and may follow a wait for a late response.
        sending = 2 * line.requests * link.settings.reply_timeout
        assert line.now <= sending + most.waiting, "too long"
        assert stored(procedure) <= most.stored, "too much"
        script.append({"at": round(now), "receive": data.hex()})
        # `received` begins with `tick`, which is no row of its own.
        client.tick = ticked  # type: ignore[method-assign]
        try:
            return received(round(now), data)
        finally:
            client.tick = tick  # type: ignore[method-assign]

    def tick(now: float) -> list[Event]:
        script.append({"at": round(now)})
        return ticked(round(now))

    client.start, client.received, client.tick = start, receive, tick  # type: ignore[method-assign]
    try:
        session.run(procedure)
    except FailedError as error:
        return error.result, line, script
    return "done", line, script
