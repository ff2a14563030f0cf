"""Procedures without blocks in the device: lists of objects, and actions on them.

`Listing` and `Action` add to `icdgen.procedures.run.ProcedureRun` what a telecommand
does, and what the telemetry of the procedure has in it.
"""

from __future__ import annotations

from icdgen.procedures.numbers import put_number
from icdgen.procedures.run import ProcedureRun, index_of
from icdgen.protocol.procedures import Collect, Get, Jump, Poll


class Listing(ProcedureRun):
    """The client reads a list, entry by entry.

    A telecommand of the loop advances to the next entry; others return to the first
    one. ``entries``: the frames of the entries; None: they describe the objects.
    """

    entries: list[bytes] | None = None

    def prepare(self) -> None:
        self._position = 0
        collect = index_of(self.procedure.steps, Collect) or 0
        # The loop of the list is the jump back over `collect`.
        self._loop = next(
            range(step.to, index)
            for index, step in enumerate(self.procedure.steps)
            if isinstance(step, Jump) and step.to <= collect < index
        )

    def execute(self, index: int, data: bytes) -> None:
        self._position = self._position + 1 if index in self._loop else 0

    def frame(self, step: Get | Poll, data: bytes, is_busy: bool) -> bytearray:
        if step.message is not self.procedure.entry:
            return bytearray(data)
        if is_busy:
            return bytearray(len(data))
        if self.entries is not None:
            # Behind the last entry all bytes are 0, which ends the list
            # (`end_if_zeros`).
            entries = self.entries[self._position : self._position + 1]
            return bytearray(entries[0] if entries else bytes(len(data)))
        frame = bytearray(len(data))
        keys = list(self.device.objects.objects_of(self.effect.kind))
        for key in keys[self._position : self._position + 1]:
            for place, number in self.about(key, False):
                put_number(place, frame, number)
        return frame


class Action(ProcedureRun):
    """The device does something with an object, or describes it."""

    def prepare(self) -> None:
        # The telecommand that names the object does something with it; without a key,
        # the first telecommand.
        naming = [i for i in self.sends if self.given(i) & set(self.effect.key)]
        self._step = next(iter(naming or self.sends), None)
        requests = [s for s in self.procedure.steps if isinstance(s, (Get, Poll))]
        self._described = requests[-1].message if requests else None

    def execute(self, index: int, data: bytes) -> None:
        if index != self._step:
            return
        effect, objects = self.effect, self.device.objects
        if effect.verb == "erase":
            test = effect.all_if
            if test is None:
                is_all = not effect.key
            else:
                is_all = self.registers.get(test.register) == test.value.number
            if is_all:
                objects.objects_of(effect.kind).clear()
            else:
                objects.objects_of(effect.kind).pop(self.key, None)
        elif effect.verb == "copy":
            source = objects.content_of(effect.kind, self.key)
            self.failed = not source
            if source:
                objects.put(effect.kind, effect.to, source)
                objects.report(effect.kind, effect.to)

    def frame(self, step: Get | Poll, data: bytes, is_busy: bool) -> bytearray:
        frame = bytearray(data)
        if self.effect.verb == "describe" and step.message is self._described:
            for place, number in self.about(self.key, is_busy):
                put_number(place, frame, number)
        return frame
