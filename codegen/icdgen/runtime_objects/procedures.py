"""Scripts of procedures: timed events, and the next request after each.

`procedure` runs a procedure of the Python runtime with the events of a JSON request. It
returns request, deadline and result after each event, and the results of the procedure.
`event_of` and `row_of` convert events from and to JSON, also for vectors and tests.
``tests/conformance/README.md`` describes the scripts.
"""

from __future__ import annotations

from typing import Any

from icdgen_runtime.wire import events
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.errors import UnsupportedError
from icdgen_runtime.wire.procedures import Procedure

from icdgen.runtime_objects.operations import AnyLink
from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import (
    choice,
    mappings,
    number,
    octets,
    text,
)
from icdgen.runtime_objects.scripts import BUSES

LONGEST = 1 << 20  # maximum repetitions of the bytes to send

Row = dict[str, Any]


def procedure(link: AnyLink, request: Row) -> Row:
    """Return what a procedure does in a script."""
    tested_procedure, steps = procedure_of(link, request), []
    for row in mappings(request, "script"):
        now = number(row, "at")
        if (event := row.get("event")) is not None:
            tested_procedure.event(now, event_of(event))
        next_request, deadline = tested_procedure.next(now), tested_procedure.deadline
        steps.append(
            {
                "request": _request_row(next_request),
                "deadline": None if deadline is None else int(deadline),
                "result": tested_procedure.result,
            }
        )
    return {"steps": steps, **_results(tested_procedure)}


def _results(procedure: Procedure) -> Row:
    form, results = procedure.form, Row()
    if form.blocks and form.blocks.sends:
        results["sent"] = procedure.progress[0]
    elif form.blocks:
        blocks = procedure.blocks
        results["blocks"] = [{"offset": at, "bytes": data.hex()} for at, data in blocks]
    if form.entry is not None:
        results["entries"] = [frame.hex() for frame in procedure.frames]
    if form.outputs:
        names = [output.name for output in form.outputs]
        results["outputs"] = {name: procedure.output(name) for name in names}
    return results


def event_of(row: object) -> events.Event:
    """Return the event of a row: only what procedures use."""
    # Id and number of attempts are 0 and 1: procedures do not look at them.
    name = text(row, "event") if isinstance(row, dict) else None
    match row, name:
        case dict(), "done":
            return events.Done(0, 1, octets(row))
        case dict(), "sent":
            return events.Sent(0, 1)
        case dict(), "busy":
            return events.Busy(0, 1)
        case dict(), "refused":
            return events.Refused(0, 1)
        case dict(), "damaged":
            return events.Refused(0, 1, may_be_damaged=True)
        case dict(), "timeout":
            return events.Timeout(0, 1)
        case dict(), "arrived":
            return events.Arrived(number(row, "id"), octets(row), {})
    raise Refusal("request", detail="there is no such event")


def row_of(event: events.Event) -> Row:
    """Return an event that procedures use as a row. See `event_of`."""
    match event:
        case events.Done(data=data):
            return {"event": "done", "bytes": data.hex()}
        case events.Arrived(id, data):
            return {"event": "arrived", "id": id, "bytes": data.hex()}
        case events.Refused() if event.may_be_damaged:
            return {"event": "damaged"}
    return {"event": type(event).__name__.lower()}


def _request_row(request: Request | None) -> Row | None:
    if request is None:
        return None
    if request.kind == "telemetry":
        return {"telemetry": request.id}
    return {
        "telecommand": request.id,
        "bytes": request.data.hex(),
        "repeat": request.repeat,
    }


def procedure_of(link: AnyLink, request: Row) -> Procedure:
    """Return the procedure that a request selects."""
    name, inputs = text(request, "name"), request.get("inputs", {})
    bus = choice(request, "bus", BUSES) if "bus" in request else BUSES[0]
    block = number(request, "block", 1) if "block" in request else None
    data = b""
    if "bytes" in request:
        data = octets(request) * number(request, "times", 1, LONGEST, 1)
    if name not in link.procedures:
        raise UnsupportedError(f"the ICD has no procedure `{name}`")
    numbers = [form for form in link.procedures[name].inputs if not form.is_bytes]
    if not isinstance(inputs, dict) or inputs.keys() - {form.name for form in numbers}:
        raise Refusal("request", detail="`inputs` has no numbers of the procedure")
    values = {
        form.name: number(inputs, form.name)
        for form in numbers
        if form.name in inputs or not form.is_optional
    }
    created = Procedure(link, name, values, data, block)
    created.bus = bus
    return created
