"""Scripts of procedures: timed events, and the next request after each.

``tests/conformance/README.md`` describes them.
"""

from __future__ import annotations

from typing import Any

from icdgen_runtime.wire.client import Request
from icdgen_runtime.wire.events import AnyDone, Done, Packet, Refused, Timeout
from icdgen_runtime.wire.file_procedures import RoleProcedure
from icdgen_runtime.wire.programs import ProgramCopy, ProgramInformation
from icdgen_runtime.wire.transfer import Download, Erase, FileList, Format, Upload

from icdgen.runtime_objects.operations import AnyLink
from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import (
    choice,
    flag,
    mappings,
    number,
    octets,
    text,
)
from icdgen.runtime_objects.scripts import BUSES

LONGEST = 1 << 20  # maximum repetitions of the bytes of an upload
UNKNOWN_CODE = 255  # code of a refusal that the ICD does not define

Row = dict[str, Any]
ProcedureEvent = AnyDone | Refused | Timeout | Packet


def file(link: AnyLink, request: Row) -> Row:
    """Return what a procedure does in a script."""
    procedure, steps = procedure_of(link, request), []
    for row in mappings(request, "script"):
        now = number(row, "at")
        if (event := row.get("event")) is not None:
            procedure.event(now, event_of(event))
        next_request, deadline = procedure.next(now), procedure.deadline
        steps.append(
            {
                "request": _request_row(next_request),
                "deadline": None if deadline is None else int(deadline),
                "result": procedure.result,
            }
        )
    return {"steps": steps, **_results(procedure)}


def _results(procedure: RoleProcedure) -> Row:
    match procedure:
        case Download():
            blocks = procedure.blocks
            return {
                "blocks": [{"offset": at, "bytes": data.hex()} for at, data in blocks]
            }
        case FileList():
            return {"entries": [entry._asdict() for entry in procedure.entries]}
        case Upload():
            return {"sent": procedure.progress[0]}
        case ProgramInformation():
            return {"size": procedure.size, "checksum": procedure.checksum}
    return {}


def event_of(row: object) -> ProcedureEvent:
    """Return the event of a row: only what procedures use."""
    name = text(row, "event") if isinstance(row, dict) else None
    match row, name:
        case dict(), "packet":
            return Packet(number(row, "number", 0, 65535), octets(row))
        case dict(), "done":
            return Done(0, 1, octets(row))
        case dict(), "refused":
            return Refused(0, 1)
        case dict(), "damaged":
            return Refused(0, 1, UNKNOWN_CODE)
        case dict(), "timeout":
            return Timeout(0, 1)
    raise Refusal("request", detail="there is no such event")


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


def procedure_of(link: AnyLink, request: Row) -> RoleProcedure:
    """Return the procedure that a request of the operation ``file`` selects."""
    block = number(request, "block", 1) if "block" in request else None
    match text(request, "do"):
        case "list":
            return FileList(link)
        case "download":
            size = number(request, "size") if "size" in request else None
            return Download(
                link, choice(request, "bus", BUSES), *_file(request), size, block
            )
        case "upload":
            data = octets(request) * number(request, "times", 1, LONGEST, 1)
            destination = number(request, "destination", 0, 255)
            return Upload(link, destination, data, block)
        case "erase":
            return Erase(link, *_file(request), flag(request, "all"))
        case "format":
            return Format(link)
        case "program_copy":
            return ProgramCopy(link, number(request, "program", 0, 255))
        case "program_information":
            return ProgramInformation(link, number(request, "program", 0, 255))
    raise Refusal("request", detail="there is no such procedure")


def _file(request: Row) -> tuple[int, int]:
    """Return type and counter of a file."""
    return number(request, "type", 0, 255), number(request, "counter", 0, 255)
