"""Scripts of the operations on stored programs: outcomes and permitted programs."""

from __future__ import annotations

from typing import Any

from icdgen.icd.frames import frame_fields
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Operation
from icdgen.vectors.wire import Requests, Script

ACKNOWLEDGED = {"event": "done", "bytes": ""}
LARGEST = 255  # id of a program


def scripts(facts: Facts) -> Requests:
    """Yield the scripts of both operations.

    An operation that the ICD does not describe is refused.
    """
    forms = {
        "program_copy": facts.program_copy,
        "program_information": facts.program_information,
    }
    for name, form in forms.items():
        if form:
            yield from _ends(facts, name, form)
            yield from _allowed(name, form)
        else:
            yield "there is no such operation", _request(name, 1, [{"at": 0}])


def _request(name: str, program: int, script: Script) -> dict[str, Any]:
    return {"op": "file", "do": name, "program": program, "script": script}


def neighbours(allowed: tuple[int, ...]) -> list[int]:
    """Return the numbers adjacent to the permitted numbers."""
    near = {number + step for number in allowed for step in (-1, 1)}
    return sorted(number for number in near - set(allowed) if 0 <= number <= LARGEST)


def _allowed(name: str, form: Operation) -> Requests:
    for program in form.programs:
        yield "a program that can be requested", _request(name, program, [{"at": 0}])
    for program in neighbours(form.programs):
        yield "a program that cannot be requested", _request(name, program, [{"at": 0}])


def _ends(facts: Facts, name: str, form: Operation) -> Requests:
    step, pause, end = form.progress, form.poll_interval, 1 + form.timeout
    program = form.programs[0] if form.programs else 1
    bits = {
        field.name: field.bits
        for field in frame_fields(step.message.layout, facts.node.orders)
    }
    begin: Script = [{"at": 0}, {"at": 1, "event": ACKNOWLEDGED}]
    information = {"size": 0x12345678, "checksum": 0x9ABCDEF0}

    def row(at: int, done: bool, **values: int) -> dict[str, Any]:
        """Return the row of a progress frame with these values by role."""
        values_by_role = {
            "busy": int(not done),
            "ready": int(done),
            "program": program,
            **values,
        }
        frame_values = {
            role: values_by_role.get(role, 0) & (1 << bits[name]) - 1
            for role, name in step.fields.items()
        }
        return {
            "at": at,
            "event": {
                "event": "done",
                "bytes": step.frame(facts.node, frame_values).hex(),
            },
        }

    def case(why: str, *rows: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        return why, _request(name, program, [*begin, *rows])

    yield case("done at once", row(2, True, **information))
    yield case(
        "done after two polls",
        row(2, False), {"at": 1 + pause}, {"at": 2 + pause},
        row(3 + pause, False), {"at": 3 + 2 * pause}, row(4 + 2 * pause, True, **information),
    )  # fmt: skip
    yield case(
        "it fails", row(2, False), {"at": 2 + pause}, row(3 + pause, True, error=1)
    )
    yield case("it fails, and is busy all the same", row(2, False, error=1))
    yield case(
        "a frame about another program",
        row(2, True, program=program + 1, **information), {"at": 2 + pause}, row(3 + pause, True, **information),
    )  # fmt: skip
    yield case(
        "busy for ever",
        row(end - 1, False),
        {"at": end - 1 + pause},
        row(end + pause, False),
    )
    yield case(
        "done at the last moment",
        row(end - 1, False),
        {"at": end - 1 + pause},
        row(end + pause, True),
    )
    yield case("given up", row(end, False))
    yield case("a poll without a reply", {"at": 2, "event": {"event": "timeout"}})
    yield "refused", _request(
        name, program, [{"at": 0}, {"at": 1, "event": {"event": "refused", "code": 3}}]
    )
    yield "no reply", _request(
        name, program, [{"at": 0}, {"at": 1, "event": {"event": "timeout"}}]
    )
