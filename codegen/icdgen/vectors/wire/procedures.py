"""Scripts of procedures, recorded against a node that loses things, and of such as must fail."""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen.protocol import transfer
from icdgen.protocol.facts import Facts
from icdgen.protocol.scripts import LONGEST, procedure_of
from icdgen.protocol.sections import UART, Upload
from icdgen.vectors.wire import Requests, Script
from icdgen.vectors.wire.node import FileNode
from icdgen.vectors.wire.operations import neighbours

STEPS = 100_000  # more than any procedure takes
AGAIN = 8  # attempts that a client makes


def record(known: Facts, request: dict[str, Any], node: FileNode) -> tuple[Script, transfer.Procedure]:
    """The script of a procedure against the node; a client would send what may be repeated again."""
    procedure, now = procedure_of(known, request), 0
    script: Script = [{"at": 0}]
    asked = procedure.next(now)
    while procedure.result is None and len(script) < STEPS:
        if asked is None:
            now = procedure.deadline if procedure.deadline is not None else now + 1
            script.append({"at": now})
            asked = procedure.next(now)
            continue
        events, tries = node.answer(asked), 1
        while asked.repeat and events[-1]["event"] == "timeout" and tries < AGAIN:
            events, tries = events[:-1] + node.answer(asked), tries + 1
        for event in events:
            now += 1
            script.append({"at": now, "event": event})
            procedure.event(now, event)
            asked = procedure.next(now)
    return script, procedure


def scripts(known: Facts) -> Requests:
    """Everything that is asked of the procedures."""
    form = known.files
    if not form or not known.hole_map or not known.crc16:
        return
    if form.list:
        yield from _lists(known)
    if form.download:
        yield from _downloads(known)
    if form.upload:
        yield from _uploads(known, form.upload)
    else:
        request = {"op": "file", "do": "upload", "destination": 3, "bytes": "00", "script": [{"at": 0}]}
        yield "the node takes no uploads", request
    if form.erase:
        for all_ in (False, True):
            yield from _recorded(known, "erased", {"do": "erase", "type": 2, "counter": 3, "all": all_}, 0.0)
    if form.format:
        yield from _recorded(known, "formatted", {"do": "format"}, 0.0)
        refusal = {"event": "refused", "code": 3}
        yield "refused", {"op": "file", "do": "format", "script": [{"at": 0}, {"at": 1, "event": refusal}]}
        busy = [{"at": 0}, {"at": 1, "event": {"event": "done", "bytes": ""}}]
        frame = b"\xff".ljust(form.format.progress.message.length, b"\0").hex()
        for at in (2, 2 + form.format.poll_interval, form.format.timeout + 1):
            busy += [{"at": at}, {"at": at, "event": {"event": "done", "bytes": frame}}]
        yield "busy for ever", {"op": "file", "do": "format", "script": busy}


def _node(known: Facts, bus: str, loss: float, why: str) -> FileNode:
    node = FileNode(known, bus, Random(f"{known.node.name} {why} {bus} {loss}"), loss)
    assert node.form
    for counter, size in enumerate((1, node.form.packet_bytes * 3, 130)):
        node.files[2, counter] = node.source.randbytes(size)
    return node


def _recorded(known: Facts, why: str, request: dict[str, Any], loss: float, bus: str = UART) -> Requests:
    script, _ = record(known, request, _node(known, bus, loss, why))
    yield f"{why}, {loss:.0%} lost", {"op": "file", **request, "script": script}


def _lists(known: Facts) -> Requests:
    for loss in (0.0, 0.3):
        yield from _recorded(known, "the list of files", {"do": "list"}, loss)


def _downloads(known: Facts) -> Requests:
    assert known.files
    size = known.files.packet_bytes
    for bus in known.files.packet_ids:
        for loss in (0.0, 0.3):
            request = {"do": "download", "bus": bus, "type": 2, "counter": 2, "size": 130, "block": 4 * size}
            yield from _recorded(known, f"a file in two blocks over {bus}", request, loss, bus)
    request = {"do": "download", "bus": UART, "type": 2, "counter": 1, "block": 2 * size}
    yield from _recorded(known, "a file of unknown size", request, 0.1)
    request = {"do": "download", "bus": UART, "type": 2, "counter": 2, "size": 131}
    yield from _recorded(known, "a file shorter than announced", request, 0.0)
    yield "an empty file", {"op": "file", **request, "size": 0, "script": [{"at": 0}]}
    request = {"do": "download", "bus": UART, "type": 2, "counter": 1, "size": 3 * size}
    yield from _recorded(known, "nothing arrives", request, 1.0)
    script, _ = record(known, request, _Wrong(known, UART, Random(1)))
    yield "a checksum that is never right", {"op": "file", **request, "script": script}


class _Wrong(FileNode):
    """Its checksums are wrong."""

    def __init__(self, known: Facts, bus: str, source: Random) -> None:
        super().__init__(known, bus, source)
        self.files[2, 1] = bytes(known.files.packet_bytes * 3 if known.files else 0)

    def _sum(self, data: bytes) -> int:
        return super()._sum(data) ^ 1


def _uploads(known: Facts, form: Upload) -> Requests:
    assert known.files
    size, most, allowed = known.files.packet_bytes, form.destination_bytes, form.destinations
    destination = allowed[0] if allowed else 3
    first = {"op": "file", "do": "upload", "destination": destination, "bytes": "00", "script": [{"at": 0}]}
    for number in allowed:
        yield "a destination that is supported", {**first, "destination": number}
    for number in neighbours(allowed):
        yield "a destination that is not supported", {**first, "destination": number}
    if most is not None and most < LONGEST:
        yield "as much as a destination holds", {**first, "times": most}
        yield "a byte more than a destination holds", {**first, "times": most + 1}
    data = Random(f"{known.node.name} program").randbytes(7 * size + 3)
    if most is not None and most < len(data):
        return
    for loss in (0.0, 0.3):
        request = {"do": "upload", "destination": destination, "bytes": data.hex(), "block": 4 * size}
        yield from _recorded(known, "a program in two blocks", request, loss)
    request = {"do": "upload", "destination": destination, "bytes": data[: 2 * size].hex()}
    script, _ = record(known, request, _Wrong(known, UART, Random(1)))
    yield "a checksum that is never right", {"op": "file", **request, "script": script}
