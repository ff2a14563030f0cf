"""Scripts for the client and for the procedures: what happens at which time, and what they do then."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from icdgen.icd.model import TELECOMMAND, TELEMETRY
from icdgen.protocol import can, programs, transfer
from icdgen.protocol import stream_client as enveloped
from icdgen.protocol.client import Client, Event, Request
from icdgen.protocol.errors import BusyError, LengthError, Refused, UnknownIdError
from icdgen.protocol.facts import Facts, Unsupported
from icdgen.protocol.request_keys import Refusal, flag, hex_bytes, mappings, number, octets, text
from icdgen.protocol.sections import BUSES, CAN, I2C, UART, Settings

MOST_REQUESTS = 3  # that are under way together
LONGEST = 1 << 20  # how often the bytes of an upload are repeated at most

Talking = TypeVar("Talking", Client, enveloped.Client)


def client(known: Facts, request: dict[str, Any]) -> dict[str, Any]:
    """The op ``client``."""
    bus, settings = _bus(request), _settings(known, request)
    talking = Client(known, bus, flag(request, "crc"), number(request, "address", 0, 255, 0), settings)
    refused = (BusyError, UnknownIdError, LengthError)
    rows = mappings(request, "script")
    return {"steps": [_step(talking, row, _client_events, _client_output, refused) for row in rows]}


def stream_client(known: Facts, request: dict[str, Any]) -> dict[str, Any]:
    """The op ``stream_client``."""
    talking = enveloped.Client(known, number(request, "requests", 1, MOST_REQUESTS, 1), _settings(known, request))
    refused = (BusyError, UnknownIdError, LengthError, Unsupported)
    rows = mappings(request, "script")
    return {"steps": [_step(talking, row, _stream_events, _stream_output, refused) for row in rows]}


def _bus(request: dict[str, Any]) -> str:
    bus = text(request, "bus")
    if bus not in BUSES:
        raise Refusal("request", detail="there is no such bus")
    return bus


def _settings(known: Facts, request: dict[str, Any]) -> Settings:
    given, default = request.get("settings", {}), known.client
    if not isinstance(given, dict):
        raise Refusal("request", detail="`settings` is no object")
    return Settings(
        number(given, "reply_timeout", 1, default=default.reply_timeout),
        number(given, "retries", 0, 255, default.retries),
        number(given, "poll_interval", 1, default=default.poll_interval),
        number(given, "poll_timeout", 1, default=default.poll_timeout),
    )


def _step(
    talking: Talking,
    row: dict[str, Any],
    events_of: Callable[[Talking, int, dict[str, Any]], list[Event]],
    output: Callable[[Talking, dict[str, Any]], list[object]],
    refused: tuple[type[Refused], ...],
) -> dict[str, Any]:
    """What a client does at a time."""
    refusal: dict[str, Any] = {}
    events: list[Event] = []
    try:
        events = events_of(talking, number(row, "at"), row)
    except refused as error:
        refusal = error.told
    return {**refusal, "out": output(talking, row), "events": events, "deadline": talking.deadline}


def _client_events(talking: Client, now: int, row: dict[str, Any]) -> list[Event]:
    if "telecommand" in row:
        request = Request(TELECOMMAND, number(row, "telecommand", 0, 255), octets(row), flag(row, "repeat"))
        return talking.start(now, request)
    if "telemetry" in row:
        return talking.start(now, Request(TELEMETRY, number(row, "telemetry", 0, 255)))
    if "receive" in row:
        return _receive(talking, now, row["receive"])
    if flag(row, "cancel"):
        talking.cancel()
        return []
    return talking.tick(now)


def _client_output(talking: Client, row: dict[str, Any]) -> list[object]:
    out, talking.out = talking.out, []
    return [_sent(talking.bus, one) for one in out]


def _receive(talking: Client, now: int, given: Any) -> list[Event]:
    if talking.bus == UART:
        return talking.received(now, hex_bytes(given))
    if talking.bus == I2C:
        return talking.transferred(now, None if given is None else hex_bytes(given))
    if not isinstance(given, dict):
        raise Refusal("request", detail="`receive` is no packet")
    return talking.packet(now, can.Packet(number(given, "id", 0, (1 << 29) - 1), octets(given)))


def _sent(bus: str, one: Any) -> object:
    if bus == UART:
        return one.hex()
    if bus == CAN:
        return {"id": one.id, "bytes": one.data.hex()}
    return {"write": one[0].hex(), "read": one[1]}


def _stream_events(talking: enveloped.Client, now: int, row: dict[str, Any]) -> list[Event]:
    kind = next((kind for kind in (TELECOMMAND, TELEMETRY) if kind in row), None)
    id = number(row, kind) if kind else None
    if flag(row, "cancel"):
        talking.cancel(kind, id)
        return []
    if kind and id is not None:
        data = octets(row) if kind == TELECOMMAND else b""
        reply = number(row, "reply") if "reply" in row else None
        return talking.start(now, Request(kind, id, data, flag(row, "repeat"), reply))
    return talking.received(now, hex_bytes(row["receive"])) if "receive" in row else talking.tick(now)


def _stream_output(talking: enveloped.Client, row: dict[str, Any]) -> list[object]:
    return [] if flag(row, "untaken") else [line.hex() for line in talking.output()]


def file(known: Facts, request: dict[str, Any]) -> dict[str, Any]:
    """The op ``file``."""
    procedure = procedure_of(known, request)
    steps = []
    for row in mappings(request, "script"):
        now, event = number(row, "at"), row.get("event")
        if event is not None:
            procedure.event(now, _event(event))
        asked = procedure.next(now)
        steps.append({"request": _asked(asked), "deadline": procedure.deadline, "result": procedure.result})
    answer: dict[str, Any] = {"steps": steps}
    if isinstance(procedure, transfer.Download):
        answer["blocks"] = [{"offset": offset, "bytes": data.hex()} for offset, data in procedure.blocks]
    elif isinstance(procedure, transfer.FileList):
        answer["entries"] = procedure.entries
    elif isinstance(procedure, transfer.Upload):
        answer["sent"] = procedure.sent
    elif isinstance(procedure, programs.ProgramInformation):
        answer |= {"size": procedure.size, "checksum": procedure.checksum}
    return answer


def _event(event: object) -> dict[str, Any]:
    """An event of the client as it stands in a script: the keys that a procedure looks at."""
    if not isinstance(event, dict) or text(event, "event") not in (*transfer.OUTCOMES, "packet"):
        raise Refusal("request", detail="there is no such event")
    if event["event"] == "packet":
        number(event, "number", 0, 65535)
    if event["event"] in ("packet", "done"):
        octets(event)
    return event


def _asked(asked: Request | None) -> dict[str, Any] | None:
    if asked is None:
        return None
    if asked.kind == TELEMETRY:
        return {"telemetry": asked.id}
    return {"telecommand": asked.id, "bytes": asked.data.hex(), "repeat": asked.repeat}


def _file(request: dict[str, Any]) -> tuple[int, int]:
    """Type and counter."""
    return number(request, "type", 0, 255), number(request, "counter", 0, 255)


def procedure_of(known: Facts, request: dict[str, Any]) -> transfer.Procedure:
    """The procedure that a request of the op ``file`` means."""
    name = text(request, "do")
    block = number(request, "block", 1) if "block" in request else None
    if name == "list":
        return transfer.FileList(known)
    if name == "download":
        bus = _bus(request)
        size = number(request, "size") if "size" in request else None
        return transfer.Download(known, bus, *_file(request), size, block)
    if name == "upload":
        times = number(request, "times", 1, LONGEST, 1)
        return transfer.Upload(known, number(request, "destination", 0, 255), octets(request) * times, block)
    if name == "erase":
        return transfer.Erase(known, *_file(request), flag(request, "all"))
    if name == "format":
        return transfer.Format(known)
    if name == "program_copy":
        return programs.ProgramCopy(known, number(request, "program", 0, 255))
    if name == "program_information":
        return programs.ProgramInformation(known, number(request, "program", 0, 255))
    raise Refusal("request", detail="there is no such procedure")
