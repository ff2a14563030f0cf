"""Operations on stored programs: copying to executable memory, and reading of size and
checksum.
"""

from __future__ import annotations

from typing import ClassVar

from icdgen.protocol.errors import RangeError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import Operation
from icdgen.protocol.transfer import Ended, Procedure, Steps


class ProgramOperation(Procedure):
    """Operation that a telecommand starts and whose end a telemetry frame reports.

    Raises `icdgen.protocol.facts.Unsupported` and `RangeError`.
    """

    name: ClassVar[str]  # of the section of the ICD

    def __init__(self, facts: Facts, program: int) -> None:
        super().__init__(facts)
        self.form: Operation = need(getattr(facts, self.name), self.name)
        self.program = program
        self.values: dict[str, int] = {}  # of the last frame, by role
        if self.form.programs and program not in self.form.programs:
            raise RangeError("program")

    def _run(self) -> Steps:
        form = self.form
        yield from self.telecommand(form.request, program=self.program)
        role, wanted = ("ready", 1) if "ready" in form.progress.fields else ("busy", 0)
        poll = self.poll(
            form.progress, role, wanted, form.poll_interval, form.timeout, self.program
        )
        self.values, _ = yield from poll
        if self.values.get("error"):
            raise Ended("error")


class ProgramCopy(ProgramOperation):
    """Copy of a stored program to executable memory."""

    name = "program_copy"


class ProgramInformation(ProgramOperation):
    """Reading of ``size`` and ``checksum`` of a stored program.

    Both have the value None until the operation is done, or if the frame lacks them.
    """

    name = "program_information"

    @property
    def size(self) -> int | None:
        return self.values.get("size") if self.result == "done" else None

    @property
    def checksum(self) -> int | None:
        return self.values.get("checksum") if self.result == "done" else None
