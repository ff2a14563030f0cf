"""Outcomes on a line that loses, delays and reorders: a client reports of a request only
what the device said about it.
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
_client = import_module("icdgen_runtime.wire.envelope_client")
_stream = import_module("icdgen_runtime.wire.stream")
_events = import_module("icdgen_runtime.wire.events")
EnvelopeClient, Request = _client.EnvelopeClient, _client.Request
StreamDecoder, stream_encode = _stream.StreamDecoder, _stream.stream_encode
OUTCOMES, Late, Stray, Timeout = (
    _events.OUTCOMES, _events.Late, _events.Stray, _events.Timeout,
)  # fmt: skip

ACK, NAK, BUSY = 0x06, 0x15, 0x16
TELECOMMANDS = {0x01: b"\1", 0x02: b"\0\1\0", 0x05: b"", 0x04: b""}
EVENTS = 0x83  # the telemetry that telecommand 4 requests


class Line(NamedTuple):
    """What a line does: probabilities, and delays in milliseconds."""

    loss: float
    delay: int  # longest delay of a response


@pytest.fixture(scope="module")
def link():
    icd = load([ROOT / "examples" / "links" / "wheel.yaml"]).icd
    return link_of(icd, facts.of(icd, icd.node("wheel")))


def wrong_outcomes(link, line: Line, runs: int, in_flight: int) -> list[str]:
    """The outcomes that a response to another request caused, of so many runs."""
    wrong, settings = [], link.settings._replace(in_flight=in_flight, progress_for=1)
    for run in range(runs):
        source = Random(run)
        client = EnvelopeClient(link, settings)
        device = StreamDecoder(link, "telecommand")
        arrivals: list[tuple[float, int, int, bytes]] = []
        now, left, outcomes, count = 0.0, 12, 0, 0
        while left or client.busy:
            if left and source.random() < 0.5:
                id = source.choice([*TELECOMMANDS])
                repeat = source.random() < 0.5
                client.start(now, Request("telecommand", id, TELECOMMANDS[id], repeat))
                left -= 1
            known = {slot.handle: slot.attempts for slot in client._slots}
            while data := client.output():
                # The request whose number of attempts has grown is the one that was sent.
                (handle,) = (
                    slot.handle
                    for slot in client._slots
                    if slot.attempts > known[slot.handle]
                )
                known = {slot.handle: slot.attempts for slot in client._slots}
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
    """Id and data of a response of the device."""
    kind = source.choice([ACK, ACK, ACK, NAK, BUSY])
    if kind == ACK:
        return bytes([EVENTS, 0, 7]) if id == 0x04 else bytes([ACK, id])
    return bytes([NAK, id, 4]) if kind == NAK else bytes([BUSY, id])


@pytest.mark.parametrize("in_flight", [1, 3])
def test_no_response_is_taken_for_that_of_another_request(link, in_flight):
    """Delays stay within the late time; the timeouts of the ICD are 200 ms, 3 s for
    Save.
    """
    line = Line(loss=0.2, delay=390)
    assert wrong_outcomes(link, line, 300, in_flight) == []


def test_responses_after_the_late_time_can_confuse_so_the_test_can_fail(link):
    assert wrong_outcomes(link, Line(loss=0.2, delay=1500), 100, 1)
