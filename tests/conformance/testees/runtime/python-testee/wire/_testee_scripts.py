"""Scripts of the testee for the client and for the procedures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .._errors import LengthError, UnknownIdError
from ._testee_link import Refusal, flag, hex_bytes, mappings, number, octets, text
from .can import CanPacket
from .client import Client, Request
from .errors import BusyError
from .events import Done, LineError, Log, Malformed, Packet, Refused, Stray, Timeout
from .link import Settings
from .programs import ProgramCopy, ProgramInformation
from .transfer import Download, Erase, FileList, Format, Upload

if TYPE_CHECKING:
    from .events import Event
    from .link import Bus, Link
    from .procedures import Procedure

    Answer = dict[str, Any]

_BUSES: tuple[Bus, ...] = ("uart", "i2c", "can")


def client(link: Link, request: Answer) -> Answer:
    """What a client does in a script."""
    bus = _bus(request)
    crc, address = flag(request, "crc"), number(request, "address", 0, 255, 0)
    tested = Client(link, bus, crc, address, _settings(link, request))
    steps = [_client_step(tested, row) for row in mappings(request, "script")]
    return {"steps": steps}


def _bus(request: Answer) -> Bus:
    name = text(request, "bus")
    for bus in _BUSES:
        if bus == name:
            return bus
    raise Refusal("request", detail="there is no such bus")


def _settings(link: Link, request: Answer) -> Settings:
    given, default = request.get("settings", {}), link.settings
    if not isinstance(given, dict):
        raise Refusal("request", detail="`settings` is no object")
    most = (1 << 32) - 1

    def time(key: str) -> int:
        return number(given, key, 1, most, int(getattr(default, key)))

    return Settings(
        time("reply_timeout"),
        number(given, "retries", 0, 255, default.retries),
        time("poll_interval"),
        time("poll_timeout"),
    )


def _client_step(tested: Client, row: Answer) -> Answer:
    now = number(row, "at")
    step: Answer = {}
    events: list[Event] = []
    try:
        if "telecommand" in row:
            id = number(row, "telecommand", 0, 255)
            asked = Request("telecommand", id, octets(row), flag(row, "repeat"))
            events = tested.start(now, asked)
        elif "telemetry" in row:
            id = number(row, "telemetry", 0, 255)
            events = tested.start(now, Request("telemetry", id))
        elif "receive" in row:
            events = _receive(tested, now, row["receive"])
        elif flag(row, "cancel"):
            tested.cancel()
        else:
            events = tested.tick(now)
    except BusyError:
        step = {"error": "busy"}
    except UnknownIdError:
        step = {"error": "unknown-id"}
    except LengthError as error:
        counts = {"expected": error.expected, "actual": error.actual}
        step = {"error": "length", **counts}
    shown = [_EVENTS[type(event)](event) for event in events]
    deadline = None if tested.deadline is None else int(tested.deadline)
    return {**step, "out": _sent(tested), "events": shown, "deadline": deadline}


def _receive(tested: Client, now: int, given: Any) -> list[Event]:
    if tested.bus == "uart":
        return tested.received(now, hex_bytes(given))
    if tested.bus == "i2c":
        return tested.transferred(now, None if given is None else hex_bytes(given))
    if not isinstance(given, dict):
        raise Refusal("request", detail="`receive` is no packet")
    packet = CanPacket(number(given, "id", 0, (1 << 29) - 1), octets(given))
    return tested.packet(now, packet)


def _sent(tested: Client) -> list[Any]:
    if tested.bus == "uart":
        messages, tested._stream = tested._stream, []
        return [message.hex() for message in messages]
    if tested.bus == "can":
        return [{"id": p.id, "bytes": p.data.hex()} for p in tested.packets()]
    return [{"write": t.write.hex(), "read": t.read} for t in tested.transfers()]


def _done(event: Done) -> Answer:
    kept = {"id": event.id, "attempts": event.attempts}
    return {"event": "done", "bytes": event.data.hex(), **kept}


def _refused(event: Refused) -> Answer:
    return {
        "event": "refused",
        "code": event.code,
        "reason": event.reason,
        "parameter": event.parameter,
        "id": event.id,
        "attempts": event.attempts,
    }


def _timeout(event: Timeout) -> Answer:
    return {"event": "timeout", "id": event.id, "attempts": event.attempts}


def _packet(event: Packet) -> Answer:
    return {"event": "packet", "number": event.number, "bytes": event.data.hex()}


def _line_error(event: LineError) -> Answer:
    about = {} if event.id is None else {"id": event.id}
    return {"event": event.error, **about}


_EVENTS: dict[type, Any] = {
    Done: _done,
    Refused: _refused,
    Timeout: _timeout,
    Malformed: lambda event: {"event": "malformed", "id": event.id},
    Packet: _packet,
    Log: lambda event: {"event": "log", "bytes": event.data.hex()},
    Stray: lambda event: {"event": "stray", "bytes": event.data.hex()},
    LineError: _line_error,
}


def file(link: Link, request: Answer) -> Answer:
    """What a procedure does in a script."""
    procedure, steps = _procedure(link, request), []
    for row in mappings(request, "script"):
        now = number(row, "at")
        if row.get("event") is not None:
            procedure.event(now, _told(row["event"]))
        asked = _asked(procedure.next(now))
        deadline = None if procedure.deadline is None else int(procedure.deadline)
        result = procedure.result
        steps.append({"request": asked, "deadline": deadline, "result": result})
    answer: Answer = {"steps": steps}
    if isinstance(procedure, Download):
        blocks = [{"offset": at, "bytes": data.hex()} for at, data in procedure.blocks]
        answer["blocks"] = blocks
    elif isinstance(procedure, FileList):
        known = procedure._step("list.information").fields
        answer["entries"] = [
            {name: value for name, value in entry._asdict().items() if name in known}
            for entry in procedure.entries
        ]
    elif isinstance(procedure, Upload):
        answer["sent"] = procedure.sent
    elif isinstance(procedure, ProgramInformation):
        answer.update(size=procedure.size, checksum=procedure.checksum)
    return answer


def _told(event: Any) -> Event:
    """An event of the client as it stands in a script."""
    if not isinstance(event, dict):
        raise Refusal("request", detail="there is no such event")
    name = text(event, "event")
    if name == "done":
        return Done(0, 1, octets(event))
    if name == "refused":
        return Refused(0, 1)
    if name == "timeout":
        return Timeout(0, 1)
    if name == "packet":
        return Packet(number(event, "number", 0, 65535), octets(event))
    raise Refusal("request", detail="there is no such event")


def _asked(request: Request | None) -> Answer | None:
    if request is None:
        return None
    if request.kind == "telemetry":
        return {"telemetry": request.id}
    data, repeat = request.data.hex(), request.repeat
    return {"telecommand": request.id, "bytes": data, "repeat": repeat}


def _procedure(link: Link, request: Answer) -> Procedure:
    name = text(request, "do")
    block = number(request, "block", 1) if "block" in request else None
    if name == "list":
        return FileList(link)
    if name == "format":
        return Format(link)
    if name == "program_copy":
        return ProgramCopy(link, number(request, "program", 0, 255))
    if name == "program_information":
        return ProgramInformation(link, number(request, "program", 0, 255))
    if name == "upload":
        destination = number(request, "destination", 0, 255)
        times = number(request, "times", 1, 1 << 20, 1)
        return Upload(link, destination, octets(request) * times, block)
    if name == "erase":
        type, counter = (number(request, key, 0, 255) for key in ("type", "counter"))
        return Erase(link, type, counter, flag(request, "all"))
    if name != "download":
        raise Refusal("request", detail="there is no such procedure")
    bus = _bus(request)
    size = number(request, "size") if "size" in request else None
    type, counter = (number(request, key, 0, 255) for key in ("type", "counter"))
    return Download(link, bus, type, counter, size, block)
