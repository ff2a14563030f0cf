"""Kinds of hostile devices.

A kind is a function of the device and of the client's request, or None while the line
is idle. It returns the events that the client reports. None leaves the response to the
honest device, which has bytes without end, all zero, and no entries.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from itertools import pairwise
from random import Random
from typing import Any

from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.checks import checksum
from icdgen_runtime.wire.events import (
    Arrived,
    Busy,
    Done,
    Event,
    Refused,
    Sent,
    Timeout,
)
from icdgen_runtime.wire.link import Bus, Link
from icdgen_runtime.wire.procedure_forms import (
    BLOCK_LENGTH,
    PACKET_NUMBER,
    Get,
    Poll,
    Receive,
    Send,
    SetLength,
    Test,
    Verify,
    VerifyChecksum,
)

Events = list[Event] | None
UNKNOWN_CODE = 200


class Device:
    """A device during one procedure, for example ``download``."""

    def __init__(
        self, link: Link[Any], procedure: str, kind: Kind, bus: Bus = "uart"
    ) -> None:
        self.link, self.kind, self.bus = link, kind, bus
        self.form = link.procedures[procedure]
        steps = self.form.steps
        self.blocks, self.map = self.form.blocks, None
        if self.blocks:
            self.map = self.blocks.map
        self.receive = next((s for s in steps if isinstance(s, Receive)), None)
        bursts = [
            step
            for step, following in pairwise(steps)
            if isinstance(step, Send) and isinstance(following, Receive)
        ]
        self.burst = bursts[0].telecommand if bursts else None
        self.registers: dict[int, int] = {}  # numbers that the client has sent
        self.request_counts: dict[str, int] = {}  # number of requests by name
        self.received: dict[int, bytes] = {}  # packets by number
        self.unread: list[int] = []  # packets that the client reads one at a time
        self.is_sending = False  # between a burst and the next request

    @property
    def loaded(self) -> int:
        """Bytes of the block that the client requested last."""
        return self.registers.get(BLOCK_LENGTH, 0)

    @property
    def packets(self) -> int:
        """Largest number of packets of a block."""
        return -(-self.blocks.size // self.blocks.packet_bytes) if self.blocks else 0

    def answer(self, request: Request | None) -> list[Event]:
        """Return the events of a request, or of an idle line."""
        name = self.name_of(request)
        if request is not None:
            self.request_counts[name] = self.request_counts.get(name, 0) + 1
            self.is_sending = name == "burst"
            self._note(request)
        events = self.kind(self, request)
        if events is None:
            events = [] if request is None else self.honest(request)
        # Only on UART, packets arrive without a request.
        return [e for e in events if self.bus == "uart" or not isinstance(e, Arrived)]

    def name_of(self, request: Request | None) -> str:
        """Return the name of a request.

        ``burst`` starts the packets, ``read`` requests one of them, ``map`` a part of
        the map, and ``state`` other telemetry.
        """
        if request is None:
            return "idle"
        if request.kind == "telecommand":
            return "burst" if request.id == self.burst else "command"
        if self.receive and request.id == self.receive.telemetry:
            return "read"
        is_map = self.map is not None and request.id in self.map.telemetry
        return "map" if is_map else "state"

    def step_of(self, request: Request) -> Get | Poll:
        """Return the step that requests telemetry."""
        return next(
            step
            for step in self.form.steps
            if isinstance(step, (Get, Poll)) and step.telemetry == request.id
        )

    def done(self, request: Request, values: dict[int, int]) -> list[Event]:
        """Return telemetry with these numbers by register, others 0."""
        frame = bytearray(self.link.frames[request.id])
        for take in self.step_of(request).takes:
            take.place.put(values.get(take.register, 0), frame)
        return [Done(request.id, 1, bytes(frame))]

    def packet(self, position: int, data: bytes | None = None) -> Arrived:
        assert self.blocks and self.receive
        packet = bytearray(self.receive.data_at)
        number = self.blocks.first_packet + position
        self.receive.number.put(number, packet)
        packet += bytes(self.blocks.packet_bytes) if data is None else data
        return Arrived(self.receive.telemetry, bytes(packet), {})

    def honest(self, request: Request) -> list[Event]:
        name = self.name_of(request)
        if request.kind == "telecommand":
            events: list[Event] = []
            if name == "burst":
                assert self.blocks
                count = -(-self.loaded // self.blocks.packet_bytes)
                self.unread = list(range(count))
                if self.bus == "uart":
                    events = [self.packet(position) for position in range(count)]
            acknowledged = self.link.commands[request.id].acknowledged
            return [*events, Done(request.id, 1) if acknowledged else Sent(request.id)]
        if name == "map":
            return [Done(request.id, 1, self.map_of(self.received, request.id))]
        if name == "read":
            return self.read(self.unread.pop(0) if self.unread else 0)
        return self.done(request, self.honest_values(request))

    def honest_values(self, request: Request) -> dict[int, int]:
        """Return the numbers of telemetry with which the procedure succeeds."""
        step, values = self.step_of(request), dict[int, int]()
        for test in step.until if isinstance(step, Poll) else ():
            values[test.register] = self.value_of(test)
        for other in self.form.steps:
            if isinstance(other, SetLength):
                values[other.value.number] = self.loaded
            elif isinstance(other, VerifyChecksum):
                values[other.value.number] = self.checksum(other)
            elif isinstance(other, Verify):
                values[other.test.register] = self.value_of(other.test)
        return values

    def value_of(self, test: Test) -> int:
        """Return the value with which a test holds."""
        value = test.value
        return (
            self.registers.get(value.number, 0) if value.in_register else value.number
        )

    def checksum(self, step: VerifyChecksum) -> int:
        """Return the checksum of a block of zeros, or of what was received."""
        assert self.blocks
        if self.blocks.sends:
            data = b"".join(self.received[n] for n in sorted(self.received))
        else:
            packets = -(-self.loaded // self.blocks.packet_bytes)
            is_whole = step.covers_fill
            size = packets * self.blocks.packet_bytes if is_whole else self.loaded
            data = bytes(size)
        return checksum(self.link, step.checksum, data)

    def read(self, position: int) -> list[Event]:
        """Return a packet that the client reads."""
        assert self.receive
        return [Done(self.receive.telemetry, 1, self.packet(position).data)]

    def map_of(self, received: Collection[int], id: int) -> bytes:
        """Return a part of the map with these packets."""
        assert self.blocks and self.map
        data, bits = bytearray(self.map.length), 8 * self.map.bytes
        first = self.map.telemetry.index(id) * bits
        for bit in range(bits):
            state = self.map.beyond_end
            if first + bit < self.packets:
                number = self.blocks.first_packet + first + bit
                state = (number in received) == self.map.received
            at, mask = self.map.place(bit)
            data[at] |= mask if state else 0
        return bytes(data)

    def _note(self, request: Request) -> None:
        """Keep the numbers and the packet of a telecommand."""
        for step in self.form.steps:
            is_sent = request.kind == "telecommand" and isinstance(step, Send)
            if not is_sent or step.telecommand != request.id:
                continue
            for put in step.puts:
                if put.value.in_register:
                    self.registers[put.value.number] = put.place.of(request.data)
            if step.packet_at is not None and self.blocks:
                end = step.packet_at + self.blocks.packet_bytes
                number = self.registers[PACKET_NUMBER]
                self.received[number] = request.data[step.packet_at : end]
                return
        if self.name_of(request) == "command" and self.blocks and self.blocks.sends:
            is_map = self.map is not None and request.id in self.map.telecommands
            if not is_map and BLOCK_LENGTH not in self._numbers_of(request):
                self.received = {}  # a telecommand before the packets of a block

    def _numbers_of(self, request: Request) -> set[int]:
        return {
            put.value.number
            for step in self.form.steps
            if isinstance(step, Send) and step.telecommand == request.id
            for put in step.puts
            if put.value.in_register
        }


Kind = Callable[[Device, "Request | None"], Events]


def _state(device: Device, request: Request | None) -> Request | None:
    """Return a request of telemetry with the state of the device, or None."""
    return request if device.name_of(request) == "state" else None


def honest(device: Device, request: Request | None) -> Events:
    return None


def repeats_one_packet(device: Device, request: Request | None) -> Events:
    if device.name_of(request) == "burst":
        return [device.packet(0), Timeout(0, 1)]
    if device.name_of(request) == "read":
        return device.read(0)
    return [device.packet(0)] if request is None and device.is_sending else None


def sends_packets_slowly(device: Device, request: Request | None) -> Events:
    """Send a new packet shortly before the end of each silence; never the last."""
    if device.name_of(request) == "burst":
        return [Timeout(0, 1)]
    if request is None and device.is_sending:
        count = device.request_counts["idle"] = device.request_counts.get("idle", 0) + 1
        return [device.packet(count // 8 % 15)]
    return None


def sends_packets_of_other_lengths(device: Device, request: Request | None) -> Events:
    if device.name_of(request) == "burst":
        many = range(device.packets)
        return [*(device.packet(n, b"\1") for n in many), Timeout(0, 1)]
    return None


def sends_unknown_packets(device: Device, request: Request | None) -> Events:
    if request is None and device.receive:
        return [device.packet(device.packets)]
    return None


def alternates(device: Device, request: Request | None) -> Events:
    """Alternate two states in each frame."""
    if state := _state(device, request):
        number = device.request_counts["state"] % 2
        registers = [take.register for take in device.step_of(state).takes]
        return device.done(state, dict.fromkeys(registers, number))
    return None


def is_never_ready(device: Device, request: Request | None) -> Events:
    if state := _state(device, request):
        step, values = device.step_of(state), device.honest_values(state)
        for test in step.until if isinstance(step, Poll) else ():
            values[test.register] = values[test.register] ^ 1
        return device.done(state, values)
    return None


def never_ends(device: Device, request: Request | None) -> Events:
    """List another entry each time. The honest device has bytes without end."""
    if (state := _state(device, request)) and state.id == device.form.entry:
        [done] = device.done(state, device.honest_values(state))
        assert isinstance(done, Done)
        count = device.request_counts["state"].to_bytes(4, "big")
        return [Done(state.id, 1, done.data[:-4] + count)]
    return None


def answers_the_previous_request(device: Device, request: Request | None) -> Events:
    """Return each state one request late."""
    if request is None or request.kind == "telecommand":
        return None
    states = device.__dict__.setdefault("states", {})
    current = device.honest(request)
    previous: list[Event] = states.get(request.id, current)
    states[request.id] = current
    return previous


def sends_the_same_frame(device: Device, request: Request | None) -> Events:
    if (state := _state(device, request)) and state.id == device.form.entry:
        [done] = device.done(state, device.honest_values(state))
        assert isinstance(done, Done)
        return [Done(state.id, 1, done.data[:-1] + b"\1")]
    return None


def _with_length(device: Device, request: Request | None, length: int) -> Events:
    """Return the state with another length of the block, and a wrong checksum."""
    state = _state(device, request)
    if state is None or device.blocks is None or device.blocks.sends:
        return None
    values = device.honest_values(state)
    for step in device.form.steps:
        if isinstance(step, SetLength):
            values[step.value.number] = length
        elif isinstance(step, VerifyChecksum):
            values[step.value.number] ^= 1
    return device.done(state, values)


def loads_empty_blocks(device: Device, request: Request | None) -> Events:
    return _with_length(device, request, 0)


def loads_longer_blocks(device: Device, request: Request | None) -> Events:
    return _with_length(device, request, device.loaded + 1)


def has_wrong_checksums(device: Device, request: Request | None) -> Events:
    if state := _state(device, request):
        values = device.honest_values(state)
        for step in device.form.steps:
            if isinstance(step, VerifyChecksum):
                values[step.value.number] ^= 1
        return device.done(state, values)
    return None


def misses_a_packet(device: Device, request: Request | None) -> Events:
    """Report the same packet as missing, whatever the client sends."""
    if request and device.name_of(request) == "map":
        assert device.blocks
        first = device.blocks.first_packet
        received = range(first + 1, first + device.packets)
        return [Done(request.id, 1, device.map_of(received, request.id))]
    return None


def has_flags_of_several_bits(device: Device, request: Request | None) -> Events:
    """Set each flag to another value than 1, if it has several bits."""
    if state := _state(device, request):
        step, values = device.step_of(state), device.honest_values(state)
        for test in step.until if isinstance(step, Poll) else ():
            values[test.register] *= 2
        return device.done(state, values)
    return None


def fails_each_time(device: Device, request: Request | None) -> Events:
    if state := _state(device, request):
        step, values = device.step_of(state), device.honest_values(state)
        for test in step.fails if isinstance(step, Poll) else ():
            values[test.register] = device.value_of(test)
        for other in device.form.steps:
            if isinstance(other, Verify):
                values[other.test.register] ^= 1
        return device.done(state, values)
    return None


def refuses(device: Device, request: Request | None) -> Events:
    return None if request is None else [Refused(request.id, 1)]


def refuses_with_an_unknown_code(device: Device, request: Request | None) -> Events:
    return None if request is None else [Refused(request.id, 1, UNKNOWN_CODE)]


def refuses_now_and_then(device: Device, request: Request | None) -> Events:
    """Refuse all but every fourth request, with an unknown code."""
    count = device.__dict__["count"] = device.__dict__.get("count", 0) + 1
    return refuses_with_an_unknown_code(device, request) if count % 4 else None


def is_silent(device: Device, request: Request | None) -> Events:
    return None if request is None else [Timeout(request.id, 1)]


def acknowledges_nothing(device: Device, request: Request | None) -> Events:
    """Execute a telecommand that is sent once, but do not acknowledge it."""
    if request is None or request.repeat or request.kind == "telemetry":
        return None
    return [*device.honest(request)[:-1], Timeout(request.id, 1)]


def is_busy(device: Device, request: Request | None) -> Events:
    return None if request is None else [Busy(request.id, 1)]


def sets_all_bits(device: Device, request: Request | None) -> Events:
    if request is None or request.kind == "telecommand":
        return None
    return [Done(request.id, 1, b"\xff" * device.link.frames[request.id])]


def clears_all_bits(device: Device, request: Request | None) -> Events:
    if request is None or request.kind == "telecommand":
        return None
    return [Done(request.id, 1, bytes(device.link.frames[request.id]))]


def is_about_another_object(device: Device, request: Request | None) -> Events:
    """Report a state with another value than that of the input that it repeats."""
    if state := _state(device, request):
        step, values = device.step_of(state), device.honest_values(state)
        for test in step.until if isinstance(step, Poll) else ():
            if test.value.in_register:
                values[test.register] += 1
        return device.done(state, values)
    return None


KINDS: tuple[Kind, ...] = (
    honest,
    repeats_one_packet,
    sends_packets_slowly,
    sends_packets_of_other_lengths,
    sends_unknown_packets,
    alternates,
    is_never_ready,
    never_ends,
    answers_the_previous_request,
    sends_the_same_frame,
    loads_empty_blocks,
    loads_longer_blocks,
    has_wrong_checksums,
    misses_a_packet,
    has_flags_of_several_bits,
    fails_each_time,
    refuses,
    refuses_with_an_unknown_code,
    refuses_now_and_then,
    is_silent,
    acknowledges_nothing,
    is_busy,
    sets_all_bits,
    clears_all_bits,
    is_about_another_object,
)


def at_random(seed: int) -> Kind:
    """Return a kind that answers with random well-formed frames and outcomes."""
    source = Random(seed)
    honesty, success = source.random(), source.random()

    def random_kind(device: Device, request: Request | None) -> Events:
        if request is None:
            if not device.receive or not device.blocks:
                return None
            size = device.blocks.packet_bytes
            return [
                device.packet(source.randrange(20), source.randbytes(size))
                for _ in range(source.randrange(3))
            ]
        if source.random() < honesty:
            return None
        if source.random() > success:
            code = source.choice([None, UNKNOWN_CODE])
            id = request.id
            return [source.choice([Refused(id, 1, code), Timeout(id, 1), Busy(id, 1)])]
        if request.kind == "telecommand":
            return [Done(request.id, 1)]
        if device.name_of(request) != "state" or source.random() < 0.3:
            size = device.link.frames[request.id]
            values = [source.choice([0, 0, 1, 2, 255, source.randrange(256)])]
            return [Done(request.id, 1, bytes((values * size)[:size]))]
        numbers = device.honest_values(request)
        for take in device.step_of(request).takes:
            if source.random() < 0.3:
                likely = [0, 1, device.loaded, device.loaded + 1]
                numbers[take.register] = source.choice(likely)
        return device.done(request, numbers)

    return random_kind
