"""Operations on the programs that a node stores."""

from __future__ import annotations

from typing import Optional

from .._errors import RangeError
from .errors import need
from .file_procedures import Ended, RoleProcedure, Steps, Values, one_of
from .link import Link, Operation


class ProgramOperation(RoleProcedure):
    """An operation on a program: a telecommand starts it and a frame reports its end.

    Raise `RangeError` for a program that is not supported.
    """

    def __init__(self, link: Link, form: Operation, program: int) -> None:
        super().__init__(link)
        if form.programs and program not in form.programs:
            raise RangeError("program", one_of(form.programs), program)
        self.program = program
        self._form = form
        self._reported: Values = {}

    def _run(self) -> Steps:
        form = self._form
        yield from self._execute(form.request, {"program": self.program})
        is_ready = "ready" in form.progress.fields
        role = "ready" if is_ready else "busy"
        self._reported, _ = yield from self._poll(
            form.progress,
            role,
            is_ready,
            form.poll_interval,
            form.timeout,
            self.program,
        )
        if self._reported.get("error"):
            raise Ended("error")

    def _value(self, role: str) -> Optional[int]:
        value = self._reported.get(role) if self.result == "done" else None
        return None if value is None else int(value)


class ProgramCopy(ProgramOperation):
    """Copy a stored program to the memory in which it can run.

    Raise `RangeError` and `UnsupportedError`.
    """

    def __init__(self, link: Link, program: int) -> None:
        super().__init__(link, need(link.program_copy, "program_copy"), program)


class ProgramInformation(ProgramOperation):
    """Read size and checksum of a stored program. They are None until it is done.

    Raise `RangeError` and `UnsupportedError`.
    """

    def __init__(self, link: Link, program: int) -> None:
        form = need(link.program_information, "program_information")
        super().__init__(link, form, program)

    @property
    def size(self) -> Optional[int]:
        """Size of the program in bytes; None also if the ICD has no such field."""
        return self._value("size")

    @property
    def checksum(self) -> Optional[int]:
        """Checksum of the program; None also if the ICD has no such field."""
        return self._value("checksum")
