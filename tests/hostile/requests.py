"""Single requests of a client to a device that sends other well-formed messages at any
time.
"""

from __future__ import annotations

from random import Random
from typing import Any, NamedTuple

from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.can import CanKind, CanMessage, can_split
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import OUTCOMES, Event
from icdgen_runtime.wire.link import Bus, Link
from icdgen_runtime.wire.uart import uart_encode

from icdgen.runtime_objects.links import responses_on

Row = dict[str, Any]
OTHER_KINDS: tuple[CanKind, ...] = (
    "acknowledge",
    "refusal",
    "reply",
    "request_refusal",
)


class Ended(NamedTuple):
    """A request that has ended: its script and outcomes, the number of messages that
    the client sent, and the time in milliseconds.
    """

    script: list[Row]
    outcomes: list[Event]
    sent: int
    time: int


class Most(NamedTuple):
    sent: int
    time: int


def most_of_a_request(link: Link[Any], bus: Bus) -> Most:
    """Return the bound of a request of a client that has just been created."""
    form, attempts = link.settings, 1 + link.settings.retries
    if bus == "i2c":
        # Each attempt is a transaction, and polls for the acknowledge.
        polls = form.poll_timeout // form.poll_interval + 2
        each = 2 * form.reply_timeout + form.poll_timeout + 2 * form.poll_interval
        return Most(int(attempts * (1 + polls)), int(attempts * each))
    return Most(attempts, int(attempts * form.reply_timeout))


def end_of_request(link: Link[Any], bus: Bus, seed: int) -> Ended:
    """Run a request against a device that responds at random."""
    source, now, sent = Random(seed), 0, 0
    client = Client(link, bus)
    telemetry = source.random() < 0.5
    id = source.choice(sorted(link.frames if telemetry else link.commands))
    request = (
        Request("telemetry", id)
        if telemetry
        else Request("telecommand", id, bytes(link.commands[id].length), True)
    )
    eagerness, pace = source.random(), source.choice([1, 10, 300])
    script: list[Row] = [{"at": now, request.kind: id}]
    if not telemetry:
        script[0] |= {"bytes": request.data.hex(), "repeat": True}
    client.start(now, request)
    events: list[Event] = []
    while True:
        transfers = client.transfers()
        packets = len({packet.id for packet in client.packets()})
        sent += len(transfers) + packets + (1 if client.output() else 0)
        if not client.busy:
            break
        assert client.deadline is not None
        at = min(now + source.randrange(2 * pace), int(client.deadline))
        for _ in transfers:
            now = at
            read = _read(link, transfers[0].read, source)
            script.append({"at": now, "receive": None if read is None else read.hex()})
            events += client.transferred(now, read)
        if not transfers and bus != "i2c" and source.random() < eagerness:
            now = at
            if bus == "uart":
                line = uart_encode(link, _message(link, id, source))
                script.append({"at": now, "receive": line.hex()})
                events += client.received(now, line)
            for packet in _packets(link, id, source) if bus == "can" else ():
                row = {"id": packet.id, "bytes": packet.data.hex()}
                script.append({"at": now, "receive": row})
                events += client.packet(now, packet)
        elif not transfers:
            now = max(now, int(client.deadline))
            script.append({"at": now})
            events += client.tick(now)
        most = most_of_a_request(link, bus)
        assert sent <= most.sent, "too many messages"
        assert now <= most.time, "too long"
    outcomes = [event for event in events if isinstance(event, OUTCOMES)]
    return Ended(script, outcomes, sent, now)


def _message(link: Link[Any], id: int, source: Random) -> bytes:
    """Return a message of another id, or of a wrong length."""
    assert link.acknowledge_bytes
    (response,) = responses_on(link, "uart")
    if source.random() < 0.5:
        acknowledge = bytearray(source.randbytes(link.acknowledge_bytes))
        acknowledge[0] = 0
        other_id = (id + source.randrange(1, 256)) % 256
        response.echoes[0].place.put(other_id, acknowledge)
        return bytes(acknowledge)
    other = source.choice(sorted(link.frames))
    return bytes((other,)) + source.randbytes(link.frames[other] + (other == id))


def _packets(link: Link[Any], id: int, source: Random) -> list[Any]:
    """Return the packets of a message of another id, or some of them."""
    assert link.can
    other = source.choice([each for each in link.frames if each != id])
    kind = source.choice(OTHER_KINDS)
    data = source.randbytes(link.frames[other]) if kind == "reply" else b""
    message = CanMessage(kind, other, link.can.node_address, 0, data)
    packets = can_split(link, message)
    return packets[: source.randrange(len(packets) + 1)] or packets


def _read(link: Link[Any], count: int, source: Random) -> bytes | None:
    """Return the bytes that a transaction reads; None if it failed."""
    command = link.bus_exchanges["i2c"].command
    if source.random() < 0.2:
        return None
    poll = command.poll if command else None
    if (
        command
        and poll
        and count == link.frames[poll.telemetry]
        and source.random() < 0.9
    ):
        frame = bytearray(count)
        frame[poll.until.at] = (source.random() < 0.2) << poll.until.shift
        frame[command.responses[0].echoes[0].place.at] = source.randrange(1, 128)
        return bytes(frame)
    return bytes(count)
