"""Procedures over a client: list of files, download, upload, deletion and formatting.

A procedure is independent of clock and bus. `next` returns the next request, or None if
there is nothing to send; `event` processes the events of the client.
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
    """End of a procedure with a failure: "refused", "timeout", "parameter", "length",
    "rounds", "checksum" or "error".
    """


@dataclass(frozen=True, slots=True)
class Wait:
    """Pause of a procedure until a time in ms, or until an event."""

    until: int


T = TypeVar("T")
# Generator that yields requests and pauses, receives events and returns a result.
Asking = Generator["Request | Wait", "dict[str, Any] | None", T]
Steps = Asking[None]


class Procedure:
    """Base class of procedures.

    ``result``: None while the procedure runs, then "done" or the reason of its
    failure.
    """

    def __init__(self, facts: Facts) -> None:
        self.facts = facts
        self.now = 0
        self.result: str | None = None
        self._is_outstanding = False  # whether the outcome of a request is awaited
        self._pending: Request | Wait | None = None
        self._steps: Steps | None = None

    def _run(self) -> Steps:
        raise NotImplementedError

    @property
    def deadline(self) -> int | None:
        """Latest time of the next call of `next`; None if it waits for an event."""
        return self._pending.until if isinstance(self._pending, Wait) else None

    def next(self, now: int) -> Request | None:
        """Return the next request, each once; None if there is nothing to send."""
        self.now = now
        if self._steps is None:
            self._steps = self._run()
            self._go_on(None)
        while isinstance(self._pending, Wait) and now >= self._pending.until:
            self._go_on(None)
        if isinstance(self._pending, Request) and not self._is_outstanding:
            self._is_outstanding = True
            return self._pending
        return None

    def event(self, now: int, event: dict[str, Any]) -> None:
        """Process an event of the client."""
        self.now = now
        if event["event"] == "packet":
            self.packet(event["number"], bytes.fromhex(event["bytes"]))
        elif event["event"] in OUTCOMES and self._is_outstanding:
            self._is_outstanding = False
            self._go_on(event)

    def packet(self, number: int, data: bytes) -> None:
        """Process a download packet. Only downloads use packets."""

    def _go_on(self, event: dict[str, Any] | None) -> None:
        try:
            assert self._steps
            self._pending = self._steps.send(event)
        except StopIteration:
            self._pending, self.result = None, "done"
        except Ended as failure:
            self._pending, self.result = None, str(failure)

    def ask(self, request: Request) -> Asking[dict[str, Any]]:
        """Send a request; return its outcome."""
        outcome = yield request
        assert outcome
        return outcome

    def demand(self, request: Request) -> Asking[dict[str, Any]]:
        """Send a request that must succeed; return its outcome.

        Raises `Ended` otherwise.
        """
        outcome = yield from self.ask(request)
        if outcome["event"] != "done":
            raise Ended(outcome["event"])
        return outcome

    def wait(self, milliseconds: int) -> Steps:
        yield Wait(self.now + milliseconds)

    def telecommand(
        self, step: Step, repeat: bool = True, **values: int | bytes
    ) -> Asking[dict[str, Any]]:
        """Send the telecommand of a step.

        ``values``: values by role; other fields have their initial values.
        """
        return self.demand(self.request(step, repeat, **values))

    def once(self, step: Step, **values: int | bytes) -> Steps:
        """Send a telecommand once and ignore a missing acknowledge.

        The following step shows whether it arrived. Raises `Ended` if the node refuses
        it.
        """
        outcome = yield from self.ask(self.request(step, False, **values))
        if outcome["event"] == "refused":
            raise Ended("refused")

    def request(
        self, step: Step, repeat: bool = True, /, **values: int | bytes
    ) -> Request:
        """Return the request for the telecommand of a step."""
        assert step.message.telecommand_id is not None
        return Request(
            TELECOMMAND,
            step.message.telecommand_id,
            step.frame(self.facts.node, values),
            repeat,
        )

    def telemetry(self, step: Step) -> Asking[tuple[dict[str, Any], bytes]]:
        """Request the frame of a step; return its values by role, and its bytes."""
        assert step.message.telemetry_id is not None
        outcome = yield from self.demand(
            Request(TELEMETRY, step.message.telemetry_id, repeat=True)
        )
        frame = bytes.fromhex(outcome["bytes"])
        raw = codec.decode(self.facts.node, step.message, frame)
        return {role: raw[name] for role, name in step.fields.items()}, frame

    def poll(
        self,
        step: Step,
        role: str,
        wanted: int,
        interval: int,
        timeout: int,
        program: int | None = None,
    ) -> Asking[tuple[dict[str, Any], bytes]]:
        """Request a frame until the flag ``role`` has the value ``wanted``.

        ``program``: program that the frame must refer to, if it names one. Raises
        `Ended` after ``timeout`` ms.
        """
        end = self.now + timeout
        while True:
            values, frame = yield from self.telemetry(step)
            is_for_program = (
                program is None or values.get("program", program) == program
            )
            if (values[role] == wanted and is_for_program) or values.get("error"):
                return values, frame
            if self.now >= end:
                raise Ended("timeout")
            yield from self.wait(interval)


class Transfer(Procedure):
    """Procedure of file transfer.

    ``block``: bytes of a block, limited to the maximum of the ICD.
    """

    def __init__(self, facts: Facts, block: int | None = None) -> None:
        super().__init__(facts)
        self.files = need(facts.files, "file_transfer")
        self.block = min(block or self.files.block_bytes, self.files.block_bytes)

    def hole_maps(self, count: int) -> list[Step]:
        """Return the messages that carry the hole map of a block of ``count`` packets.

        The field of each has the role ``map``.
        """
        form = need(self.facts.hole_map, "file_transfer.hole_map")
        carrying = -(-count // (form.message_bytes * 8))
        return [
            Step(message, {"map": form.field}) for message in form.messages[:carrying]
        ]


class FileList(Transfer):
    """List of the files of the node in ``entries``: values of each information frame by
    role.
    """

    def __init__(self, facts: Facts) -> None:
        super().__init__(facts)
        self.form = need(self.files.list, "file_transfer.list")
        self.entries: list[dict[str, Any]] = []

    def _run(self) -> Steps:
        form, last, repetitions = self.form, None, 0
        yield from self.telecommand(form.reset)
        while True:
            values, frame = yield from self.poll(
                form.information, "busy", 0, form.poll_interval, form.timeout
            )
            # A frame of zeros marks the end of the list.
            if not any(frame):
                return
            # An unchanged frame means that `advance` was not executed yet, or was lost.
            if frame != last:
                self.entries.append(
                    {role: value for role, value in values.items() if role != "busy"}
                )
                repetitions = 0
            elif repetitions > self.facts.client.retries:
                raise Ended("timeout")
            last, repetitions = frame, repetitions + 1
            # Sent once: if only its acknowledge was lost, the next frame tells that it
            # arrived.
            yield from self.once(form.advance)


class Download(Transfer):
    """Download of a file in ``blocks``.

    ``size``: bytes of the file; None for files of unknown size, such as the index file.
    """

    def __init__(
        self,
        facts: Facts,
        bus: str,
        type: int,
        counter: int,
        size: int | None,
        block: int | None = None,
    ) -> None:
        super().__init__(facts, block)
        self.form = need(self.files.download, "file_transfer.download")
        self.bus, self.type, self.counter, self.size = bus, type, counter, size
        self.blocks: list[tuple[int, bytes]] = []
        self.offset = 0
        # Received packets of this block by position
        self.packets: dict[int, bytes] = {}
        self.count = 0
        self.last = 0  # time of the last packet in ms

    def packet(self, number: int, data: bytes) -> None:
        position = number - self.files.first_packet
        # Packets of an earlier block can arrive late; the first copy of a packet
        # counts.
        if 0 <= position < self.count:
            self.packets.setdefault(position, data)
            self.last = self.now
            if len(self.packets) == self.count and isinstance(self._pending, Wait):
                self._pending = Wait(self.now)

    def _run(self) -> Steps:
        while self.size is None or self.offset < self.size:
            want = (
                self.block
                if self.size is None
                else min(self.block, self.size - self.offset)
            )
            data = yield from self._block(want)
            if data:
                self.blocks.append((self.offset, data))
                self.offset += len(data)
            # A short block is the last one of a file of unknown size.
            if self.size is None and len(data) < want:
                return

    def _block(self, want: int) -> Asking[bytes]:
        form, rounds = self.form, 0
        while True:
            self.packets, self.count = {}, 0
            place = {"type": self.type, "counter": self.counter, "offset": self.offset}
            yield from self.telecommand(form.load, True, **place, length=want)
            ready, _ = yield from self.poll(
                form.ready, "ready", 1, form.poll_interval, form.ready_timeout
            )
            if ready["error"]:
                raise Ended("parameter")
            size = ready["length"]
            if size > want or (self.size is not None and size != want):
                raise Ended("length")
            self.count = self.facts.packets_of(size)
            while len(self.packets) < self.count:
                if rounds == form.rounds:
                    raise Ended("rounds")
                rounds += 1
                yield from self._round()
            block_packets = b"".join(
                self.packets[position] for position in range(self.count)
            )
            covered = (
                block_packets if form.checksum_covers_fill else block_packets[:size]
            )
            if (
                crc.compute(need(self.facts.crc16, "crc16"), covered)
                == ready["checksum"]
            ):
                return block_packets[:size]
            # After a checksum error the block is loaded again; rounds count over all
            # attempts.
            if rounds == form.rounds:
                raise Ended("checksum")
            if not size:
                rounds += 1

    def _round(self) -> Steps:
        if self.packets:
            yield from self._send_hole_map()
        missing = [
            position for position in range(self.count) if position not in self.packets
        ]
        everything = not self.packets
        self.last = self.now
        # Sent once: received packets are a better evidence than its acknowledge.
        yield from self.once(
            self.form.burst,
            length=self.form.message_length,
            ignore_hole_map=int(everything),
        )
        if self.bus != UART:
            counter = self.files.counter_bytes
            id = need(
                self.files.packet_ids.get(self.bus),
                f"file_transfer.download.{self.bus}",
            )
            # On request-response buses each packet is requested; on the UART the node
            # sends them unsolicited.
            for _ in missing:
                outcome = yield from self.ask(Request(TELEMETRY, id, repeat=True))
                if outcome["event"] == "done":
                    data = bytes.fromhex(outcome["bytes"])
                    self.packet(self.facts.number(data[:counter]), data[counter:])
            return
        self.last = max(self.last, self.now)
        while (
            len(self.packets) < self.count and self.now < self.last + self.form.silence
        ):
            yield Wait(self.last + self.form.silence)

    def _send_hole_map(self) -> Steps:
        first = self.files.first_packet
        map_ = files.hole_map(
            self.facts, self.count, [first + position for position in self.packets]
        )
        for step, piece in zip(
            self.hole_maps(self.count),
            files.in_messages(self.facts, map_),
            strict=False,
        ):
            yield from self.telecommand(step, map=piece)


class Upload(Transfer):
    """Upload of a file block by block.

    ``sent``: number of committed bytes. Raises `icdgen.protocol.facts.Unsupported`,
    `RangeError` and `TooLongError`.
    """

    def __init__(
        self, facts: Facts, destination: int, data: bytes, block: int | None = None
    ) -> None:
        super().__init__(facts, block)
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
        yield from self.telecommand(
            form.initiate, destination=self.destination, block_size=form.block_size
        )
        yield from self.poll(
            form.initiated, "busy", 0, form.poll_interval, form.erase_timeout
        )
        while self.sent < len(self.data):
            data = self.data[self.sent : self.sent + self.block]
            yield from self._block(data)
            self.sent += len(data)

    def _block(self, data: bytes) -> Steps:
        form, size, rounds = self.form, self.files.packet_bytes, 0
        count = self.facts.packets_of(len(data))
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
                    yield from self.telecommand(
                        form.packet, False, number=number, bytes=packet
                    )
                missing = yield from self._missing(count)
            checksum, _ = yield from self.telemetry(form.checksum)
            if checksum["checksum"] == crc.compute(
                need(self.facts.crc16, "crc16"), covered
            ):
                committed_block = {
                    "destination": self.destination,
                    "offset": self.sent,
                    "length": len(data),
                }
                yield from self.telecommand(form.finalize, True, **committed_block)
                poll = self.poll(
                    form.finalized, "busy", 0, form.poll_interval, form.finalize_timeout
                )
                finalized, _ = yield from poll
                if not finalized["error"]:
                    return
            if rounds == form.rounds:
                raise Ended("checksum")

    def _missing(self, count: int) -> Asking[list[int]]:
        """Return the positions of the packets that the node has not received."""
        map_ = b""
        for step in self.hole_maps(count):
            values, _ = yield from self.telemetry(step)
            map_ += values["map"]
        size = need(self.facts.hole_map, "file_transfer.hole_map").bytes
        lost = files.missing(self.facts, count, map_.ljust(size, b"\0"))
        return [number - self.files.first_packet for number in lost]


class Erase(Transfer):
    """Deletion of one file or of all files.

    Deletion of all is done when the node is no longer busy.
    """

    def __init__(self, facts: Facts, type: int, counter: int, all: bool) -> None:
        super().__init__(facts)
        self.form = need(self.files.erase, "file_transfer.erase")
        self.values = {"type": type, "counter": counter, "all": int(all)}

    def _run(self) -> Steps:
        yield from self.telecommand(self.form.request, True, **self.values)
        if self.values["all"]:
            yield from self.poll(
                self.form.progress,
                "busy",
                0,
                self.form.poll_interval,
                self.form.timeout,
            )


class Format(Transfer):
    """Formatting of the medium."""

    def __init__(self, facts: Facts) -> None:
        super().__init__(facts)
        self.form = need(self.files.format, "file_transfer.format")

    def _run(self) -> Steps:
        form = self.form
        yield from self.telecommand(form.request)
        yield from self.poll(form.progress, "busy", 0, form.poll_interval, form.timeout)
