"""Scripts of clients: timed inputs, and the reaction to each.

``tests/conformance/README.md`` describes them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, get_args

from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire import events
from icdgen_runtime.wire.can import CanPacket
from icdgen_runtime.wire.client import Client, Request
from icdgen_runtime.wire.envelope_client import EnvelopeClient
from icdgen_runtime.wire.i2c import I2cTransfer
from icdgen_runtime.wire.link import Bus, Settings
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen.protocol.declared import U32, facts_of
from icdgen.protocol.envelope import DIRECTIONS
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
AnyClient = TypeVar("AnyClient", Client[Any], EnvelopeClient[Any])


def client(link: AnyLink, request: Row) -> Row:
    """Return what a client on the UART, I2C or CAN does in a script."""
    tested_client = Client(
        link,
        choice(request, "bus", BUSES),
        flag(request, "crc"),
        number(request, "address", 0, 255, 0),
        _settings(link, request),
    )
    return _steps(request, tested_client, _bus_events, _bus_output, _bus_row)


def stream_client(link: AnyLink, request: Row) -> Row:
    """Return what a client of a framed link does in a script."""
    requests = number(request, "requests", 1, MOST_REQUESTS, 1)
    tested_client = EnvelopeClient(link, _settings(link, request), requests=requests)
    return _steps(request, tested_client, _framed_events, _framed_output, _row)


def _settings(link: AnyLink, request: Row) -> Settings:
    """Return the settings of a client: those of the request, then those of the ICD."""
    given = request.get("settings", {})
    if not isinstance(given, dict):
        raise Refusal("request", detail="`settings` is no object")
    values = {
        fact.name: number(
            given,
            fact.name,
            fact.least,
            fact.most or U32,
            getattr(link.settings, fact.name),
        )
        for fact in facts_of(SettingsSection)
    }
    return Settings(**values)


def _steps(
    request: Row,
    tested_client: AnyClient,
    events_of: Callable[[AnyClient, int, Row], list[events.Event]],
    output_of: Callable[[AnyClient, Row], list[object]],
    row_of: Callable[[events.Event], Row],
) -> Row:
    """Return the reaction of a client to each row of a script."""
    steps = []
    for row in mappings(request, "script"):
        refusal: Row = {}
        reported: list[events.Event] = []
        try:
            reported = events_of(tested_client, number(row, "at"), row)
        except IcdError as error:
            refusal = details_of(error)
        output = output_of(tested_client, row)
        deadline = tested_client.deadline
        steps.append(
            {
                **refusal,
                "out": output,
                "events": [row_of(event) for event in reported],
                "deadline": None if deadline is None else int(deadline),
            }
        )
    return {"steps": steps}


def _bus_events(tested_client: Client[Any], now: int, row: Row) -> list[events.Event]:
    if flag(row, "cancel"):
        tested_client.cancel()
        return []
    if "telecommand" in row:
        id, data = number(row, "telecommand", 0, 255), octets(row)
        return tested_client.start(
            now, Request("telecommand", id, data, flag(row, "repeat"))
        )
    if "telemetry" in row:
        id = number(row, "telemetry", 0, 255)
        return tested_client.start(now, Request("telemetry", id))
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


def _bus_output(tested_client: Client[Any], row: Row) -> list[object]:
    output: list[bytes | CanPacket | I2cTransfer] = [
        *tested_client.packets(),
        *tested_client.transfers(),
    ]
    if lines := tested_client.output():
        # A row for each message, as the clients of other languages give them.
        link = tested_client.link
        messages = [event.message for event in UartDecoder(link).feed(lines)]
        output += [uart_encode(link, message) for message in messages]
    return [_sent(item) for item in output]


def _sent(item: bytes | CanPacket | I2cTransfer) -> object:
    match item:
        case bytes():
            return item.hex()
        case CanPacket(id, data):
            return {"id": id, "bytes": data.hex()}
        case I2cTransfer(write, read):
            return {"write": write.hex(), "read": read}


def _framed_events(
    tested_client: EnvelopeClient[Any], now: int, row: Row
) -> list[events.Event]:
    kind = next((kind for kind in DIRECTIONS if kind in row), None)
    id = number(row, kind) if kind else None
    if flag(row, "cancel"):
        tested_client.cancel(kind, id)
        return []
    if kind and id is not None:
        data = octets(row) if kind == "telecommand" else b""
        reply = number(row, "reply") if "reply" in row else None
        return tested_client.start(
            now, Request(kind, id, data, flag(row, "repeat")), reply
        )
    if "receive" in row:
        return tested_client.received(now, hex_bytes(row["receive"]))
    return tested_client.tick(now)


def _framed_output(tested_client: EnvelopeClient[Any], row: Row) -> list[object]:
    # `untaken` simulates a caller that does not read the output yet.
    lines: list[object] = []
    while not flag(row, "untaken") and (line := tested_client.output()):
        lines.append(line.hex())
    return lines


def _bus_row(event: events.Event) -> Row:
    """Return an event on the UART, I2C or CAN as a mapping."""
    if isinstance(event, events.Arrived):
        return {"event": "arrived", "id": event.id, "bytes": event.data.hex()}
    row = _row(event)
    if isinstance(event, events.Refused):
        row |= {"reason": event.reason, "parameter": event.parameter}
    return row


def _row(event: events.Event) -> Row:
    """Return an event as a mapping."""
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
