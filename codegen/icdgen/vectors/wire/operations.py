"""Scripts of the operations on stored programs: how each ends, and what they may be asked for."""

from __future__ import annotations

from typing import Any

from icdgen.icd.frames import frame_fields
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Operation
from icdgen.vectors.wire import Requests, Script

ACKNOWLEDGED = {"event": "done", "bytes": ""}
LARGEST = 255  # id of a program


def scripts(known: Facts) -> Requests:
    """Everything that is asked of them; an operation that the ICD does not have is refused."""
    forms = {"program_copy": known.program_copy, "program_information": known.program_information}
    for name, form in forms.items():
        if form:
            yield from _ends(known, name, form)
            yield from _allowed(name, form)
        else:
            yield "there is no such operation", _asked(name, 1, [{"at": 0}])


def _asked(name: str, program: int, script: Script) -> dict[str, Any]:
    return {"op": "file", "do": name, "program": program, "script": script}


def neighbours(allowed: tuple[int, ...]) -> list[int]:
    """What is next to the numbers that are allowed."""
    near = {number + step for number in allowed for step in (-1, 1)}
    return sorted(number for number in near - set(allowed) if 0 <= number <= LARGEST)


def _allowed(name: str, form: Operation) -> Requests:
    for program in form.programs:
        yield "a program that can be requested", _asked(name, program, [{"at": 0}])
    for program in neighbours(form.programs):
        yield "a program that cannot be requested", _asked(name, program, [{"at": 0}])


def _ends(known: Facts, name: str, form: Operation) -> Requests:
    step, pause, end = form.progress, form.poll_interval, 1 + form.timeout
    program = form.programs[0] if form.programs else 1
    bits = {field.name: field.bits for field in frame_fields(step.message.layout, known.node.orders)}
    begin: Script = [{"at": 0}, {"at": 1, "event": ACKNOWLEDGED}]
    found = {"size": 0x12345678, "checksum": 0x9ABCDEF0}

    def row(at: int, done: bool, **values: int) -> dict[str, Any]:
        """A frame of the progress comes, with these values by role."""
        told = {"busy": int(not done), "ready": int(done), "program": program, **values}
        given = {role: told.get(role, 0) & (1 << bits[name]) - 1 for role, name in step.fields.items()}
        return {"at": at, "event": {"event": "done", "bytes": step.frame(known.node, given).hex()}}

    def case(why: str, *rows: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        return why, _asked(name, program, [*begin, *rows])

    yield case("done at once", row(2, True, **found))
    yield case(
        "done after two polls",
        row(2, False), {"at": 1 + pause}, {"at": 2 + pause},
        row(3 + pause, False), {"at": 3 + 2 * pause}, row(4 + 2 * pause, True, **found),
    )  # fmt: skip
    yield case("it fails", row(2, False), {"at": 2 + pause}, row(3 + pause, True, error=1))
    yield case("it fails, and is busy all the same", row(2, False, error=1))
    yield case(
        "a frame about another program",
        row(2, True, program=program + 1, **found), {"at": 2 + pause}, row(3 + pause, True, **found),
    )  # fmt: skip
    yield case("busy for ever", row(end - 1, False), {"at": end - 1 + pause}, row(end + pause, False))
    yield case("done at the last moment", row(end - 1, False), {"at": end - 1 + pause}, row(end + pause, True))
    yield case("given up", row(end, False))
    yield case("a poll without a reply", {"at": 2, "event": {"event": "timeout"}})
    yield "refused", _asked(name, program, [{"at": 0}, {"at": 1, "event": {"event": "refused", "code": 3}}])
    yield "no reply", _asked(name, program, [{"at": 0}, {"at": 1, "event": {"event": "timeout"}}])
