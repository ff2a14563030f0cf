"""A client on a line that loses, delays and reorders reports only outcomes that the
device sent for the request.
"""

from __future__ import annotations

import heapq
from importlib import import_module
from random import Random
from typing import NamedTuple

import pytest

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT

# The modules of the runtime, which `icdgen.runtime_objects` has made importable.
_client = import_module("icdgen_runtime.wire.client")
_stream = import_module("icdgen_runtime.wire.stream")
Sender = import_module("icdgen_runtime.wire.sender").Sender
_events = import_module("icdgen_runtime.wire.events")
response_to = import_module("icdgen_runtime.wire.device").response_to
Client, Request = _client.Client, _client.Request
StreamDecoder, stream_encode = _stream.StreamDecoder, _stream.stream_encode
OUTCOMES, Late, Stray, Timeout = (
    _events.OUTCOMES, _events.Late, _events.Stray, _events.Timeout,
)  # fmt: skip

ACK, NAK, BUSY = 0x06, 0x15, 0x16
TELECOMMANDS = {0x01: b"\1", 0x02: b"\0\1\0", 0x05: b"", 0x04: b""}
EVENTS = 0x83  # the telemetry that telecommand 4 requests


class Line(NamedTuple):
    """Properties of a line: probabilities, and delays in milliseconds."""

    loss: float
    delay: int  # longest delay of a response


@pytest.fixture(scope="module")
def link():
    icd = load([ROOT / "examples" / "links" / "wheel.yaml"]).icd
    return link_of(icd, facts.of(icd, icd.node("wheel")))


def wrong_outcomes(link, line: Line, runs: int, in_flight: int) -> list[str]:
    """Return the outcomes that a response to another request caused, in ``runs`` runs."""
    wrong, settings = [], link.settings._replace(in_flight=in_flight, progress_for=1)
    for run in range(runs):
        source = Random(run)
        client = Client(link, settings=settings)
        device = StreamDecoder(link, "telecommand")
        arrivals: list[tuple[float, int, int, bytes]] = []
        now, remaining, outcomes, count = 0.0, 12, 0, 0
        while remaining or client.busy:
            if remaining and source.random() < 0.5:
                id = source.choice([*TELECOMMANDS])
                repeat = source.random() < 0.5
                client.start(now, Request("telecommand", id, TELECOMMANDS[id], repeat))
                remaining -= 1
            attempts = {slot.handle: slot.attempts for slot in client._slots}
            while data := client.output():
                # The request whose number of attempts has grown is the one that was sent.
                (handle,) = (
                    slot.handle
                    for slot in client._slots
                    if slot.attempts > attempts[slot.handle]
                )
                attempts = {slot.handle: slot.attempts for slot in client._slots}
                (received,) = device.feed(data)
                if source.random() > line.loss:
                    count += 1
                    at = now + source.uniform(0, line.delay)
                    response = _response(source, received.id or 0)
                    if source.random() > line.loss:
                        heapq.heappush(arrivals, (at, count, handle, response))
            times = [time for time in (client.deadline,) if time is not None]
            times += [arrivals[0][0]] if arrivals else []
            now = max(now, min(times, default=now + 10))
            owner, reported = 0, client.tick(now)
            outcomes += sum(isinstance(event, OUTCOMES) for event in reported)
            if arrivals and arrivals[0][0] <= now:
                _, _, owner, data = heapq.heappop(arrivals)
                telemetry = data[0]
                encoded = stream_encode(link, telemetry, data[1:], "telemetry")
                for event in client.received(now, encoded):
                    outcomes += isinstance(event, OUTCOMES)
                    is_mine = getattr(event, "handle", owner) == owner
                    if not is_mine and not isinstance(event, (Late, Stray, Timeout)):
                        wrong.append(f"run {run}, {now} ms: {event}")
        assert outcomes == 12, f"run {run}: each request has one outcome"
    return wrong


def _response(source: Random, id: int) -> bytes:
    """Return id and data of a response of the device."""
    kind = source.choice([ACK, ACK, ACK, NAK, BUSY])
    if kind == ACK:
        return bytes([EVENTS, 0, 7]) if id == 0x04 else bytes([ACK, id])
    return bytes([NAK, id, 4]) if kind == NAK else bytes([BUSY, id])


@pytest.mark.parametrize("in_flight", [1, 3])
def test_no_response_is_taken_for_that_of_another_request(link, in_flight):
    """Delays stay within the late time; the timeouts of the ICD are 200 ms, and 3 s for
    Save.
    """
    line = Line(loss=0.2, delay=390)
    assert wrong_outcomes(link, line, 300, in_flight) == []


def test_responses_after_the_late_time_can_confuse_so_the_test_can_fail(link):
    assert wrong_outcomes(link, Line(loss=0.2, delay=1500), 100, 1)


class Arm:
    """Client of the test link `arm`: telecommands with a status, an acknowledge and a
    reply; time-out 300 ms, late time 50 ms, pause of a busy device 100 ms.
    """

    MOVE, READ_POSITION, READ_LOAD = 0x0201, 0x0205, 0x0208
    RESULT, POSITION, LOAD = 0x8001, 0x0205, 0x0208
    DONE, LATER, MOVING, FAILED = 0, 1, 2, 3

    def __init__(self, **settings: int) -> None:
        path = ROOT / "tests" / "conformance" / "links" / "outcomes.yaml"
        icd = load([path]).icd
        self.link = link_of(icd, facts.of(icd, icd.node("arm")))
        own = self.link.settings._replace(**settings)
        self.client = Client(self.link, settings=own)
        self.device = Sender(self.link, "telemetry")

    def send(self, now: int, id: int, data: bytes = b"", reply: int | None = None):
        """Start a telecommand that may be sent again, and return whether it was sent at
        once.
        """
        self.client.start(now, Request("telecommand", id, data, True), reply)
        return bool(self.client.output())

    def result(self, now: int, telecommand: int, status: int) -> list[str]:
        """Receive a command result, and return the names of the events."""
        data = bytes([status, 0]) + telecommand.to_bytes(2, "big") + bytes(2)
        return self.receive(now, self.RESULT, data)

    def receive(self, now: int, id: int, data: bytes) -> list[str]:
        events = self.client.received(now, self.device.encode(id, data))
        return [type(event).__name__ for event in events]


def test_after_progress_the_late_time_counts_from_the_longer_timeout():
    arm = Arm(retries=0, progress_for=1000)
    assert arm.send(0, arm.MOVE, bytes(7))
    assert arm.result(200, arm.MOVE, arm.MOVING) == ["Progress"]
    assert [type(each).__name__ for each in arm.client.tick(500)] == ["Timeout"]
    assert not arm.send(510, arm.MOVE, bytes(7)), "its answer could be the late one"
    assert arm.result(549, arm.MOVE, arm.DONE) == ["Late"]


def test_progress_does_not_make_the_pause_of_a_busy_device_longer():
    arm = Arm(retries=2, busy_pause=100)
    assert arm.send(0, arm.MOVE, bytes(7))
    assert arm.client.tick(300) == []
    assert arm.client.output(), "sent again, so that one more response may arrive"
    assert arm.result(310, arm.MOVE, arm.LATER) == ["Progress"]
    assert arm.result(320, arm.MOVE, arm.MOVING) == ["Progress"]
    assert arm.client.deadline == 410


def test_an_acknowledge_that_comes_twice_does_not_count_as_the_reply_to_come():
    arm = Arm(retries=0)
    assert arm.send(0, arm.READ_POSITION, b"\1")  # its time-out is 120 ms
    assert arm.result(10, arm.READ_POSITION, arm.DONE) == ["Progress"]
    assert arm.result(11, arm.READ_POSITION, arm.DONE) == ["Progress"]
    assert [type(each).__name__ for each in arm.client.tick(120)] == ["Timeout"]
    assert not arm.send(130, arm.READ_POSITION, b"\1"), (
        "the reply could be the late one"
    )
    assert arm.receive(140, arm.POSITION, b"\1\0\0") == ["Late"]


def test_a_reply_named_by_the_caller_replaces_one_with_a_status():
    arm = Arm()
    assert arm.send(0, arm.READ_LOAD, reply=arm.POSITION)
    assert arm.receive(10, arm.LOAD, b"\0\0\0") == ["Arrived"]
    assert arm.receive(20, arm.POSITION, b"\0\0\0") == ["Done"]


def test_a_reply_named_by_the_caller_keeps_the_echo_and_status_of_the_icd():
    arm = Arm()
    assert arm.send(0, arm.READ_LOAD, reply=arm.LOAD)
    assert arm.receive(10, arm.LOAD, bytes([arm.FAILED, 0, 0])) == ["Refused"]


DAMAGED = bytes((NAK, 0x05, 5))  # `Save` with the reason `Bad CRC`


def test_a_telecommand_that_the_device_received_damaged_is_sent_again_at_once(link):
    client = Client(link)
    client.start(0, Request("telecommand", 0x05))
    sent = client.output()
    refusal = stream_encode(link, DAMAGED[0], DAMAGED[1:], "telemetry")
    assert client.received(10, refusal) == []
    client.tick(10)
    assert client.output() == sent
    confirmed = stream_encode(link, ACK, b"\5", "telemetry")
    (done,) = client.received(20, confirmed)
    assert isinstance(done, _events.Done) and done.attempts == 2


def test_a_telecommand_that_is_always_damaged_is_refused_in_the_end(link):
    client = Client(link)
    client.start(0, Request("telecommand", 0x05))
    refusal = stream_encode(link, DAMAGED[0], DAMAGED[1:], "telemetry")
    events = []
    for attempt in range(1 + link.settings.retries):
        assert client.output()
        events += client.received(10 * (attempt + 1), refusal)
        client.tick(10 * (attempt + 1))
    (refused,) = events
    assert isinstance(refused, _events.Refused)
    assert (refused.attempts, refused.reason) == (3, "Bad CRC")
    assert client.output() == b""


def test_a_device_can_refuse_with_a_wrong_checksum(link):
    response = response_to(link, 0x05, verdict="nak", reason=5)
    assert response.data == DAMAGED[1:]
    assert response_to(link, 0x05, verdict="nak", reason=4).data == b"\5\4"
