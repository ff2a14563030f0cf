"""Run scripts of the client and of procedures."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, Optional

from .._errors import LengthError, UnknownIdError
from .._testee_words import Words, counted, listed, maybe, number, octets, row
from .awaited import Request
from .can import CanPacket
from .client import Client
from .errors import BusyError, UnsupportedError
from .events import (
    Arrived,
    Busy,
    Done,
    Event,
    LineError,
    Refused,
    Sent,
    Timeout,
)
from .link import Bus, Link, Settings
from .procedures import Procedure

_BUSES: tuple[Bus, ...] = ("uart", "i2c", "can")
_BUS_SETTINGS = Settings._fields[:5]
_STREAM_SETTINGS = (*Settings._fields[:2], *Settings._fields[4:])
_OUTCOMES: dict[str, Any] = {
    "refused": Refused,
    "timeout": Timeout,
    "sent": Sent,
    "busy": Busy,
}


def client(link: Link, words: Words) -> str:
    """Run a script of a client on a bus."""
    bus, checked, address = _bus(words), number(words) == 1, number(words)
    settings = _settings(link, words, _BUS_SETTINGS)
    tested = Client(
        link, bus, crc=checked, address=address, settings=settings, requests=1
    )
    reply = []
    for at in words:
        reply.append(" step")
        action, now, before = next(words), int(at), ""
        if action in ("received", "packet"):
            # Repetitions after a time-out are sent before these bytes arrive.
            reply += [_shown(event, tested) for event in tested.tick(now)]
            before = _output(tested)
        reply += _reaction(tested, now, action, words)
        reply.append(before + _output(tested))
        if sent := tested.sent(tested.begun):
            reply.append(_shown(sent, tested))
        if tested.deadline is not None:
            reply.append(f" until deadline={int(tested.deadline)}")
    return "".join(reply)


def _settings(link: Link, words: Words, names: tuple[str, ...]) -> Settings:
    """Return the settings of a script. Settings that it does not contain come from the
    ICD.
    """
    values = {name: maybe(words) for name in names}
    given_values = {name: value for name, value in values.items() if value is not None}
    return link.settings._replace(**given_values)


def stream_client(link: Link, words: Words) -> str:
    """Run a script of the client of a framed link."""
    requests = number(words)
    settings = _settings(link, words, _STREAM_SETTINGS)
    tested = Client(link, settings=settings, requests=requests)
    reply = []
    for at in words:
        reply.append(" step")
        takes = number(words) == 1
        reply += _reaction(tested, int(at), next(words), words)
        if takes:
            reply.append(_output(tested))
        if tested.deadline is not None:
            reply.append(f" until deadline={int(tested.deadline)}")
    return "".join(reply)


def _reaction(tested: Client, now: int, action: str, words: Words) -> list[str]:
    """Return the events of an action, or its error."""
    try:
        events = _happened(tested, now, action, words)
    except BusyError:
        return [" error error=busy"]
    except UnsupportedError:
        return [" error error=unsupported"]
    except UnknownIdError:
        return [" error error=unknown-id"]
    except LengthError as error:
        return [f" error error={counted('length', error)}"]
    return [_shown(event, tested) for event in events]


def _bus(words: Words) -> Bus:
    name = next(words)
    return next(bus for bus in _BUSES if bus == name)


def _happened(tested: Client, now: int, action: str, words: Words) -> list[Event]:
    is_framed = tested.bus is None
    if action == "telecommand":
        id, repeat = number(words), number(words) == 1
        reply = None
        if is_framed:
            _is_named, reply = number(words), maybe(words)
        request = Request("telecommand", id, octets(words), repeat)
        tested.start(now, request, reply)
        return []
    if action == "telemetry":
        tested.start(now, Request("telemetry", number(words)))
        return []
    if action == "received":
        return tested.received(now, octets(words))
    if action == "packet":
        return tested.packet(now, packet(words))
    if action in ("transferred", "failed"):
        read = octets(words) if action == "transferred" else None
        return tested.transferred(now, read)
    if action == "cancel":
        kind = next(words) if is_framed else "all"
        if kind == "all":
            tested.cancel()
        else:
            tested.cancel(
                "telemetry" if kind == "telemetry" else "telecommand", number(words)
            )
        return []
    return tested.tick(now)


def _output(tested: Client) -> str:
    if tested.bus == "can":
        packets = tested.packets()
        return "".join(
            row("frame", id=packet.id, bytes=packet.data) for packet in packets
        )
    if tested.bus == "i2c":
        transfers = tested.transfers()
        return "".join(row("transfer", write=t.write, read=t.read) for t in transfers)
    lines = []
    while line := tested.output():
        lines.append(row("stream", bytes=line))
    return "".join(lines)


def _shown(event: Event, tested: Client) -> str:
    is_framed = tested.bus is None
    if isinstance(event, LineError):
        return row(event.error, id=event.id)
    if isinstance(event, Arrived) and is_framed:
        return row("message", id=event.id, bytes=event.data, **event.values)
    hidden = ["type", "log", "handle", "values"] + ["reply"] * (not is_framed)
    if isinstance(event, (Refused, Busy)):
        hidden += ["reason", "data"]
        hidden += ["parameter"] if is_framed else []
    names = [field.name for field in fields(event) if field.name not in hidden]
    facts = {"bytes" if key == "data" else key: getattr(event, key) for key in names}
    if "may_be_damaged" in facts:
        facts["may_be_damaged"] = 1 if facts["may_be_damaged"] else None
    return row(type(event).__name__.lower(), **facts)


def packet(words: Words) -> CanPacket:
    return CanPacket(number(words), octets(words))


def procedure(link: Link, words: Words) -> str:
    """Run a script of a procedure of the ICD."""
    name = list(link.procedures)[number(words)]
    form = link.procedures[name]
    bus, block, data = _bus(words), maybe(words), octets(words)
    numbers = [maybe(words) for _ in range(number(words))]
    names = [field.name for field in form.inputs if not field.is_bytes]
    tested = Procedure(link, name, dict(zip(names, numbers)), data, block)
    tested.bus = bus
    reply = []
    for at in words:
        event = _client_event(next(words), words)
        if event is not None:
            tested.event(int(at), event)
        reply.append(_step(tested, int(at)))
    reply += [row("block", offset=at, bytes=data) for at, data in tested.blocks]
    reply += [row("entry", bytes=frame) for frame in tested.frames]
    if form.blocks and form.blocks.sends:
        reply.append(row("ok", sent=tested.progress[0]))
    if form.outputs and tested.result == "done":
        outputs = [tested.output(field.name) for field in form.outputs]
        reply.append(row("ok", outputs=listed(outputs)))
    return "".join(reply)


def _step(procedure: Procedure, now: int) -> str:
    facts: dict[str, object] = {}
    request = procedure.next(now)
    if request is not None:
        facts[request.kind] = request.id
        if request.kind == "telecommand":
            facts.update(bytes=request.data, repeat=int(request.repeat))
    until = procedure.deadline
    deadline = None if until is None else int(until)
    return row("step", **facts, deadline=deadline, result=procedure.result)


def _client_event(name: str, words: Words) -> Optional[Event]:
    """Return an event of the client from a script."""
    if name == "done":
        return Done(0, 1, octets(words))
    if name == "arrived":
        return Arrived(number(words), octets(words), {})
    if name == "damaged":
        return Refused(0, 1, may_be_damaged=True)
    return _OUTCOMES[name](0, 1) if name in _OUTCOMES else None
