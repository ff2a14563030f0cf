"""Operations on the programs that a node stores: one is copied to where it can run, its size and checksum are read."""

from __future__ import annotations

from typing import ClassVar

from icdgen.protocol.errors import RangeError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import Operation
from icdgen.protocol.transfer import Ended, Procedure, Steps


class ProgramOperation(Procedure):
    """What a telecommand starts for a program, and a frame tells the end of.

    Raises `icdgen.protocol.facts.Unsupported` and `RangeError`.
    """

    name: ClassVar[str]  # of the section

    def __init__(self, known: Facts, program: int) -> None:
        super().__init__(known)
        self.form: Operation = need(getattr(known, self.name), self.name)
        self.program = program
        self.values: dict[str, int] = {}  # of the last frame, by role
        if self.form.programs and program not in self.form.programs:
            raise RangeError("program")

    def _run(self) -> Steps:
        form = self.form
        yield from self.telecommand(form.request, program=self.program)
        role, wanted = ("ready", 1) if "ready" in form.progress.fields else ("busy", 0)
        poll = self.poll(form.progress, role, wanted, form.poll_interval, form.timeout, self.program)
        self.values, _ = yield from poll
        if self.values.get("error"):
            raise Ended("error")


class ProgramCopy(ProgramOperation):
    """Copies a stored program to where it can run."""

    name = "program_copy"


class ProgramInformation(ProgramOperation):
    """Reads ``size`` and ``checksum`` of a stored program; None until then, or if the frame does not have them."""

    name = "program_information"

    @property
    def size(self) -> int | None:
        return self.values.get("size") if self.result == "done" else None

    @property
    def checksum(self) -> int | None:
        return self.values.get("checksum") if self.result == "done" else None
