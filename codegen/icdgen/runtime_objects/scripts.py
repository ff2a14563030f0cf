"""Scripts of clients: timed inputs, and the reaction to each.

`client` (UART, I2C or CAN) and `stream_client` (framed link) run a client of the Python
runtime with the rows of a JSON request. A row starts or cancels a request, delivers
received data, or only lets time pass. Each returned step has the output, the events and
the next deadline. ``tests/conformance/README.md`` describes the scripts.
"""

from __future__ import annotations

from typing import Any, get_args

from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire import events
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.link import Bus, Settings

from icdgen.protocol.declared import U32, facts_of
from icdgen.protocol.packet_formats import DIRECTIONS
from icdgen.protocol.sections import Settings as SettingsSection
from icdgen.runtime_objects.operations import AnyLink, can_packet
from icdgen.runtime_objects.refusals import Refusal, details_of
from icdgen.runtime_objects.request_keys import (
    choice,
    flag,
    hex_bytes,
    mappings,
    number,
    octets,
)

MOST_REQUESTS = 3  # requests that are in progress or waiting

Row = dict[str, Any]
BUSES: tuple[Bus, ...] = get_args(Bus)


def client(link: AnyLink, request: Row) -> Row:
    """Return the reactions of a client on UART, I2C or CAN to a script."""
    tested_client = Client(
        link,
        choice(request, "bus", BUSES),
        crc=flag(request, "crc"),
        address=number(request, "address", 0, 255, 0),
        settings=_settings(link, request),
        requests=1,
    )
    return _steps(request, tested_client)


def stream_client(link: AnyLink, request: Row) -> Row:
    """Return the reactions of a client of a framed link to a script."""
    requests = number(request, "requests", 1, MOST_REQUESTS, 1)
    tested_client = Client(link, settings=_settings(link, request), requests=requests)
    return _steps(request, tested_client)


def _settings(link: AnyLink, request: Row) -> Settings:
    """Return the settings of a client.

    Settings that the request does not have are taken from the ICD.
    """
    given = request.get("settings", {})
    if not isinstance(given, dict):
        raise Refusal("request", detail="`settings` is no object")
    values = {}
    for fact in facts_of(SettingsSection):
        default = getattr(link.settings, fact.name)
        most = fact.most or U32
        values[fact.name] = number(given, fact.name, fact.least, most, default)
    return Settings(**values)


def _steps(request: Row, tested_client: Client[Any]) -> Row:
    """Return the reaction of a client to each row of a script."""
    steps = []
    for row in mappings(request, "script"):
        refusal: Row = {}
        reported: list[events.Event] = []
        output: list[object] = []
        now = number(row, "at")
        try:
            if tested_client.bus in ("uart", "can") and "receive" in row:
                # What a time-out sends again is sent before this arrives.
                reported += tested_client.tick(now)
                output += _output_of(tested_client)
            reported += _events_of(tested_client, now, row)
        except IcdError as error:
            refusal = details_of(error)
        if not flag(row, "untaken"):  # a caller that does not read the output yet
            output += _output_of(tested_client)
        if tested_client.bus and (sent := tested_client.sent(tested_client.begun)):
            # On a bus, the application waits for nothing after it has sent.
            reported.append(sent)
        deadline = tested_client.deadline
        steps.append(
            {
                **refusal,
                "out": output,
                "events": [_row_of(tested_client, event) for event in reported],
                "deadline": None if deadline is None else int(deadline),
            }
        )
    return {"steps": steps}


def _events_of(tested_client: Client[Any], now: int, row: Row) -> list[events.Event]:
    kind = next((kind for kind in DIRECTIONS if kind in row), None)
    largest_id = 255 if tested_client.bus else U32
    id = number(row, kind, 0, largest_id) if kind else None
    if flag(row, "cancel"):
        tested_client.cancel(kind, id)
        return []
    if kind and id is not None:
        data = octets(row) if kind == "telecommand" else b""
        reply = number(row, "reply") if "reply" in row else None
        started = Request(kind, id, data, flag(row, "repeat"))
        tested_client.start(now, started, reply)
        return []
    if "receive" not in row:
        return tested_client.tick(now)
    received = row["receive"]
    if tested_client.bus == "can":
        if not isinstance(received, dict):
            raise Refusal("request", detail="`receive` is no packet")
        return tested_client.packet(now, can_packet(received))
    if tested_client.bus == "i2c":
        read = None if received is None else hex_bytes(received)
        return tested_client.transferred(now, read)
    return tested_client.received(now, hex_bytes(received))


def _output_of(tested_client: Client[Any]) -> list[object]:
    if tested_client.bus == "can":
        return [
            {"id": packet.id, "bytes": packet.data.hex()}
            for packet in tested_client.packets()
        ]
    if tested_client.bus == "i2c":
        return [
            {"write": transfer.write.hex(), "read": transfer.read}
            for transfer in tested_client.transfers()
        ]
    lines: list[object] = []
    while line := tested_client.output():
        lines.append(line.hex())
    return lines


def _row_of(tested_client: Client[Any], event: events.Event) -> Row:
    """Return an event as a mapping."""
    row = _row(event)
    if tested_client.bus is None:
        return row
    if isinstance(event, events.Arrived):
        row["event"] = "arrived"
    if isinstance(event, events.Refused):
        row["parameter"] = event.parameter
        row |= {"may_be_damaged": True} if event.may_be_damaged else {}
    row.pop("reply", None)  # on a bus, a request names its reply
    return row


def _row(event: events.Event) -> Row:
    """Return an event of a framed link as a mapping."""
    row: Row
    match event:
        case events.LineError(error, id):
            return {"event": error} | ({} if id is None else {"id": id})
        case events.Arrived(id, data, values):
            return {"event": "message", "id": id, "bytes": data.hex(), **values}
        case events.Gap(id, missing):
            return {"event": "gap", "id": id, "missing": missing}
        case events.Log(data):
            row = {"bytes": data.hex()}
        case events.Done(id, attempts, data, _, reply):
            # A packet without a message has no id of telemetry.
            named = {} if reply is None else {"reply": reply}
            row = {"id": id, "attempts": attempts, **named, "bytes": data.hex()}
        case events.Refused(id, attempts, code) | events.Busy(id, attempts, code):
            row = {"id": id, "attempts": attempts, "code": code}
        case events.Timeout(id, attempts) | events.Sent(id, attempts):
            row = {"id": id, "attempts": attempts}
        case events.Reply(id, data, _, reply):
            row = {"id": id, "reply": reply, "bytes": data.hex()}
        case events.Progress(id, data) | events.Late(id, data):
            row = {"id": id, "bytes": data.hex()}
        case events.Stray(data, id):
            row = ({} if id is None else {"id": id}) | {"bytes": data.hex()}
    return {"event": type(event).__name__.lower(), **row}
