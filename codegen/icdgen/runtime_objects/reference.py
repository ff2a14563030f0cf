"""Reference of the wire layer: `icdgen.protocol.ops`, and for framed links the Python
runtime itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from icdgen_runtime._errors import LengthError as RuntimeLengthError
from icdgen_runtime._errors import RangeError as RuntimeRangeError
from icdgen_runtime._errors import UnknownIdError as RuntimeUnknownIdError
from icdgen_runtime.wire import events, stream
from icdgen_runtime.wire.client import Request
from icdgen_runtime.wire.envelope import Direction
from icdgen_runtime.wire.envelope_client import EnvelopeClient
from icdgen_runtime.wire.errors import BusyError as RuntimeBusyError
from icdgen_runtime.wire.errors import UnsupportedError
from icdgen_runtime.wire.link import Link, Settings

from icdgen.icd.model import Icd
from icdgen.protocol import errors, ops
from icdgen.protocol.envelope import DIRECTIONS, GIVEN
from icdgen.protocol.facts import Facts, Unsupported, need
from icdgen.protocol.request_keys import (
    Refusal,
    flag,
    hex_bytes,
    mappings,
    number,
    octets,
    rows,
    text,
)
from icdgen.protocol.scripts import settings_of, step
from icdgen.runtime_objects.links import link_of

MOST_REQUESTS = 3  # requests that are in progress or waiting
Row = dict[str, Any]
FramedOperation = Callable[[Link[Any], Facts, Row], dict[str, Any]]


def answer(icd: Icd, request: Row) -> dict[str, Any]:
    """Return the response to a request.

    ``op`` must be one of `OPS`.
    """

    def framed(operation: FramedOperation) -> ops.Operation:
        def answer_of(facts: Facts, request: Row) -> dict[str, Any]:
            need(facts.stream, "stream")
            return operation(link_of(icd, facts), facts, request)

        return answer_of

    own = {operation.__name__: framed(operation) for operation in FRAMED_OPERATIONS}
    return ops.answer(icd, request, {**ops.OPS, **own})


def stream_encode(link: Link[Any], facts: Facts, request: Row) -> dict[str, Any]:
    id, data, values = number(request, "id"), octets(request), request.get("values", {})
    if not isinstance(values, dict) or not set(values) <= set(GIVEN):
        raise Refusal(
            "request", detail="`values` has the fields that the sender chooses, by role"
        )
    chosen = {role: number(values, role) for role in values}
    with _errors_of_reference():
        if request.get("direction") == "request":
            line = stream.stream_encode_request(link, id, **chosen)
        else:
            line = stream.stream_encode(link, id, data, _direction(request), **chosen)
    return {"bytes": line.hex()}


def stream_events(link: Link[Any], facts: Facts, request: Row) -> dict[str, Any]:
    direction, form = _direction(request), need(link.stream, "stream")
    least = max(packet.overhead for packet in form.packets)
    limit = number(request, "limit", least, link.longest, link.longest)
    decoder = stream.StreamDecoder(link, direction, limit)
    chunks = [hex_bytes(chunk) for chunk in rows(request, "chunks")]
    return {
        "events": [
            _stream_row(each) for chunk in chunks for each in decoder.feed(chunk)
        ],
        "discarded": decoder.discarded,
        "pending": decoder.pending,
    }


def _direction(request: Row) -> Direction:
    direction = text(request, "direction")
    for known in DIRECTIONS:
        if direction == known:
            return known
    raise Refusal("request", detail="there is no such direction")


def _stream_row(event: stream.StreamEvent) -> Row:
    row: Row = {"event": event.event}
    if event.id is not None:
        row["id"] = event.id
    if event.packet is not None:
        row["packet"] = event.packet
    if event.event in ("message", "packet"):
        row["bytes"] = event.data.hex()
    row |= event.values
    if event.event == "gap":
        row["missing"] = event.missing
    return row


@contextmanager
def _errors_of_reference() -> Iterator[None]:
    """Raise errors of the runtime as those of the reference implementation."""
    try:
        yield
    except RuntimeBusyError:
        raise errors.BusyError from None
    except UnsupportedError:
        raise Unsupported from None
    except RuntimeUnknownIdError:
        raise errors.UnknownIdError from None
    except RuntimeLengthError as error:
        raise errors.LengthError(error.expected, error.actual) from None
    except RuntimeRangeError as error:
        raise Refusal("range", field=error.field) from None


def stream_client(link: Link[Any], facts: Facts, request: Row) -> dict[str, Any]:
    """Return what a client does in a script."""
    requests = number(request, "requests", 1, MOST_REQUESTS, 1)
    values = settings_of(facts, request)
    settings = Settings(*(getattr(values, name) for name in Settings._fields))
    client = EnvelopeClient(link, settings, requests=requests)
    refused = (
        errors.BusyError,
        errors.UnknownIdError,
        errors.LengthError,
        Unsupported,
    )
    return {
        "steps": [
            {
                **step(client, row, _events, _output, refused),
                "deadline": _deadline(client),
            }
            for row in mappings(request, "script")
        ]
    }


def _events(client: EnvelopeClient[Any], now: int, row: Row) -> list[Row]:
    kind = next((kind for kind in DIRECTIONS if kind in row), None)
    id = number(row, kind) if kind else None
    if flag(row, "cancel"):
        client.cancel(kind, id)
        return []
    if kind and id is not None:
        data = octets(row) if kind == "telecommand" else b""
        reply = number(row, "reply") if "reply" in row else None
        _start(client, now, Request(kind, id, data, flag(row, "repeat")), reply)
        return []
    reported = (
        client.received(now, hex_bytes(row["receive"]))
        if "receive" in row
        else client.tick(now)
    )
    return [_event_row(event) for event in reported]


def _start(
    client: EnvelopeClient[Any], now: int, request: Request, reply: int | None
) -> None:
    with _errors_of_reference():
        client.start(now, request, reply)


def _output(client: EnvelopeClient[Any], row: Row) -> list[object]:
    # `untaken` simulates a caller that does not read the output yet.
    lines: list[object] = []
    while not flag(row, "untaken") and (line := client.output()):
        lines.append(line.hex())
    return lines


def _deadline(client: EnvelopeClient[Any]) -> int | None:
    return None if client.deadline is None else int(client.deadline)


def _event_row(event: events.Event) -> Row:
    """Return an event as a mapping."""
    match event:
        case events.LineError(error, id):
            return {"event": error} | ({} if id is None else {"id": id})
        case events.Arrived(id, data, values):
            return {"event": "message", "id": id, "bytes": data.hex(), **values}
        case events.Gap(id, missing):
            return {"event": "gap", "id": id, "missing": missing}
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
            row = {"id": id, "bytes": data.hex()}
        case _:
            raise TypeError(f"no event of a framed link: {event}")
    return {"event": type(event).__name__.lower(), **row}


FRAMED_OPERATIONS = (stream_encode, stream_events, stream_client)
OPS = frozenset((*ops.OPS, *(each.__name__ for each in FRAMED_OPERATIONS)))
