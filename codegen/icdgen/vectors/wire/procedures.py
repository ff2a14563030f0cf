"""Scripts of all procedures of a node: success with and without losses, failures, and
limits.

Each script is recorded with a simulated device (``recording``), which a script can let
lose packets, report errors or respond late.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

from icdgen_runtime.wire.awaited import Request

from icdgen.icd.buses import UART
from icdgen.icd.model import Message
from icdgen.procedures.actions import Listing
from icdgen.procedures.blocks import BlockPacket, BlockReading
from icdgen.procedures.numbers import put_number
from icdgen.procedures.run import steps_of
from icdgen.protocol.declared import U32
from icdgen.protocol.facts import Facts
from icdgen.protocol.procedures import (
    Get,
    Input,
    Poll,
    Procedure,
    Receive,
    SetLength,
    Take,
    Verify,
    VerifyChecksum,
)
from icdgen.protocol.sections import ChecksumAlgorithm
from icdgen.runtime_objects.operations import AnyLink
from icdgen.runtime_objects.procedures import LONGEST
from icdgen.vectors.wire import Requests, Row
from icdgen.vectors.wire.recording import (
    REFUSED,
    TIMEOUT,
    ClientReport,
    RecordedDevice,
    Respond,
    arrival,
    record,
)

NUMBER = 3  # of an input that may have any value
PACKETS = 6  # complete packets of the bytes to transfer
BLOCK_PACKETS = 4
MOST_ENTRIES = 16  # of a list for a script of its limit, which would otherwise be long
MOST_BYTES = 1 << 12  # of bytes for the same
FAR = 1 << 40  # time at which no step is busy
REPETITIONS = 3  # of a packet that arrives again and again

Call = dict[str, Any]
Prepare = Callable[[RecordedDevice], object]


def scripts(link: AnyLink, facts: Facts) -> Requests:
    """Yield the scripts of all procedures."""
    yield "there is no such procedure", _request({"name": "none"})
    for procedure in facts.procedures:
        for why, request in _Scripts(link, facts, procedure).all():
            yield f"{procedure.name}: {why}", request


def _request(call: Call, script: list[dict[str, Any]] | None = None) -> dict[str, Any]:
    return {"op": "procedure", **call, "script": script or [{"at": 0}]}


class _Scripts:
    """Scripts of a procedure."""

    def __init__(self, link: AnyLink, facts: Facts, procedure: Procedure) -> None:
        self.link, self.facts = link, facts
        self.procedure, self.blocks = procedure, procedure.blocks
        self.size, self.block = 0, {}
        if self.blocks:
            packet = self.blocks.packet_bytes
            # The last packet is not complete.
            self.size = min(PACKETS * packet + packet // 2 + 1, self.blocks.most)
            # Blocks are shorter than in the ICD, so that the bytes need several of
            # them.
            if BLOCK_PACKETS * packet < self.blocks.size:
                self.block = {"block": BLOCK_PACKETS * packet}
        source = Random(f"{facts.node.name} {procedure.name}")
        self.content = source.randbytes(self.size)

    def all(self) -> Requests:
        """Yield all scripts."""
        yield from self._successes()
        yield from self._failures()
        yield from self._waits()
        yield from self._limits()
        yield from self._numbers()
        if self.blocks and self.blocks.sends:
            yield from self._sizes_to_send()
        elif self.blocks:
            yield from self._sizes_to_receive()
        if self.procedure.entry:
            yield from self._lists()
        if self.blocks:
            yield from self._blocks()

    # Calls and devices

    def call(self, **changes: Any) -> Call:
        """Return a call of the procedure, with these values of inputs."""
        procedure, inputs = self.procedure, Call()
        for number, each in enumerate(self.procedure.numbers, procedure.first_input):
            inputs[each.name] = _sample(each)
            if self.blocks and number == self.blocks.total:
                inputs[each.name] = self.size
        inputs |= {key: changes.pop(key) for key in [*changes] if key in inputs}
        given = {key: value for key, value in inputs.items() if value is not None}
        call = {"name": procedure.name, **({"inputs": given} if inputs else {})}
        if self.blocks and self.blocks.sends:
            call["bytes"] = self.content.hex()
        return {**call, **self.block, **changes}

    def device(
        self, call: Call, loss: float = 0.0, content: bytes | None = None
    ) -> RecordedDevice:
        """Return a device with the bytes that the client receives, or with entries."""
        bus = call.get("bus", UART)
        source = Random(
            f"{self.facts.node.name} {self.procedure.name} {bus}, {loss} lost"
        )
        device = RecordedDevice(self.facts, bus, source, loss)
        run = device.counterpart.runs[self.procedure.name]
        if isinstance(run, BlockReading):
            given = call.get("inputs", {})
            key = tuple(given.get(name, 0) for name in run.effect.names)
            data = self.content if content is None else content
            device.device.objects.put(run.effect.kind, key, data)
        if isinstance(run, Listing) and self.procedure.entry:
            run.entries = self._entries(min(4, self.procedure.most_entries))
        return device

    def _entries(self, count: int) -> list[bytes]:
        assert self.procedure.entry
        length = self.procedure.entry.length
        source = Random(count)
        # A frame of zeros could end the list (`end_if_zeros`).
        return [bytes([source.randrange(1, 256)] * length) for _ in range(count)]

    def case(
        self,
        why: str,
        call: Call,
        device: RecordedDevice | None = None,
        respond: Respond | None = None,
        early: bool = False,
    ) -> tuple[str, dict[str, Any]]:
        """Return a recorded script with its purpose."""
        device = self.device(call) if device is None else device
        script, _ = record(self.link, call, respond or device.respond, early)
        return why, _request(call, script)

    @property
    def buses(self) -> list[str]:
        """Buses on which the procedure differs."""
        if self.facts.stream:
            return [UART]
        receives = steps_of(self.procedure, Receive)
        return [UART, *(bus for step in receives for bus in step.requested_on)]

    # Scripts

    def _successes(self) -> Requests:
        for bus in self.buses:
            call = self.call(**({"bus": bus} if len(self.buses) > 1 else {}))
            for loss in (0.0, 0.3):
                where = f" over {bus}" if len(self.buses) > 1 else ""
                yield self.case(
                    f"{loss:.0%} lost{where}", call, self.device(call, loss)
                )
        for flag in (each for each in self.procedure.numbers if each.is_flag):
            yield self.case(f"{flag.name} is set", self.call(**{flag.name: 1}))

    def _failures(self) -> Requests:
        call = self.call()
        for outcome in (REFUSED, {"event": "busy"}, TIMEOUT, {"event": "damaged"}):
            yield self._always(f"{outcome['event']} for ever", outcome)
        requested = [*steps_of(self.procedure, Get), *steps_of(self.procedure, Poll)]
        for outcome in (REFUSED, TIMEOUT) if requested else ():
            yield self._of_telemetry(f"telemetry: {outcome['event']}", outcome)
        damaged = iter([{"event": "damaged"}])
        device = self.device(call)

        def once(now: int, request: Request) -> list[ClientReport]:
            reports = device.respond(now, request)
            is_first = request.kind == "telecommand" and request.repeat
            event = next(damaged, None) if is_first else None
            return [*reports[:-1], ClientReport(event)] if event else reports

        yield self.case("the first acknowledge is damaged", call, respond=once)
        if any(
            isinstance(step, Verify) or (isinstance(step, Poll) and step.fails)
            for step in self.procedure.steps
        ):
            device = self.device(call)
            device.device.fails = True
            yield self.case("the device reports a failure", call, device)

    def _always(self, why: str, outcome: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        """Return the script of a procedure whose requests all have the same outcome."""
        return self.case(
            why, self.call(), respond=lambda now, request: [ClientReport(outcome)]
        )

    def _of_telemetry(self, why: str, outcome: Row) -> tuple[str, Call]:
        """Return the script of a procedure whose telemetry has always this outcome."""
        device = self.device(self.call())

        def respond(now: int, request: Request) -> list[ClientReport]:
            is_telecommand = request.kind == "telecommand"
            return (
                device.respond(now, request)
                if is_telecommand
                else [ClientReport(outcome)]
            )

        return self.case(why, self.call(), device, respond)

    def _waits(self) -> Requests:
        """Yield scripts of polls for which the device is busy, until their time is
        over.
        """
        flags = {each.name: 1 for each in self.procedure.numbers if each.is_flag}
        ends = (
            ("nothing new a millisecond before its time is over", 1, False),
            ("nothing new when its time is over", 0, False),
            ("done when its time is over", 0, True),
        )
        for poll in steps_of(self.procedure, Poll):
            for end, early, is_done in ends:
                call = self.call(**flags)
                device = self.device(call)
                device.device.busy = FAR - 1
                respond = _waiting(device, poll, early, is_done)
                why = f"{poll.message.name}: {end}"
                yield self.case(why, call, device, respond, early=True)

    def _limits(self) -> Requests:
        last = self.procedure.time
        moments = [{"at": at} for at in (0, last, last + 1)]
        yield "the time is over", _request(self.call(), moments)

    def _numbers(self) -> Requests:
        """Yield the smallest and largest numbers of the inputs, and others."""
        for each in self.procedure.numbers:
            allowed = each.values or (0, each.most)
            for number in allowed:
                yield (
                    f"{each.name} is {number}",
                    _request(self.call(**{each.name: number})),
                )
            near = {number + step for number in allowed for step in (-1, 1)}
            for number in sorted(near):
                is_allowed = (
                    number in each.values if each.values else number <= each.most
                )
                if not is_allowed and 0 <= number <= U32:
                    why = f"{each.name} is {number}, which is not supported"
                    yield why, _request(self.call(**{each.name: number}))
            if each.is_optional:
                yield (
                    f"{each.name} is not given",
                    _request(self.call(**{each.name: None})),
                )

    def _lists(self) -> Requests:
        call, most = self.call(), self.procedure.most_entries
        counts = [0] if most > MOST_ENTRIES else [0, most, most + 1]
        for count in counts:
            device = self.device(call)
            _listing(device, self.procedure).entries = self._entries(count)
            yield self.case(f"{count} entries", call, device)
        device = self.device(call)
        _listing(device, self.procedure).entries = self._entries(1) * MOST_ENTRIES
        yield self.case("the same entry for ever", call, device)

    def _blocks(self) -> Requests:
        """Yield scripts of losses and damage within a block."""
        assert self.blocks
        call = self.call()
        if steps_of(self.procedure, VerifyChecksum):
            for wrong, why in ((1, "once"), (LONGEST, "for ever")):
                device = self.device(call)
                _spoil_checksums(device, wrong)
                yield self.case(f"a checksum that is wrong {why}", call, device)
        device = self.device(call)
        device.packet_loss = 1.0
        yield self.case("no packet arrives", call, device)
        small = {**call, "block": 1}
        device = self.device(small)
        if self.blocks.sends:
            yield self.case("the smallest blocks", small | {"bytes": "010203"}, device)
        yield from self._long_maps()
        for block in (self.blocks.size, self.blocks.size + 1):
            yield f"blocks of {block} bytes", _request({**call, "block": block})

    def _long_maps(self) -> Requests:
        """Yield a script of a block whose map needs several messages."""
        assert self.blocks
        form = self.blocks.map
        size = (8 * form.bytes + 2) * self.blocks.packet_bytes if form else 0
        if form and len(form.messages) > 1 and size <= self.blocks.size:
            content = Random(size).randbytes(size - 1)
            if self.blocks.sends:
                call = self.call(bytes=content.hex())
            else:
                call = self.call(**{self._total: len(content)} if self._total else {})
            call.pop("block", None)
            device = self.device(call, 0.1, content)
            yield self.case("a map in several messages, 10% lost", call, device)

    def _sizes_to_send(self) -> Requests:
        assert self.blocks
        most = self.blocks.most
        yield self.case("no bytes", self.call(bytes=""))
        if most < LONGEST:
            for times in (most, most + 1):
                yield f"{times} bytes", _request(self.call(bytes="00", times=times))

    def _sizes_to_receive(self) -> Requests:
        assert self.blocks
        receive = steps_of(self.procedure, Receive)[0]
        total = self._total
        if total:
            yield self.case("no bytes", self.call(**{total: 0}))
            call = self.call(**{total: self.size + 1})
            yield self.case("less than announced", call)
        if total is None or self._input_of_total.is_optional:
            unknown = {total: None} if total else {}
            call = self.call(**unknown)
            block = self.block.get("block", self.blocks.size)
            for content in (b"", self.content, self.content[:block]):
                device = self.device(call, content=content)
                yield self.case(f"{len(content)} bytes of unknown number", call, device)
            for bus in self.buses:
                call = self.call(**unknown, bus=bus)
                device = self.device(call, 0.3)
                yield self.case(
                    f"an unknown number of bytes over {bus}, 30% lost", call, device
                )
            most = self.blocks.most
            for size in (most, most + 1) if most <= MOST_BYTES else ():
                content = Random(size).randbytes(size)
                call = self.call(**unknown)
                device = self.device(call, content=content)
                yield self.case(f"{size} bytes of unknown number", call, device)
            small = {**self.call(**unknown), "block": 1}
            device = self.device(small, content=b"\1\2\3")
            yield self.case("the smallest blocks", small, device)
        yield from self._longer_blocks()
        call = self.call()
        respond = self._foreign(call, receive)
        yield self.case("packets of another block", call, respond=respond)
        for bus in self.buses:
            call = self.call(bus=bus)
            yield self.case(
                f"the same packet for ever over {bus}",
                call,
                respond=self._repeating(call, receive),
            )
        yield self.case(
            "there is nothing", call, RecordedDevice(self.facts, UART, Random(0))
        )

    @property
    def _input_of_total(self) -> Input:
        assert self.blocks and self.blocks.total is not None
        return self.procedure.numbers[self.blocks.total - self.procedure.first_input]

    @property
    def _total(self) -> str | None:
        """Input with the number of bytes."""
        assert self.blocks
        return None if self.blocks.total is None else self._input_of_total.name

    def _longer_blocks(self) -> Requests:
        """Yield scripts of a device that has more than the client requests."""
        lengths = [step.value.number for step in steps_of(self.procedure, SetLength)]
        requests = [s for s in self.procedure.steps if isinstance(s, (Get, Poll))]
        for step in requests:
            for take in step.takes:
                if take.register in lengths:
                    call = self.call()
                    respond = self._longer(self.device(call), step, take)
                    yield self.case("a block is too long", call, respond=respond)

    def _longer(self, device: RecordedDevice, step: Get | Poll, take: Take) -> Respond:
        """Return the responses of a device that reports a block that is too long."""
        assert self.blocks
        length = self.blocks.size + 1

        def respond(now: int, request: Request) -> list[ClientReport]:
            reports = device.respond(now, request)
            if _requests(request, step.message):
                frame = bytearray.fromhex(reports[-1].event["bytes"])
                put_number(take.place, frame, length)
                return [done(bytes(frame))]
            return reports

        return respond

    def _foreign(self, call: Call, receive: Receive) -> Respond:
        """Return the responses of a device that also sends packets of another block,
        before each outcome.
        """
        assert self.blocks
        device = self.device(call)
        id, length = receive.message.telemetry_id, receive.message.length
        numbers = (0, self.blocks.first_packet, (1 << receive.number.bits) - 1)

        def respond(now: int, request: Request) -> list[ClientReport]:
            packets: list[ClientReport] = []
            for number in numbers:
                frame = bytearray(length)
                put_number(receive.number, frame, number)
                packets.append(
                    ClientReport(arrival(BlockPacket(receive.message, bytes(frame))))
                )
            short = {**packets[1].event, "bytes": packets[1].event["bytes"][:-2]}
            other = {**packets[1].event, "id": (id or 0) ^ 1}
            strange = [*packets, ClientReport(short), ClientReport(other)]
            is_before = request.kind == "telemetry"
            return [
                *(strange if is_before else strange[2:]),
                *device.respond(now, request),
            ]

        return respond

    def _repeating(self, call: Call, receive: Receive) -> Respond:
        """Return the responses of a device that always sends the same packet."""
        device = self.device(call)

        def respond(now: int, request: Request) -> list[ClientReport]:
            reports = device.respond(now, request)
            packets = [each for each in reports if each.event["event"] == "arrived"]
            if packets:
                # Packets that are not new must not extend the silence.
                repetition = ClientReport(packets[0].event, receive.silence - 1)
                outcome = reports[len(packets) :]
                return [packets[0], *outcome, *[repetition] * REPETITIONS]
            if (
                request.kind == "telemetry"
                and request.id == receive.message.telemetry_id
            ):
                run = device.counterpart.runs[self.procedure.name]
                assert isinstance(run, BlockReading)
                return [done(run.packet(0).data)]
            return reports

        return respond


def done(data: bytes, after: int = 1) -> ClientReport:
    """Return the report of requested telemetry."""
    return ClientReport({"event": "done", "bytes": data.hex()}, after)


def _requests(request: Request, message: Message) -> bool:
    """Return whether a request is one of this telemetry."""
    return request.kind == "telemetry" and request.id == message.telemetry_id


def _sample(each: Input) -> int:
    """Return a number that an input may have."""
    if each.is_flag:
        return 0
    if each.values:
        return each.values[0]
    if each.enum:
        return each.enum.members[-1].value
    return min(NUMBER, each.most)


def _listing(device: RecordedDevice, procedure: Procedure) -> Listing:
    run = device.counterpart.runs[procedure.name]
    assert isinstance(run, Listing)
    return run


def _spoil_checksums(device: RecordedDevice, times: int) -> None:
    """Let the checksums in the first frames that have one be wrong."""
    checksum, wrong = device.device.checksum, set[int]()

    def spoilt(form: ChecksumAlgorithm | None, data: bytes) -> int:
        if len(wrong) < times:
            wrong.add(device.requests)
        return checksum(form, data) ^ (device.requests in wrong)

    device.device.checksum = spoilt


def _waiting(device: RecordedDevice, poll: Poll, early: int, is_done: bool) -> Respond:
    """Return the responses of a device that is busy with one poll only.

    Its second response comes when the time of the poll is over, or ``early``.
    ``is_done``: whether it is not busy then; otherwise it is busy for ever.
    """
    begin: int | None = None

    def respond(now: int, request: Request) -> list[ClientReport]:
        nonlocal begin
        if request.kind == "telecommand":
            return device.respond(now, request)
        if not _requests(request, poll.message):
            return [done(device.telemetry(FAR + now, request.id))]
        if begin is None:
            begin = now
            return [done(device.telemetry(0, request.id))]
        after = max(1, begin + poll.timeout - early - now)
        at = FAR + now if is_done else 0
        return [done(device.telemetry(at, request.id), after)]

    return respond
