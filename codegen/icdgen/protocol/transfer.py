"""Procedures over a client: list of files, download, upload, erasing, formatting.

A procedure says which request comes next and is told what became of it. It knows neither clock nor bus: `next` gives the
request, or None while there is nothing to send; `event` takes the events of the client.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, TypeVar

from icdgen import codec
from icdgen.icd.model import TELECOMMAND, TELEMETRY
from icdgen.protocol import crc, files
from icdgen.protocol.client import Request
from icdgen.protocol.errors import RangeError, TooLongError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import UART, Step

OUTCOMES = ("done", "refused", "timeout")


class Ended(Exception):
    """Why a procedure cannot go on: "refused", "timeout", "parameter", "length", "rounds", "checksum", "error"."""


@dataclass(frozen=True, slots=True)
class Wait:
    """Nothing to send until then, or until something comes."""

    until: int


T = TypeVar("T")
# Gives out what is to be sent, is told what came, and has a result.
Asking = Generator["Request | Wait", "dict[str, Any] | None", T]
Steps = Asking[None]


class Procedure:
    """What all procedures share. ``result``: None while it runs, then "done" or why it failed."""

    def __init__(self, known: Facts) -> None:
        self.known = known
        self.now = 0
        self.result: str | None = None
        self._is_asked = False  # a request was given out, its outcome is waited for
        self._wanted: Request | Wait | None = None
        self._steps: Steps | None = None

    def _run(self) -> Steps:
        raise NotImplementedError

    @property
    def deadline(self) -> int | None:
        """When `next` wants to be called at the latest; None: when something has come."""
        return self._wanted.until if isinstance(self._wanted, Wait) else None

    def next(self, now: int) -> Request | None:
        """The next request, once."""
        self.now = now
        if self._steps is None:
            self._steps = self._run()
            self._go_on(None)
        while isinstance(self._wanted, Wait) and now >= self._wanted.until:
            self._go_on(None)
        if isinstance(self._wanted, Request) and not self._is_asked:
            self._is_asked = True
            return self._wanted
        return None

    def event(self, now: int, event: dict[str, Any]) -> None:
        """Takes an event of the client."""
        self.now = now
        if event["event"] == "packet":
            self.packet(event["number"], bytes.fromhex(event["bytes"]))
        elif event["event"] in OUTCOMES and self._is_asked:
            self._is_asked = False
            self._go_on(event)

    def packet(self, number: int, data: bytes) -> None:
        """Takes a download packet."""

    def _go_on(self, event: dict[str, Any] | None) -> None:
        try:
            assert self._steps
            self._wanted = self._steps.send(event)
        except StopIteration:
            self._wanted, self.result = None, "done"
        except Ended as failure:
            self._wanted, self.result = None, str(failure)

    def ask(self, request: Request) -> Asking[dict[str, Any]]:
        """A request; its outcome."""
        outcome = yield request
        assert outcome
        return outcome

    def demand(self, request: Request) -> Asking[dict[str, Any]]:
        """A request that must succeed; its outcome."""
        outcome = yield from self.ask(request)
        if outcome["event"] != "done":
            raise Ended(outcome["event"])
        return outcome

    def wait(self, milliseconds: int) -> Steps:
        yield Wait(self.now + milliseconds)

    def telecommand(self, step: Step, repeat: bool = True, **values: int | bytes) -> Asking[dict[str, Any]]:
        """Sends the telecommand of a step with values by role; others as a fresh message has them."""
        return self.demand(self.request(step, repeat, **values))

    def once(self, step: Step, **values: int | bytes) -> Steps:
        """Sends a telecommand once, whatever becomes of it but a refusal: what follows tells whether it arrived."""
        outcome = yield from self.ask(self.request(step, False, **values))
        if outcome["event"] == "refused":
            raise Ended("refused")

    def request(self, step: Step, repeat: bool = True, /, **values: int | bytes) -> Request:
        """The telecommand of a step."""
        assert step.message.telecommand_id is not None
        return Request(TELECOMMAND, step.message.telecommand_id, step.frame(self.known.node, values), repeat)

    def telemetry(self, step: Step) -> Asking[tuple[dict[str, Any], bytes]]:
        """Requests the frame of a step: its values by role, and its bytes."""
        assert step.message.telemetry_id is not None
        outcome = yield from self.demand(Request(TELEMETRY, step.message.telemetry_id, repeat=True))
        frame = bytes.fromhex(outcome["bytes"])
        raw = codec.decode(self.known.node, step.message, frame)
        return {role: raw[name] for role, name in step.fields.items()}, frame

    def poll(
        self, step: Step, role: str, wanted: int, interval: int, timeout: int, program: int | None = None
    ) -> Asking[tuple[dict[str, Any], bytes]]:
        """Requests the frame until the flag is as wanted, of that program if the frame says of which one."""
        end = self.now + timeout
        while True:
            values, frame = yield from self.telemetry(step)
            meant = program is None or values.get("program", program) == program
            if (values[role] == wanted and meant) or values.get("error"):
                return values, frame
            if self.now >= end:
                raise Ended("timeout")
            yield from self.wait(interval)


class Transfer(Procedure):
    """A procedure of file transfer. ``block``: bytes that are transferred together, no more than the ICD says."""

    def __init__(self, known: Facts, block: int | None = None) -> None:
        super().__init__(known)
        self.files = need(known.files, "file_transfer")
        self.block = min(block or self.files.block_bytes, self.files.block_bytes)

    def hole_maps(self, count: int) -> list[Step]:
        """The messages that carry the map of a block of so many packets, each with its field for the role ``map``."""
        form = need(self.known.hole_map, "file_transfer.hole_map")
        carrying = -(-count // (form.message_bytes * 8))
        return [Step(message, {"map": form.field}) for message in form.messages[:carrying]]


class FileList(Transfer):
    """The files of the node, one after the other, in ``entries``: values of the information frame by role."""

    def __init__(self, known: Facts) -> None:
        super().__init__(known)
        self.form = need(self.files.list, "file_transfer.list")
        self.entries: list[dict[str, Any]] = []

    def _run(self) -> Steps:
        form, last, again = self.form, None, 0
        yield from self.telecommand(form.reset)
        while True:
            values, frame = yield from self.poll(form.information, "busy", 0, form.poll_interval, form.timeout)
            if not any(frame):
                return
            if frame != last:
                self.entries.append({role: value for role, value in values.items() if role != "busy"})
                again = 0
            elif again > self.known.client.retries:
                raise Ended("timeout")
            last, again = frame, again + 1
            # Sent once: if only its acknowledge was lost, the next frame tells that it arrived.
            yield from self.once(form.advance)


class Download(Transfer):
    """A file from the node, block by block, in ``blocks``. ``size`` None: as much as there is, as of the index file."""

    def __init__(
        self, known: Facts, bus: str, type: int, counter: int, size: int | None, block: int | None = None
    ) -> None:
        super().__init__(known, block)
        self.form = need(self.files.download, "file_transfer.download")
        self.bus, self.type, self.counter, self.size = bus, type, counter, size
        self.blocks: list[tuple[int, bytes]] = []
        self.offset = 0
        self.got: dict[int, bytes] = {}  # packets of this block by position
        self.count = 0
        self.last = 0  # when the last packet came

    def packet(self, number: int, data: bytes) -> None:
        position = number - self.files.first_packet
        if 0 <= position < self.count:
            self.got.setdefault(position, data)
            self.last = self.now
            if len(self.got) == self.count and isinstance(self._wanted, Wait):
                self._wanted = Wait(self.now)

    def _run(self) -> Steps:
        while self.size is None or self.offset < self.size:
            want = self.block if self.size is None else min(self.block, self.size - self.offset)
            data = yield from self._block(want)
            if data:
                self.blocks.append((self.offset, data))
                self.offset += len(data)
            if self.size is None and len(data) < want:
                return

    def _block(self, want: int) -> Asking[bytes]:
        form, rounds = self.form, 0
        while True:
            self.got, self.count = {}, 0
            place = {"type": self.type, "counter": self.counter, "offset": self.offset}
            yield from self.telecommand(form.load, True, **place, length=want)
            ready, _ = yield from self.poll(form.ready, "ready", 1, form.poll_interval, form.ready_timeout)
            if ready["error"]:
                raise Ended("parameter")
            size = ready["length"]
            if size > want or (self.size is not None and size != want):
                raise Ended("length")
            self.count = self.known.packets_of(size)
            while len(self.got) < self.count:
                if rounds == form.rounds:
                    raise Ended("rounds")
                rounds += 1
                yield from self._round()
            packets = b"".join(self.got[position] for position in range(self.count))
            covered = packets if form.checksum_covers_fill else packets[:size]
            if crc.compute(need(self.known.crc16, "crc16"), covered) == ready["checksum"]:
                return packets[:size]
            if rounds == form.rounds:
                raise Ended("checksum")
            if not size:
                rounds += 1

    def _round(self) -> Steps:
        if self.got:
            yield from self._send_hole_map()
        missing = [position for position in range(self.count) if position not in self.got]
        everything = not self.got
        self.last = self.now
        # Sent once: that packets come, or none, tells more than its acknowledge.
        yield from self.once(self.form.burst, length=self.form.message_length, ignore_hole_map=int(everything))
        if self.bus != UART:
            counter = self.files.counter_bytes
            id = need(self.files.packet_ids.get(self.bus), f"file_transfer.download.{self.bus}")
            for _ in missing:
                outcome = yield from self.ask(Request(TELEMETRY, id, repeat=True))
                if outcome["event"] == "done":
                    data = bytes.fromhex(outcome["bytes"])
                    self.packet(self.known.number(data[:counter]), data[counter:])
            return
        self.last = max(self.last, self.now)
        while len(self.got) < self.count and self.now < self.last + self.form.silence:
            yield Wait(self.last + self.form.silence)

    def _send_hole_map(self) -> Steps:
        first = self.files.first_packet
        map_ = files.hole_map(self.known, self.count, [first + position for position in self.got])
        for step, piece in zip(self.hole_maps(self.count), files.in_messages(self.known, map_), strict=False):
            yield from self.telecommand(step, map=piece)


class Upload(Transfer):
    """A file to the node, block by block. ``sent``: bytes that are committed.

    Raises `icdgen.protocol.facts.Unsupported`, `RangeError` and `TooLongError`.
    """

    def __init__(self, known: Facts, destination: int, data: bytes, block: int | None = None) -> None:
        super().__init__(known, block)
        form = self.form = need(self.files.upload, "file_transfer.upload")
        if form.destinations and destination not in form.destinations:
            raise RangeError("destination")
        most = form.destination_bytes
        if most is not None and len(data) > most:
            raise TooLongError(most, len(data))
        self.destination, self.data = destination, data
        self.sent = 0

    def _run(self) -> Steps:
        form = self.form
        yield from self.telecommand(form.initiate, destination=self.destination, block_size=form.block_size)
        yield from self.poll(form.initiated, "busy", 0, form.poll_interval, form.erase_timeout)
        while self.sent < len(self.data):
            data = self.data[self.sent : self.sent + self.block]
            yield from self._block(data)
            self.sent += len(data)

    def _block(self, data: bytes) -> Steps:
        form, size, rounds = self.form, self.files.packet_bytes, 0
        count = self.known.packets_of(len(data))
        filled = data.ljust(count * size, bytes([self.files.fill]))
        covered = filled if form.checksum_covers_fill else data
        while True:
            yield from self.telecommand(form.begin)
            missing = list(range(count))
            while missing:
                if rounds == form.rounds:
                    raise Ended("rounds")
                rounds += 1
                for position in missing:
                    packet = filled[position * size : (position + 1) * size]
                    number = self.files.first_packet + position
                    yield from self.telecommand(form.packet, False, number=number, bytes=packet)
                missing = yield from self._missing(count)
            checksum, _ = yield from self.telemetry(form.checksum)
            if checksum["checksum"] == crc.compute(need(self.known.crc16, "crc16"), covered):
                what = {"destination": self.destination, "offset": self.sent, "length": len(data)}
                yield from self.telecommand(form.finalize, True, **what)
                poll = self.poll(form.finalized, "busy", 0, form.poll_interval, form.finalize_timeout)
                finalized, _ = yield from poll
                if not finalized["error"]:
                    return
            if rounds == form.rounds:
                raise Ended("checksum")

    def _missing(self, count: int) -> Asking[list[int]]:
        """Positions of the packets that the node has not."""
        map_ = b""
        for step in self.hole_maps(count):
            values, _ = yield from self.telemetry(step)
            map_ += values["map"]
        size = need(self.known.hole_map, "file_transfer.hole_map").bytes
        lost = files.missing(self.known, count, map_.ljust(size, b"\0"))
        return [number - self.files.first_packet for number in lost]


class Erase(Transfer):
    """Deletes a file, or all of them: then it is done when the node is no longer busy."""

    def __init__(self, known: Facts, type: int, counter: int, all: bool) -> None:
        super().__init__(known)
        self.form = need(self.files.erase, "file_transfer.erase")
        self.values = {"type": type, "counter": counter, "all": int(all)}

    def _run(self) -> Steps:
        yield from self.telecommand(self.form.request, True, **self.values)
        if self.values["all"]:
            yield from self.poll(self.form.progress, "busy", 0, self.form.poll_interval, self.form.timeout)


class Format(Transfer):
    """Formats the medium."""

    def __init__(self, known: Facts) -> None:
        super().__init__(known)
        self.form = need(self.files.format, "file_transfer.format")

    def _run(self) -> Steps:
        form = self.form
        yield from self.telecommand(form.request)
        yield from self.poll(form.progress, "busy", 0, form.poll_interval, form.timeout)
