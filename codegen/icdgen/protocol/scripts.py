"""Scripts of the operations ``client`` and ``file``: timed inputs, and the reaction to
each.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from icdgen.icd.model import TELECOMMAND, TELEMETRY
from icdgen.protocol import can, programs, transfer
from icdgen.protocol.client import Client, Event, Request
from icdgen.protocol.declared import U32, facts_of
from icdgen.protocol.errors import BusyError, LengthError, Refused, UnknownIdError
from icdgen.protocol.facts import Facts
from icdgen.protocol.request_keys import (
    Refusal,
    flag,
    hex_bytes,
    mappings,
    number,
    octets,
    text,
)
from icdgen.protocol.sections import BUSES, CAN, I2C, UART, Settings

LONGEST = 1 << 20  # maximum repetitions of the bytes of an upload

AnyClient = TypeVar("AnyClient")


def client(facts: Facts, request: dict[str, Any]) -> dict[str, Any]:
    """Run the operation ``client``."""
    bus, settings = _bus(request), settings_of(facts, request)
    tested_client = Client(
        facts,
        bus,
        flag(request, "crc"),
        number(request, "address", 0, 255, 0),
        settings,
    )
    refused = (BusyError, UnknownIdError, LengthError)
    rows = mappings(request, "script")
    return {
        "steps": [
            {
                **step(tested_client, row, _client_events, _client_output, refused),
                "deadline": tested_client.deadline,
            }
            for row in rows
        ]
    }


def _bus(request: dict[str, Any]) -> str:
    bus = text(request, "bus")
    if bus not in BUSES:
        raise Refusal("request", detail="there is no such bus")
    return bus


def settings_of(facts: Facts, request: dict[str, Any]) -> Settings:
    """Return the settings of a client: those of the request, then those of the ICD."""
    given, default = request.get("settings", {}), facts.client
    if not isinstance(given, dict):
        raise Refusal("request", detail="`settings` is no object")
    values = {
        fact.name: number(
            given,
            fact.name,
            fact.least,
            fact.most or U32,
            getattr(default, fact.name),
        )
        for fact in facts_of(Settings)
    }
    return Settings(**values)


def step(
    tested_client: AnyClient,
    row: dict[str, Any],
    events_of: Callable[[AnyClient, int, dict[str, Any]], list[Event]],
    output: Callable[[AnyClient, dict[str, Any]], list[object]],
    refused: tuple[type[Refused], ...],
) -> dict[str, Any]:
    """Return the reaction of a client to one row of a script, without its deadline."""
    refusal: dict[str, Any] = {}
    events: list[Event] = []
    try:
        events = events_of(tested_client, number(row, "at"), row)
    except refused as error:
        refusal = error.details
    return {
        **refusal,
        "out": output(tested_client, row),
        "events": events,
    }


def _client_events(tested_client: Client, now: int, row: dict[str, Any]) -> list[Event]:
    if "telecommand" in row:
        request = Request(
            TELECOMMAND,
            number(row, "telecommand", 0, 255),
            octets(row),
            flag(row, "repeat"),
        )
        return tested_client.start(now, request)
    if "telemetry" in row:
        return tested_client.start(
            now, Request(TELEMETRY, number(row, "telemetry", 0, 255))
        )
    if "receive" in row:
        return _receive(tested_client, now, row["receive"])
    if flag(row, "cancel"):
        tested_client.cancel()
        return []
    return tested_client.tick(now)


def _client_output(tested_client: Client, row: dict[str, Any]) -> list[object]:
    out, tested_client.out = tested_client.out, []
    return [_sent(tested_client.bus, item) for item in out]


def _receive(tested_client: Client, now: int, given: Any) -> list[Event]:
    if tested_client.bus == UART:
        return tested_client.received(now, hex_bytes(given))
    if tested_client.bus == I2C:
        return tested_client.transferred(
            now, None if given is None else hex_bytes(given)
        )
    if not isinstance(given, dict):
        raise Refusal("request", detail="`receive` is no packet")
    return tested_client.packet(
        now, can.Packet(number(given, "id", 0, (1 << 29) - 1), octets(given))
    )


def _sent(bus: str, item: Any) -> object:
    if bus == UART:
        return item.hex()
    if bus == CAN:
        return {"id": item.id, "bytes": item.data.hex()}
    return {"write": item[0].hex(), "read": item[1]}


def file(facts: Facts, request: dict[str, Any]) -> dict[str, Any]:
    """Run the operation ``file``."""
    procedure = procedure_of(facts, request)
    steps = []
    for row in mappings(request, "script"):
        now, event = number(row, "at"), row.get("event")
        if event is not None:
            procedure.event(now, _event(event))
        request_now = procedure.next(now)
        steps.append(
            {
                "request": _request_row(request_now),
                "deadline": procedure.deadline,
                "result": procedure.result,
            }
        )
    answer: dict[str, Any] = {"steps": steps}
    if isinstance(procedure, transfer.Download):
        answer["blocks"] = [
            {"offset": offset, "bytes": data.hex()} for offset, data in procedure.blocks
        ]
    elif isinstance(procedure, transfer.FileList):
        answer["entries"] = procedure.entries
    elif isinstance(procedure, transfer.Upload):
        answer["sent"] = procedure.sent
    elif isinstance(procedure, programs.ProgramInformation):
        answer |= {"size": procedure.size, "checksum": procedure.checksum}
    return answer


def _event(event: object) -> dict[str, Any]:
    """Check and return an event of a script: only the keys that procedures use."""
    if not isinstance(event, dict) or text(event, "event") not in (
        *transfer.OUTCOMES,
        "packet",
    ):
        raise Refusal("request", detail="there is no such event")
    if event["event"] == "packet":
        number(event, "number", 0, 65535)
    if event["event"] in ("packet", "done"):
        octets(event)
    return event


def _request_row(request: Request | None) -> dict[str, Any] | None:
    if request is None:
        return None
    if request.kind == TELEMETRY:
        return {"telemetry": request.id}
    return {
        "telecommand": request.id,
        "bytes": request.data.hex(),
        "repeat": request.repeat,
    }


def _file(request: dict[str, Any]) -> tuple[int, int]:
    """Return type and counter of a file."""
    return number(request, "type", 0, 255), number(request, "counter", 0, 255)


def procedure_of(facts: Facts, request: dict[str, Any]) -> transfer.Procedure:
    """Return the procedure that a request of the operation ``file`` selects."""
    name = text(request, "do")
    block = number(request, "block", 1) if "block" in request else None
    if name == "list":
        return transfer.FileList(facts)
    if name == "download":
        bus = _bus(request)
        size = number(request, "size") if "size" in request else None
        return transfer.Download(facts, bus, *_file(request), size, block)
    if name == "upload":
        times = number(request, "times", 1, LONGEST, 1)
        return transfer.Upload(
            facts,
            number(request, "destination", 0, 255),
            octets(request) * times,
            block,
        )
    if name == "erase":
        return transfer.Erase(facts, *_file(request), flag(request, "all"))
    if name == "format":
        return transfer.Format(facts)
    if name == "program_copy":
        return programs.ProgramCopy(facts, number(request, "program", 0, 255))
    if name == "program_information":
        return programs.ProgramInformation(facts, number(request, "program", 0, 255))
    raise Refusal("request", detail="there is no such procedure")
