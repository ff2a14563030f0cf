"""Scripts with the default time limits of the ICD, evaluated at each limit and one
millisecond before it.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

from icdgen_runtime.wire.i2c import i2c_write

from icdgen.icd.model import Message
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import CAN, I2C, UART, Step
from icdgen.runtime_objects.file_procedures import event_of, procedure_of
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests, Script
from icdgen.vectors.wire.node import FileNode

Values = dict[str, Any]  # values of the frame of a step, by role

# Waits of procedures: step, request, values of its frame during the wait, and attribute
# of the time limit.
PROCEDURES_THAT_WAIT: tuple[tuple[str, dict[str, Any], Values, str], ...] = (
    ("list.information", {"do": "list"}, {"busy": 1}, "timeout"),
    (
        "download.ready",
        {"do": "download", "bus": UART, "type": 2, "counter": 0, "size": 1},
        {},
        "ready_timeout",
    ),
    ("upload.initiated", {"do": "upload", "bytes": "00"}, {"busy": 1}, "erase_timeout"),
    (
        "upload.finalized",
        {"do": "upload", "bytes": "00"},
        {"busy": 1},
        "finalize_timeout",
    ),
    (
        "erase.progress",
        {"do": "erase", "type": 2, "counter": 0, "all": True},
        {"busy": 1},
        "timeout",
    ),
    ("format.progress", {"do": "format"}, {"busy": 1}, "timeout"),
)


def scripts(link: AnyLink, facts: Facts) -> Requests:
    """Yield scripts of a client and of procedures without settings."""
    yield from _clients_without_settings(link, facts)
    if not facts.files or not facts.hole_map or not facts.crc16:
        return
    for name, request, values, time in PROCEDURES_THAT_WAIT:
        procedure = facts.files.procedures.get(name.partition(".")[0])
        if procedure is None:
            continue
        if request["do"] == "upload":
            request = {**request, "destination": next(iter(procedure.destinations), 0)}
        for early in (1, 0):
            why = (
                "a millisecond before its time is over"
                if early
                else "when its time is over"
            )
            file_request = {"op": "file", **request}
            script = _never_done(
                link,
                facts,
                file_request,
                name,
                values,
                getattr(procedure, time) - early,
            )
            yield f"{name}: nothing new {why}", {**file_request, "script": script}


def _never_done(
    link: AnyLink,
    facts: Facts,
    request: dict[str, Any],
    name: str,
    values: Values,
    last: int,
) -> Script:
    """Return the script of a procedure whose frame has ``values`` until ``last`` ms
    have passed.
    """
    assert facts.files
    step = facts.files.steps[name]
    node = FileNode(link, facts, UART, Random(f"{facts.node.name} {name}"))
    node.files[2, 0] = bytes(1)
    waiting = {"event": "done", "bytes": step.frame(facts.node, values).hex()}
    procedure, now, first_frame_at = procedure_of(link, request), 0, -1
    script: Script = [{"at": 0}]
    pending = procedure.next(0)
    while pending or procedure.deadline is not None:
        if pending is None:
            assert procedure.deadline is not None
            now = int(procedure.deadline)
            script += [{"at": now - 1}, {"at": now}]
            # The procedure must have given up by now.
            if first_frame_at >= 0 and now > first_frame_at + last:
                break
        elif pending.kind == "telemetry" and pending.id == step.message.telemetry_id:
            first_frame_at, now = (
                (now, now + 1)
                if first_frame_at < 0
                else (first_frame_at, first_frame_at + last)
            )
            script.append({"at": now, "event": waiting})
            procedure.event(now, event_of(waiting))
        else:
            for event in node.answer(pending):
                now += 1
                script.append({"at": now, "event": event})
                procedure.event(now, event_of(event))
        pending = procedure.next(now)
    return script


def _clients_without_settings(link: AnyLink, facts: Facts) -> Requests:
    frame = next(iter(facts.telemetry.values()), None)
    if frame is None:
        return
    waits = {UART: facts.framing, CAN: facts.can}
    request_row = {"at": 0, "telemetry": frame.telemetry_id}
    patience, tries = facts.client.reply_timeout, facts.client.retries + 1
    for bus in (bus for bus, form in waits.items() if form):
        rows = [
            {"at": patience * n + late} for n in range(1, tries + 1) for late in (-1, 0)
        ]
        yield f"{bus}: silence", {
            "op": "client",
            "bus": bus,
            "script": [request_row, *rows, {"at": patience * (tries + 1)}],
        }
    sent = next((m for m in facts.telecommands.values() if m.acknowledge), None)
    if sent is not None and facts.polled and facts.i2c_address is not None:
        for early in (1, 0):
            why = (
                "a millisecond before its time is over"
                if early
                else "when its time is over"
            )
            yield f"{I2C}: not processed {why}", {
                "op": "client",
                "bus": I2C,
                "script": list(_polls(link, facts, sent, early)),
            }


def _polls(
    link: AnyLink, facts: Facts, sent: Message, early: int
) -> Iterator[dict[str, Any]]:
    """Yield a telecommand that is not processed within its time limit."""
    assert facts.polled
    data = Step(facts.polled.message, {"id": facts.polled.id}).frame(
        facts.node, {"id": sent.telecommand_id or 0}
    )
    state = i2c_write(link, facts.polled.message.telemetry_id or 0, data, False)[
        1:
    ].hex()
    yield {
        "at": 0,
        "telecommand": sent.telecommand_id,
        "bytes": bytes(sent.length).hex(),
    }
    yield {"at": 1, "receive": ""}
    pause, end = facts.client.poll_interval, 1 + facts.client.poll_timeout
    yield from (
        {"at": pause},
        {"at": 1 + pause},
        {"at": 2 + pause, "receive": state},
        {"at": 1 + 2 * pause},
    )
    poll_at = max(2 + 2 * pause, end - 2)
    last = max(poll_at, end - early)
    yield from ({"at": poll_at}, {"at": last, "receive": state}, {"at": last + pause})
