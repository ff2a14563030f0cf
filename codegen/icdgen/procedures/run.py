"""A procedure in the device: its telecommands, and the telemetry that its steps
request.

Everything follows from the steps. A field that a poll waits for has the awaited value
when the time of processing is over; a field that reports a failure has its value if the
last telecommand failed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from icdgen_runtime.wire.crc import Crc as CrcOfBytes
from icdgen_runtime.wire.link import CrcForm

from icdgen.icd import checksum
from icdgen.icd.model import Message
from icdgen.procedures.effects import Key, Objects
from icdgen.procedures.flow import until_next_send
from icdgen.procedures.numbers import number_at, put_number
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedures import (
    Effect,
    Get,
    Poll,
    Procedure,
    Send,
    SkipUnless,
    Step,
    Test,
    Value,
    Verify,
)
from icdgen.protocol.sections import ChecksumAlgorithm

AnyStep = TypeVar("AnyStep")
Change = Callable[[bytes], bytes]
"""Change of a frame."""


class Refused(Exception):
    """The device refuses a telecommand.

    ``place``: place of the number that the device does not accept; None if it accepts
    the telecommand but cannot execute it.
    """

    def __init__(self, place: NumberPlace | None = None) -> None:
        super().__init__(place)
        self.place = place


def checksum_of(algorithm: ChecksumAlgorithm | None, data: bytes) -> int:
    """Return a checksum; 0 without an algorithm."""
    if algorithm is None:
        return 0
    crc = algorithm.crc
    if algorithm.kind == checksum.CRC:
        parameters = (getattr(crc, name) for name in CrcForm._fields)
        return CrcOfBytes(CrcForm(*parameters)).feed(data).result()
    return checksum.plain(algorithm.kind, data, crc.width, crc.init, crc.xor_out)


@dataclass
class Device:
    """State and settings that all procedures of a device share.

    ``busy``: duration of each slow step in milliseconds. ``algorithm``: algorithm of
    the checksum in the description of an object. ``filler``: value of the bytes after
    the end of a block in its last packet; None for the value in the ICD. ``fails``:
    whether each step that can report a failure does so.
    """

    objects: Objects
    busy: int = 20
    algorithm: ChecksumAlgorithm | None = None
    filler: int | None = None
    fails: bool = False
    checksum: Callable[[ChecksumAlgorithm | None, bytes], int] = checksum_of
    telecommands: int = field(default=0, init=False)  # so far; they order the changes


class ProcedureRun:
    """State of a procedure in the device.

    ``names``: inputs that are the key of the objects.
    """

    def __init__(
        self,
        procedure: Procedure,
        effect: Effect,
        device: Device,
        names: tuple[str, ...],
    ) -> None:
        self.procedure, self.effect, self.device = procedure, effect, device
        self.names = names
        self.sends = [i for i, s in enumerate(procedure.steps) if isinstance(s, Send)]
        self.registers: dict[int, int] = {}  # numbers that the client has given
        self.failed = False  # whether the last telecommand failed
        self._sends_of: dict[str, list[int]] = {}
        for index in self.sends:
            self._sends_of.setdefault(self.step(index).message.name, []).append(index)
        self._previous = -1  # step of the last telecommand
        # Registers that decide which steps follow, and the steps that were computed
        self._deciding: list[int] = []
        for skip in steps_of(procedure, SkipUnless):
            self._deciding.append(skip.test.register)
            if skip.test.value.in_register:
                self._deciding.append(skip.test.value.number)
        self._reached_by: dict[tuple[int | None, ...], list[int]] = {}
        # Step -> the telecommand that leads to it, and the end of its processing
        self._requests: dict[int, tuple[int, int]] = {}
        self.prepare()

    def prepare(self) -> None:
        """Find the steps that matter, and set the state at the beginning."""

    def telecommand(self, now: int, message: Message, data: bytes) -> bool:
        """Process a telecommand. Return whether it belongs to the procedure.

        Raise `Refused`.
        """
        steps = self._sends_of.get(message.name)
        if not steps:
            return False
        # Constants distinguish steps with the same telecommand.
        fitting = [i for i in steps if self._different_constant(i, data) is None]
        if not fitting:
            raise Refused(self._different_constant(steps[0], data))
        index = fitting[0]
        # If the telecommands are equal, only the order of the steps distinguishes them.
        if len(fitting) > 1:
            expected = self._reached(self._previous)
            index = next((i for i in fitting if i in expected), index)
        step = self.step(index)
        numbers = {
            put.value.number: number_at(put.place, data)
            for put in step.puts
            if put.value.in_register
        }
        self._check(step, numbers)
        self.registers |= numbers
        self._previous = index
        self.execute(index, data)
        reached = self._reached(index)
        # Telemetry that the client requests next reports a failure. Without such
        # telemetry, only a refusal can.
        if self.failed and not any(map(self._reports_failure, reached)):
            raise Refused()
        due = self.device.telecommands, now + self.device.busy
        self._requests |= dict.fromkeys(reached, due)
        return True

    def execute(self, index: int, data: bytes) -> None:
        """Execute the telecommand of a step."""

    def changes(self, now: int, message: Message) -> Iterator[tuple[int, Change]]:
        """Yield the changes of a frame by the steps that request it, each with the
        number of the telecommand that leads to it.
        """
        for index, (number, end) in self._requests.items():
            step = self.procedure.steps[index]
            if isinstance(step, (Get, Poll)) and step.message.name == message.name:
                # Only a poll waits; other telemetry is requested when it is there.
                is_busy = isinstance(step, Poll) and now < end
                yield number, self._change(step, is_busy)

    def map_message(self, message: Message, data: bytes) -> None:
        """Process a telecommand with a part of the map of packets."""

    def step(self, index: int) -> Send:
        """Return a step that sends a telecommand."""
        step = self.procedure.steps[index]
        assert isinstance(step, Send)
        return step

    def given(self, index: int) -> set[int]:
        """Return the registers that the telecommand of a step has."""
        return {
            put.value.number for put in self.step(index).puts if put.value.in_register
        }

    def is_packet(self, message: Message) -> bool:
        """Return whether a telecommand has the bytes of a packet."""
        steps = map(self.step, self._sends_of.get(message.name, ()))
        return any(step.packet_at is not None for step in steps)

    @property
    def key(self) -> Key:
        """Key of the object that the client has named."""
        return tuple(self.registers.get(register, 0) for register in self.effect.key)

    def frame(self, step: Get | Poll, data: bytes, is_busy: bool) -> bytearray:
        """Return a frame before its numbers that steps use are set."""
        return bytearray(data)

    def number(self, register: int, is_busy: bool) -> int | None:
        """Return the number of a field that a later step uses; None for any number."""
        return None

    def about(self, key: Key, is_busy: bool) -> Iterator[tuple[NumberPlace, int]]:
        """Yield the numbers that describe an object."""
        stored = self.device.objects.objects_of(self.effect.kind).get(key)
        data = bytes(stored.data) if stored and not is_busy else b""
        numbers = dict(zip(self.names, key, strict=False)) | {
            "size": len(data),
            "time": stored.time if stored else 0,
            "checksum": 0,
        }
        if data:
            numbers["checksum"] = self.device.checksum(self.device.algorithm, data)
        for name, place in self.effect.fields:
            yield place, numbers.get(name, 0)

    def _reached(self, index: int) -> list[int]:
        """Return the steps that can follow a step until the next telecommand."""
        case = (index, *(self.registers.get(register) for register in self._deciding))
        if case not in self._reached_by:
            steps = until_next_send(self.procedure, index, self.registers)
            self._reached_by[case] = steps
        return self._reached_by[case]

    def _different_constant(self, index: int, data: bytes) -> NumberPlace | None:
        """Return the first place where the telecommand of a step has another number."""
        for put in self.step(index).puts:
            is_constant = not put.value.in_register
            if is_constant and number_at(put.place, data) != put.value.number:
                return put.place
        return None

    def _check(self, step: Send, numbers: Mapping[int, int]) -> None:
        """Check the numbers that are inputs. Raise `Refused`."""
        inputs = self.procedure.numbers
        for put in step.puts:
            position = put.value.number - self.procedure.first_input
            if not put.value.in_register or not 0 <= position < len(inputs):
                continue
            values = inputs[position].values
            if values and numbers[put.value.number] not in values:
                raise Refused(put.place)

    def _reports_failure(self, index: int) -> bool:
        step = self.procedure.steps[index]
        return isinstance(step, Verify) or (isinstance(step, Poll) and bool(step.fails))

    def _change(self, step: Get | Poll, is_busy: bool) -> Change:
        """Return the change of a frame that a step requests."""

        def change(data: bytes) -> bytes:
            frame = self.frame(step, data, is_busy)
            for take in step.takes:
                number = self._awaited(step, take.register, is_busy)
                if number is None:
                    number = self.number(take.register, is_busy)
                if number is not None:
                    put_number(take.place, frame, number)
            return bytes(frame)

        return change

    def _awaited(self, step: Get | Poll, register: int, is_busy: bool) -> int | None:
        """Return the number of a field that a test uses; None without a test."""
        has_failed = self.failed or self.device.fails
        if isinstance(step, Poll):
            until, fails = _values(step.until, register), _values(step.fails, register)
            wanted: list[Value] = []
            # A value of a register identifies the object that the client asks about,
            # which is right even if the device is busy.
            if until and (not is_busy or until[0].in_register):
                wanted = until
            if has_failed and not is_busy and fails:
                wanted = fails
            if wanted:
                return self._resolved(wanted[0])
            if until or fails:
                return _other({self._resolved(value) for value in (*until, *fails)})
        for verify in steps_of(self.procedure, Verify):
            if verify.test.register == register:
                good = self._resolved(verify.test.value)
                return _other({good}) if has_failed else good
        return None

    def _resolved(self, value: Value) -> int:
        """Return the number of a value."""
        if value.in_register:
            return self.registers.get(value.number, 0)
        return value.number


def steps_of(procedure: Procedure, kind: type[AnyStep]) -> list[AnyStep]:
    """Return the steps of a kind."""
    return [step for step in procedure.steps if isinstance(step, kind)]


def is_of(step_value: Value, register: int) -> bool:
    """Return whether a value is the content of a register."""
    return step_value == Value(register, True)


def index_of(steps: Iterable[Step], kind: type[Step]) -> int | None:
    """Return the index of the first step of a kind, or None."""
    return next((i for i, step in enumerate(steps) if isinstance(step, kind)), None)


def _values(tests: Iterable[Test], register: int) -> list[Value]:
    return [test.value for test in tests if test.register == register]


def _other(numbers: set[int]) -> int:
    """Return the smallest number that is not in the set."""
    return next(n for n in range(len(numbers) + 1) if n not in numbers)
