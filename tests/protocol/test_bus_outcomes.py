"""A client on a UART or CAN that loses, delays and reorders reports only outcomes that
the node sent for the request.
"""

from __future__ import annotations

import heapq
from random import Random

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.can import CanJoiner, CanMessage, can_split
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import OUTCOMES, Refused
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of

TIMES = {"reply_timeout": 100, "late": 200, "retries": 2}
REQUESTS = 12  # of a run
OURS = 0x42  # CAN address of the client
REFUSAL = 3  # code of an acknowledge
# Two of each kind, so that requests are often alike.
TELECOMMANDS, TELEMETRY = (31, 112), (128, 146)


@pytest.fixture(scope="module")
def link(icd) -> Link:
    link = link_of(icd, facts.of(icd, icd.node("cubeacp")))
    return link._replace(settings=link.settings._replace(**TIMES))


class Node:
    """A node that responds to each request at once, unless the line loses something."""

    def __init__(self, link: Link, bus: str, source: Random, loss: float) -> None:
        self.link, self.bus, self.source, self.loss = link, bus, source, loss
        self._decoder = UartDecoder(link) if bus == "uart" else None
        self._joiner = CanJoiner(link, None, 1) if bus == "can" else None

    def responses(self, client: Client) -> list[object]:
        """Return what the node sends in response to the output of the client."""
        sent: list[int] = []
        if self._decoder:
            events = self._decoder.feed(client.output())
            sent = [event.message[0] for event in events]
        elif self._joiner:
            for packet in client.packets():
                for event in self._joiner.feed(0, packet):
                    assert event.message
                    sent.append(event.message.id)
        return [
            self._response(id)
            for id in sent
            if self.source.random() > self.loss and self.source.random() > self.loss
        ]

    def _response(self, id: int) -> object:
        is_refused, node = self.source.random() < 0.3, self.link.can.node_address
        if id in TELEMETRY:
            frame = self.source.randbytes(self.link.frames[id])
            if self.bus == "uart":
                return uart_encode(self.link, bytes([id]) + frame)
            if is_refused:
                return CanMessage("request_refusal", id, node, OURS)
            return CanMessage("reply", id, node, OURS, frame)
        if self.bus == "uart":
            return uart_encode(self.link, bytes([id, REFUSAL if is_refused else 0]))
        kind = "refusal" if is_refused else "acknowledge"
        return CanMessage(kind, id, node, OURS)


def wrong_outcomes(link: Link, bus: str, delay: int, runs: int) -> list[str]:
    """Return the outcomes that a response to another request caused, in ``runs`` runs."""
    wrong = []
    for run in range(runs):
        source = Random(run)
        client, node = Client(link, bus, address=OURS), Node(link, bus, source, 0.15)
        arrivals: list[tuple[float, int, int, object]] = []
        now, begun, ended, count = 0.0, 0, 0, 0
        while begun < REQUESTS or client.busy:
            reported = []
            if not client.busy and source.random() < 0.5:
                begun += 1
                client.start(now, _request(link, source))
            for response in node.responses(client):
                count += 1
                at = now + source.uniform(0, delay)
                heapq.heappush(arrivals, (at, count, begun, response))
            if client.busy and source.random() < 0.05:
                client.cancel()
                ended += 1
            times = [client.deadline, arrivals[0][0] if arrivals else None]
            now = max(now, min((at for at in times if at is not None), default=now + 9))
            reported += client.tick(now)
            ended += sum(isinstance(event, OUTCOMES) for event in reported)
            if arrivals and arrivals[0][0] <= now:
                *_, owner, response = heapq.heappop(arrivals)
                for event in _received(client, now, response):
                    ended += isinstance(event, OUTCOMES)
                    if isinstance(event, OUTCOMES) and owner != begun:
                        wrong.append(f"run {run}, {now} ms: {event}")
        assert ended == REQUESTS, f"run {run}: each request has one outcome"
    return wrong


def _request(link: Link, source: Random) -> Request:
    if source.random() < 0.3:
        return Request("telemetry", source.choice(TELEMETRY))
    id = source.choice(TELECOMMANDS)
    data = bytes(link.commands[id].length)
    return Request("telecommand", id, data, source.random() < 0.5)


def _received(client: Client, now: float, response: object) -> list[object]:
    if isinstance(response, bytes):
        return client.received(now, response)
    assert isinstance(response, CanMessage)
    packets = can_split(client.link, response)
    return [event for packet in packets for event in client.packet(now, packet)]


@pytest.mark.parametrize("bus", ["uart", "can"])
def test_no_response_is_taken_for_that_of_another_request(link, bus):
    """Delays stay within the time-out and the late time."""
    assert wrong_outcomes(link, bus, delay=290, runs=500) == []


def test_responses_after_the_late_time_can_confuse_so_the_test_can_fail(link):
    assert wrong_outcomes(link, "uart", delay=1500, runs=100)


def test_an_acknowledge_after_another_request_has_ended_confirms_no_later_telecommand(
    link,
):
    client, telecommand = Client(link, "uart"), Request("telecommand", 31, b"\1")
    late_acknowledge = uart_encode(link, bytes([31, 0]))
    client.start(0, telecommand)
    client.output()
    client.tick(100)
    client.start(100, Request("telecommand", 112, bytes(8)))
    client.output()
    (event,) = client.received(110, uart_encode(link, bytes([112, REFUSAL])))
    assert isinstance(event, Refused)
    client.start(120, telecommand)
    assert client.output() == b""
    assert not any(
        isinstance(event, OUTCOMES) for event in client.received(130, late_acknowledge)
    )
    assert client.output(), "sent after what it waited for has arrived"
