"""Scripts of procedures, recorded with a simulated node that loses messages, and
scripts of failing procedures.
"""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen_runtime.wire.file_procedures import RoleProcedure

from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import UART, Upload
from icdgen.runtime_objects.file_procedures import LONGEST, event_of, procedure_of
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests, Script
from icdgen.vectors.wire.node import FileNode
from icdgen.vectors.wire.operations import neighbours

STEPS = 100_000  # limit above the steps of any procedure
ATTEMPTS = 8  # attempts of a client
MOST_FILES = 16  # of a list for a script of its limit, which would otherwise be long
MOST_BYTES = 1 << 12  # of a file for the same


def record(
    link: AnyLink, request: dict[str, Any], node: FileNode
) -> tuple[Script, RoleProcedure]:
    """Return the script of a procedure with the simulated node.

    Repeatable requests are repeated as by a client.
    """
    procedure, now = procedure_of(link, request), 0
    script: Script = [{"at": 0}]
    pending = procedure.next(now)
    while procedure.result is None and len(script) < STEPS:
        if pending is None:
            now = now + 1 if procedure.deadline is None else int(procedure.deadline)
            script.append({"at": now})
            pending = procedure.next(now)
            continue
        events, tries = node.answer(pending), 1
        # Only repeatable requests may be sent again, as by a real client.
        while pending.repeat and events[-1]["event"] == "timeout" and tries < ATTEMPTS:
            events, tries = events[:-1] + node.answer(pending), tries + 1
        for event in events:
            now += 1
            script.append({"at": now, "event": event})
            procedure.event(now, event_of(event))
            pending = procedure.next(now)
    return script, procedure


def scripts(link: AnyLink, facts: Facts) -> Requests:
    """Yield the scripts of all procedures."""
    form = facts.files
    if not form or not facts.hole_map or not facts.crc16:
        return
    if form.list:
        for loss in (0.0, 0.3):
            yield from _recorded(link, facts, "the list of files", {"do": "list"}, loss)
        if form.list.max_entries <= MOST_FILES:
            yield from _more_files_than_allowed(link, facts, form.list.max_entries)
    if form.download:
        yield from _downloads(link, facts, form.download.max_bytes)
    if form.upload:
        yield from _uploads(link, facts, form.upload)
    else:
        request = {
            "op": "file",
            "do": "upload",
            "destination": 3,
            "bytes": "00",
            "script": [{"at": 0}],
        }
        yield "the node takes no uploads", request
    if form.erase:
        for all_ in (False, True):
            yield from _recorded(
                link,
                facts,
                "erased",
                {"do": "erase", "type": 2, "counter": 3, "all": all_},
                0.0,
            )
    if form.format:
        yield from _recorded(link, facts, "formatted", {"do": "format"}, 0.0)
        refusal = {"event": "refused", "code": 3}
        yield "refused", {
            "op": "file",
            "do": "format",
            "script": [{"at": 0}, {"at": 1, "event": refusal}],
        }
        busy = [{"at": 0}, {"at": 1, "event": {"event": "done", "bytes": ""}}]
        frame = b"\xff".ljust(form.format.progress.message.length, b"\0").hex()
        for at in (2, 2 + form.format.poll_interval, form.format.timeout + 1):
            busy += [{"at": at}, {"at": at, "event": {"event": "done", "bytes": frame}}]
        yield "busy for ever", {"op": "file", "do": "format", "script": busy}


def _node(link: AnyLink, facts: Facts, bus: str, loss: float, why: str) -> FileNode:
    source = Random(f"{facts.node.name} {why} {bus} {loss}")
    node = FileNode(link, facts, bus, source, loss)
    assert node.form
    for counter, size in enumerate((1, node.form.packet_bytes * 3, 130)):
        node.files[2, counter] = node.source.randbytes(size)
    return node


def _recorded(
    link: AnyLink,
    facts: Facts,
    why: str,
    request: dict[str, Any],
    loss: float,
    bus: str = UART,
) -> Requests:
    script, _ = record(link, request, _node(link, facts, bus, loss, why))
    yield f"{why}, {loss:.0%} lost", {"op": "file", **request, "script": script}


def _more_files_than_allowed(link: AnyLink, facts: Facts, most: int) -> Requests:
    for files in (most, most + 1):
        node = FileNode(link, facts, UART, Random(files))
        node.files = {(2, counter): bytes(counter) for counter in range(files)}
        script, _ = record(link, {"do": "list"}, node)
        yield f"{files} files", {"op": "file", "do": "list", "script": script}


def _downloads(link: AnyLink, facts: Facts, most: int) -> Requests:
    assert facts.files
    size = facts.files.packet_bytes
    request: dict[str, Any] = {"do": "download", "bus": UART, "type": 2, "counter": 0}
    for length in (most, most + 1):
        first = {"op": "file", **request, "size": length, "script": [{"at": 0}]}
        yield f"a file of {length} bytes", first
        if length <= MOST_BYTES:
            node = FileNode(link, facts, UART, Random(length))
            node.files[2, 0] = node.source.randbytes(length)
            script, _ = record(link, request, node)
            why = f"a file of {length} bytes, of unknown size"
            yield why, {"op": "file", **request, "script": script}
    if most < max(131, 3 * size):
        return
    for bus in facts.files.packet_ids:
        for loss in (0.0, 0.3):
            request = {
                "do": "download",
                "bus": bus,
                "type": 2,
                "counter": 2,
                "size": 130,
                "block": 4 * size,
            }
            yield from _recorded(
                link, facts, f"a file in two blocks over {bus}", request, loss, bus
            )
    request = {
        "do": "download",
        "bus": UART,
        "type": 2,
        "counter": 1,
        "block": 2 * size,
    }
    yield from _recorded(link, facts, "a file of unknown size", request, 0.1)
    request = {"do": "download", "bus": UART, "type": 2, "counter": 2, "size": 131}
    yield from _recorded(link, facts, "a file shorter than announced", request, 0.0)
    yield "an empty file", {"op": "file", **request, "size": 0, "script": [{"at": 0}]}
    request = {"do": "download", "bus": UART, "type": 2, "counter": 1, "size": 3 * size}
    yield from _recorded(link, facts, "nothing arrives", request, 1.0)
    script, _ = record(
        link, request, _NodeWithWrongChecksums(link, facts, UART, Random(1))
    )
    yield "a checksum that is never right", {"op": "file", **request, "script": script}


class _NodeWithWrongChecksums(FileNode):
    """Simulated node whose checksums are wrong."""

    def __init__(self, link: AnyLink, facts: Facts, bus: str, source: Random) -> None:
        super().__init__(link, facts, bus, source)
        self.files[2, 1] = bytes(facts.files.packet_bytes * 3 if facts.files else 0)

    def _sum(self, data: bytes) -> int:
        return super()._sum(data) ^ 1


def _uploads(link: AnyLink, facts: Facts, form: Upload) -> Requests:
    assert facts.files
    size, most, allowed = (
        facts.files.packet_bytes,
        form.destination_bytes,
        form.destinations,
    )
    destination = allowed[0] if allowed else 3
    first = {
        "op": "file",
        "do": "upload",
        "destination": destination,
        "bytes": "00",
        "script": [{"at": 0}],
    }
    for number in allowed:
        yield "a destination that is supported", {**first, "destination": number}
    for number in neighbours(allowed):
        yield "a destination that is not supported", {**first, "destination": number}
    if most is not None and most < LONGEST:
        yield "as much as a destination holds", {**first, "times": most}
        yield "a byte more than a destination holds", {**first, "times": most + 1}
    data = Random(f"{facts.node.name} program").randbytes(7 * size + 3)
    if most is not None and most < len(data):
        return
    for loss in (0.0, 0.3):
        request = {
            "do": "upload",
            "destination": destination,
            "bytes": data.hex(),
            "block": 4 * size,
        }
        yield from _recorded(link, facts, "a program in two blocks", request, loss)
    request = {
        "do": "upload",
        "destination": destination,
        "bytes": data[: 2 * size].hex(),
    }
    script, _ = record(
        link, request, _NodeWithWrongChecksums(link, facts, UART, Random(1))
    )
    yield "a checksum that is never right", {"op": "file", **request, "script": script}
