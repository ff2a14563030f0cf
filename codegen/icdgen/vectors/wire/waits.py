"""How long is waited where nobody says otherwise: the times of the ICD, a millisecond before they end and when they do."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

from icdgen.icd.model import TELEMETRY, Message
from icdgen.protocol import i2c
from icdgen.protocol.facts import Facts
from icdgen.protocol.scripts import procedure_of
from icdgen.protocol.sections import CAN, I2C, UART, Step
from icdgen.vectors.wire import Requests, Script
from icdgen.vectors.wire.node import FileNode

Values = dict[str, Any]  # what the frame of a step says, by role

# Where a procedure waits: its request, what its frame says meanwhile, and how the time is called.
PROCEDURES_THAT_WAIT: tuple[tuple[str, dict[str, Any], Values, str], ...] = (
    ("list.information", {"do": "list"}, {"busy": 1}, "timeout"),
    ("download.ready", {"do": "download", "bus": UART, "type": 2, "counter": 0, "size": 1}, {}, "ready_timeout"),
    ("upload.initiated", {"do": "upload", "bytes": "00"}, {"busy": 1}, "erase_timeout"),
    ("upload.finalized", {"do": "upload", "bytes": "00"}, {"busy": 1}, "finalize_timeout"),
    ("erase.progress", {"do": "erase", "type": 2, "counter": 0, "all": True}, {"busy": 1}, "timeout"),
    ("format.progress", {"do": "format"}, {"busy": 1}, "timeout"),
)


def scripts(known: Facts) -> Requests:
    """Everything that is asked of a client and of procedures without settings."""
    yield from _clients(known)
    if not known.files or not known.hole_map or not known.crc16:
        return
    for name, request, values, time in PROCEDURES_THAT_WAIT:
        procedure = known.files.procedures.get(name.partition(".")[0])
        if procedure is None:
            continue
        if request["do"] == "upload":
            request = {**request, "destination": next(iter(procedure.destinations), 0)}
        for early in (1, 0):
            why = "a millisecond before its time is over" if early else "when its time is over"
            asked = {"op": "file", **request}
            script = _never_done(known, asked, name, values, getattr(procedure, time) - early)
            yield f"{name}: nothing new {why}", {**asked, "script": script}


def _never_done(known: Facts, request: dict[str, Any], name: str, values: Values, last: int) -> Script:
    """The script of a procedure whose frame says `values` for the last time after that many milliseconds."""
    assert known.files
    step = known.files.steps[name]
    node = FileNode(known, UART, Random(f"{known.node.name} {name}"))
    node.files[2, 0] = bytes(1)
    waiting = {"event": "done", "bytes": step.frame(known.node, values).hex()}
    procedure, now, begun = procedure_of(known, request), 0, -1
    script: Script = [{"at": 0}]
    asked = procedure.next(0)
    while asked or procedure.deadline is not None:
        if asked is None:
            assert procedure.deadline is not None
            script += [{"at": procedure.deadline - 1}, {"at": procedure.deadline}]
            now = procedure.deadline
            if begun >= 0 and now > begun + last:
                break
        elif asked.kind == TELEMETRY and asked.id == step.message.telemetry_id:
            begun, now = (now, now + 1) if begun < 0 else (begun, begun + last)
            script.append({"at": now, "event": waiting})
            procedure.event(now, waiting)
        else:
            for event in node.answer(asked):
                now += 1
                script.append({"at": now, "event": event})
                procedure.event(now, event)
        asked = procedure.next(now)
    return script


def _clients(known: Facts) -> Requests:
    frame = next(iter(known.telemetry.values()), None)
    if frame is None:
        return
    waits = {UART: known.framing, CAN: known.can}
    asked = {"at": 0, "telemetry": frame.telemetry_id}
    patience, tries = known.client.reply_timeout, known.client.retries + 1
    for bus in (bus for bus, form in waits.items() if form):
        rows = [{"at": patience * n + late} for n in range(1, tries + 1) for late in (-1, 0)]
        yield f"{bus}: silence", {"op": "client", "bus": bus, "script": [asked, *rows, {"at": patience * (tries + 1)}]}
    sent = next((m for m in known.telecommands.values() if m.acknowledge), None)
    if sent is not None and known.polled and known.i2c_address is not None:
        for early in (1, 0):
            why = "a millisecond before its time is over" if early else "when its time is over"
            yield f"{I2C}: not processed {why}", {
                "op": "client",
                "bus": I2C,
                "script": list(_polls(known, sent, early)),
            }


def _polls(known: Facts, sent: Message, early: int) -> Iterator[dict[str, Any]]:
    """A telecommand that is still not processed at the end of its time."""
    assert known.polled
    data = Step(known.polled.message, {"id": known.polled.id}).frame(known.node, {"id": sent.telecommand_id or 0})
    state = i2c.telecommand(known, known.polled.message.telemetry_id or 0, data, False)[1:].hex()
    yield {"at": 0, "telecommand": sent.telecommand_id, "bytes": bytes(sent.length).hex()}
    yield {"at": 1, "receive": ""}
    pause, end = known.client.poll_interval, 1 + known.client.poll_timeout
    yield from ({"at": pause}, {"at": 1 + pause}, {"at": 2 + pause, "receive": state}, {"at": 1 + 2 * pause})
    again = max(2 + 2 * pause, end - 2)
    last = max(again, end - early)
    yield from ({"at": again}, {"at": last, "receive": state}, {"at": last + pause})
