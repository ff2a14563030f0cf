"""Operations on stored programs in the device: copy, and information about size and
checksum.
"""

from __future__ import annotations

from icdgen_runtime.wire.link import Link

from icdgen.icd.model import Message
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Operation
from icdgen.sim.storage import Storage, checksum_of
from icdgen.sim.transfers import Raw, Refused


class Programs:
    """State of the operations. ``copy_to`` is the program that a copy replaces."""

    def __init__(
        self,
        facts: Facts,
        link: Link,
        storage: Storage,
        busy_ms: int,
        copy_to: int | None,
        room: int | None,
    ) -> None:
        self.facts, self.link, self.storage, self.busy_ms = (
            facts,
            link,
            storage,
            busy_ms,
        )
        self.copy_to, self.room = copy_to, room
        self.requested = 0  # program of the last request for information
        self.failed = False
        self.busy: dict[str, int] = {}  # operation -> time of its end

    def telecommand(self, now: int, message: Message, raw: Raw) -> None:
        """Process a telecommand of an operation; ignore others. Raise `Refused`."""
        for name, form in self._forms():
            if form.request.message.name != message.name:
                continue
            program = int(raw[form.request.fields["program"]])
            if form.programs and program not in form.programs:
                raise Refused(form.request.fields["program"])
            self.busy[name] = now + self.busy_ms
            if form is self.facts.program_copy:
                self.failed = not self._copy(program)
            else:
                self.requested = program

    def answer(self, now: int, message: Message) -> Raw:
        """Return values of the fields that report the progress of an operation."""
        for name, form in self._forms():
            if form.progress.message.name == message.name:
                busy = now < self.busy.get(name, now)
                values: dict[str, int] = {"busy": int(busy), "ready": int(not busy)}
                if form is self.facts.program_copy:
                    values["error"] = int(self.failed and not busy)
                else:
                    data = (
                        b""
                        if busy
                        else bytes(self.storage.programs.get(self.requested, b""))
                    )
                    checksum = checksum_of(self.link, data) if data else 0
                    values |= {
                        "program": self.requested,
                        "size": len(data),
                        "checksum": checksum,
                    }
                return {
                    field: values[role]
                    for role, field in form.progress.fields.items()
                    if role in values
                }
        return {}

    def _forms(self) -> list[tuple[str, Operation]]:
        forms = {
            "program_copy": self.facts.program_copy,
            "program_information": self.facts.program_information,
        }
        return [(name, form) for name, form in forms.items() if form]

    def _copy(self, program: int) -> bool:
        """Copy a program.

        Return False if there is no such program or not enough room.
        """
        data = self.storage.programs.get(program)
        if (
            not data
            or self.copy_to is None
            or (self.room is not None and len(data) > self.room)
        ):
            return False
        self.storage.put(self.copy_to, bytes(data))
        return True
