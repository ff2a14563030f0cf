"""Kinds of hostile devices.

A kind is a function of the device and of the client's request, or None while the line
is idle. It returns the events that the client reports. None leaves the response to the
honest device, which has a file without end and any number of blocks.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

from icdgen_runtime.wire.client import Request
from icdgen_runtime.wire.crc import crc16
from icdgen_runtime.wire.events import Done, Event, Packet, Refused, Timeout
from icdgen_runtime.wire.files import HoleMap
from icdgen_runtime.wire.link import Bus, Link, Step

Events = list[Event] | None
UNKNOWN_CODE = 200


class Device:
    """A device during one procedure, for example ``download``."""

    def __init__(
        self, link: Link[Any], procedure: str, kind: Kind, bus: Bus = "uart"
    ) -> None:
        self.link, self.kind, self.bus = link, kind, bus
        assert link.files
        self.files = link.files
        form = getattr(link, procedure, None) or getattr(link.files, procedure)
        self.steps: dict[str, Step] = {
            name: step
            for name, step in form._asdict().items()
            if isinstance(step, Step)
        }
        self.names = {
            (kind, id): name
            for name, step in self.steps.items()
            for kind, id in (
                ("telecommand", step.telecommand),
                ("telemetry", step.telemetry),
            )
        }
        self.source = Random(1)
        self.asked: dict[str, int] = {}  # number of requests by step
        self.loaded = 0  # bytes of the block that the client requested last
        self.uploaded: dict[int, bytes] = {}
        self.unread: list[int] = []  # packets that the client reads one at a time
        self.is_sending = False  # between a burst and the next request

    def answer(self, request: Request | None) -> list[Event]:
        """Return the events of a request, or of an idle line."""
        name = self.name_of(request)
        if request is not None:
            self.asked[name] = self.asked.get(name, 0) + 1
            self.is_sending = name == "burst"
            self._note(name, request)
        events = self.kind(self, request)
        if events is None:
            events = [] if request is None else self.honest(request)
        # Only on UART, packets arrive without a request.
        return [e for e in events if self.bus == "uart" or not isinstance(e, Packet)]

    def name_of(self, request: Request | None) -> str:
        """Name of the step of a request; ``map`` for a part of the hole map, ``read``
        for a packet that the client reads.
        """
        if request is None:
            return "idle"
        if request.kind == "telemetry" and request.id == self.files.packet_ids.get(
            self.bus
        ):
            return "read"
        return self.names.get((request.kind, request.id), "map")

    def values_of(self, name: str, request: Request) -> dict[str, Any]:
        """Return the values of a telecommand by role."""
        message = self.link.TELECOMMANDS[request.id].from_bytes(request.data)
        return {r: getattr(message, at) for r, at in self.steps[name].fields.items()}

    def done(self, name: str, **values: Any) -> list[Event]:
        """Return the frame of a step with these values by role, others 0."""
        step = self.steps[name]
        assert step.telemetry is not None
        frame = self.link.TELEMETRY[step.telemetry]()
        for role in values.keys() & step.fields.keys():
            setattr(frame, step.fields[role], values[role])
        return [Done(step.telemetry, 1, frame.to_bytes())]

    def packet(self, position: int, data: bytes | None = None) -> Packet:
        data = bytes(self.files.packet_bytes) if data is None else data
        return Packet(self.files.first_packet + position, data)

    def checksum(self, size: int) -> int:
        """Return the checksum of a block of so many zeros."""
        form = self.files.download
        whole = self.files.packets_of(size) * self.files.packet_bytes
        is_whole = form is not None and form.checksum_covers_fill
        return crc16(self.link, bytes(whole if is_whole else size))

    def honest(self, request: Request) -> list[Event]:
        name = self.name_of(request)
        if request.kind == "telecommand":
            packets: list[Event] = []
            if name == "burst":
                count = self.files.packets_of(self.loaded)
                self.unread = list(range(count))
                if self.bus == "uart":
                    packets = [self.packet(position) for position in range(count)]
            return [*packets, Done(request.id, 1)]
        if name == "map":
            return [Done(request.id, 1, self.map_of(self.uploaded, request.id))]
        if name == "read":
            return self.read(self.unread.pop(0) if self.unread else 0)
        return self.done(name, **self.honest_values(name))

    def honest_values(self, name: str) -> dict[str, Any]:
        if name == "ready":
            size = self.loaded
            return {"ready": 1, "length": size, "checksum": self.checksum(size)}
        if name == "checksum":
            data = b"".join(self.uploaded[number] for number in sorted(self.uploaded))
            return {"checksum": crc16(self.link, data)}
        return {"ready": 1, "program": 1}

    def read(self, position: int) -> list[Event]:
        """Return a packet that the client reads."""
        id, packet = self.files.packet_ids[self.bus], self.packet(position)
        size = self.files.counter_bytes
        head = packet.number.to_bytes(size, self.link.order)
        return [Done(id, 1, head + packet.data)]

    def map_of(self, received: Any, id: int) -> bytes:
        """Return a part of the hole map with these packets."""
        form = self.link.hole_map
        assert form
        pieces = HoleMap(self.link, self.files.block_packets, received).messages()
        frame = self.link.TELEMETRY[id]()
        setattr(frame, form.attribute, pieces[form.telemetry.index(id)])
        return frame.to_bytes()

    def _note(self, name: str, request: Request) -> None:
        if name == "load":
            self.loaded = self.values_of(name, request)["length"]
        elif name == "begin":
            self.uploaded = {}
        elif name == "packet":
            values = self.values_of(name, request)
            self.uploaded[values["number"]] = values["bytes"]


Kind = Callable[[Device, "Request | None"], Events]


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
        count = device.asked["idle"] = device.asked.get("idle", 0) + 1
        return [device.packet(count // 8 % 15)]
    return None


def sends_packets_of_other_lengths(device: Device, request: Request | None) -> Events:
    if device.name_of(request) == "burst":
        many = range(device.files.block_packets)
        return [*(device.packet(n, b"\1") for n in many), Timeout(0, 1)]
    return None


def sends_unknown_packets(device: Device, request: Request | None) -> Events:
    return [device.packet(device.files.block_packets)] if request is None else None


def alternates(device: Device, request: Request | None) -> Events:
    """Alternate two states in each frame."""
    name = device.name_of(request)
    if request and request.kind == "telemetry" and name in device.steps:
        state = device.asked[name] % 2
        return device.done(
            name, size=1 + state, counter=1, length=state, checksum=state
        )
    return None


def is_never_ready(device: Device, request: Request | None) -> Events:
    name = device.name_of(request)
    if request and request.kind == "telemetry" and name in device.steps:
        return device.done(name, busy=1, ready=0, program=1)
    return None


def never_ends(device: Device, request: Request | None) -> Events:
    """List another file each time. The honest device has a file without end."""
    name = device.name_of(request)
    if name == "information":
        return device.done(name, counter=1, size=device.asked[name])
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
    name = device.name_of(request)
    if name == "information":
        return device.done(name, counter=1, size=1)
    return None


def loads_empty_blocks(device: Device, request: Request | None) -> Events:
    if device.name_of(request) == "ready":
        return device.done("ready", ready=1, length=0, checksum=device.checksum(0) ^ 1)
    return None


def loads_longer_blocks(device: Device, request: Request | None) -> Events:
    if device.name_of(request) == "ready":
        return device.done("ready", ready=1, length=device.loaded + 1)
    return None


def has_wrong_checksums(device: Device, request: Request | None) -> Events:
    name = device.name_of(request)
    if name in ("ready", "checksum") and request and request.kind == "telemetry":
        values = device.honest_values(name)
        return device.done(name, **{**values, "checksum": values["checksum"] ^ 1})
    return None


def misses_a_packet(device: Device, request: Request | None) -> Events:
    """Report the same packet as missing, whatever the client sends."""
    if request and request.kind == "telemetry" and device.name_of(request) == "map":
        first = device.files.first_packet
        others = range(first + 1, first + device.files.block_packets)
        return [Done(request.id, 1, device.map_of(others, request.id))]
    return None


def has_flags_of_several_bits(device: Device, request: Request | None) -> Events:
    """Set a flag of several bits to another value than 1."""
    if device.name_of(request) == "ready":
        return device.done("ready", **{**device.honest_values("ready"), "ready": 2})
    return None


def fails_each_time(device: Device, request: Request | None) -> Events:
    name = device.name_of(request)
    if request and request.kind == "telemetry" and name in ("ready", "finalized"):
        return device.done(name, error=1, ready=1)
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


def sets_all_bits(device: Device, request: Request | None) -> Events:
    if request is None or request.kind == "telecommand":
        return None
    return [Done(request.id, 1, b"\xff" * device.link.frames[request.id])]


def clears_all_bits(device: Device, request: Request | None) -> Events:
    if request is None or request.kind == "telecommand":
        return None
    return [Done(request.id, 1, bytes(device.link.frames[request.id]))]


def is_about_another_program(device: Device, request: Request | None) -> Events:
    name = device.name_of(request)
    return device.done(name, ready=1, program=2) if name == "progress" else None


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
    sets_all_bits,
    clears_all_bits,
    is_about_another_program,
)


def at_random(seed: int) -> Kind:
    """Return a kind that answers with random well-formed frames and outcomes."""
    source = Random(seed)
    honesty, success = source.random(), source.random()

    def random_kind(device: Device, request: Request | None) -> Events:
        if request is None:
            count, packet_bytes = source.randrange(3), device.files.packet_bytes
            return [
                device.packet(source.randrange(20), source.randbytes(packet_bytes))
                for _ in range(count)
            ]
        if source.random() < honesty:
            return None
        if source.random() > success:
            code = source.choice([None, UNKNOWN_CODE])
            return [
                source.choice([Refused(request.id, 1, code), Timeout(request.id, 1)])
            ]
        if request.kind == "telecommand":
            return [Done(request.id, 1)]
        name = device.name_of(request)
        if name not in device.steps or source.random() < 0.3:
            size = device.link.frames[request.id]
            values = [source.choice([0, 0, 1, 2, 255, source.randrange(256)])]
            return [Done(request.id, 1, bytes((values * size)[:size]))]
        values_of_roles = {
            role: source.choice([0, 1, device.loaded, device.loaded + 1])
            for role in ("busy", "error", "length", "size", "counter", "ready")
            if role in device.steps[name].fields
        }
        for role in ("busy", "error", "ready"):
            if role in values_of_roles:
                values_of_roles[role] = source.randrange(2)
        return device.done(name, **{**device.honest_values(name), **values_of_roles})

    return random_kind
