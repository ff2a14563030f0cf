"""File transfer: list, download, upload, erase, format."""

from __future__ import annotations

from collections.abc import Generator
from typing import NamedTuple, Optional

from .._errors import RangeError
from .client import Request
from .crc import crc16
from .errors import TooLongError, need
from .events import Done, Outcome, Refused
from .file_procedures import Action, Ended, RoleProcedure, Steps, Values, Wait, one_of
from .files import HoleMap
from .link import Bus, Link
from .times import DosTime, dos_time_unpack


class FileEntry(NamedTuple):
    """A file of the node. ``time`` is packed."""

    type: int = 0
    counter: int = 0
    size: int = 0
    time: int = 0
    checksum: int = 0

    def modified(self, link: Link) -> DosTime:
        """Return the time of its modification. Raise `UnsupportedError`."""
        return dos_time_unpack(link, self.time)


class FileProcedure(RoleProcedure):
    """Base class of the file transfer procedures. Raise `UnsupportedError`."""

    def __init__(self, link: Link) -> None:
        super().__init__(link)
        self._files = need(link.files, "file_transfer")


class FileList(FileProcedure):
    """List the files of the node in ``entries``."""

    def __init__(self, link: Link) -> None:
        super().__init__(link)
        self._form = need(self._files.list, "file_transfer.list")
        self.entries: list[FileEntry] = []

    def _run(self) -> Steps:
        form, last, repeated = self._form, b"", 0
        yield from self._execute(form.reset)
        while True:
            values, frame = yield from self._poll(
                form.information, "busy", False, form.poll_interval, form.timeout
            )
            if not any(frame):
                return
            if frame != last:
                if len(self.entries) == form.max_entries:
                    raise Ended("limit")
                numbers = {
                    role: values[role] for role in FileEntry._fields if role in values
                }
                self.entries.append(
                    FileEntry(**{r: int(v) for r, v in numbers.items()})
                )
                repeated = 0
            elif repeated > self.link.settings.retries:
                raise Ended("timeout")
            last, repeated = frame, repeated + 1
            # Send it once. If only the acknowledge is lost, the next frame shows it.
            advance = self._telecommand(form.advance, repeat=False)
            outcome = yield from self._outcome_of(advance)
            if isinstance(outcome, Refused):
                raise Ended("refused")


class Download(FileProcedure):
    """Download a file, block by block.

    ``size`` None: up to the end of the file, as required for the index file. ``block``:
    bytes of a block, limited by the ICD. Raise `RangeError` for a size above the limit
    of the ICD, and `UnsupportedError`.
    """

    def __init__(
        self,
        link: Link,
        bus: Bus,
        type: int,
        counter: int,
        size: Optional[int] = None,
        block: Optional[int] = None,
    ) -> None:
        super().__init__(link)
        form = self._form = need(self._files.download, "file_transfer.download")
        if size is not None and not 0 <= size <= form.max_bytes:
            raise RangeError("size", f"0 to {form.max_bytes}", size)
        self.size = size
        self.blocks: list[tuple[int, bytes]] = []
        """Offset and data of each received block."""
        self._bus = bus
        self._file = {"type": type, "counter": counter}
        self._block_bytes = min(
            block or self._files.block_bytes, self._files.block_bytes
        )
        self._offset = 0
        self._packets: dict[int, bytes] = {}
        self._count = 0  # packets of the block
        self._last: float = 0  # time of the last new packet

    @property
    def data(self) -> bytes:
        """The data received so far."""
        return b"".join(data for _, data in self.blocks)

    @property
    def progress(self) -> tuple[int, Optional[int]]:
        return self._offset, self.size

    def _packet(self, number: int, data: bytes) -> None:
        position = number - self._files.first_packet
        if (
            not 0 <= position < self._count
            or position in self._packets
            or len(data) != self._files.packet_bytes
        ):
            return
        self._packets[position] = data
        self._last = self._now
        if len(self._packets) == self._count and isinstance(self._action, Wait):
            self._action = Wait(self._now)

    def _run(self) -> Steps:
        while self.size is None or self._offset < self.size:
            length = self._block_bytes
            if self.size is not None:
                length = min(length, self.size - self._offset)
            data = yield from self._block(length)
            if data:
                self.blocks.append((self._offset, data))
                self._offset += len(data)
            if self.size is None and len(data) < length:
                return

    def _block(self, length: int) -> Generator[Action, Optional[Outcome], bytes]:
        """Download a block. At the end of a file of unknown size, it may be shorter."""
        form, rounds = self._form, 0
        while True:
            ready = yield from self._load(length)
            size: int = ready["length"]
            if size > length or (self.size is not None and size != length):
                raise Ended("length")
            if self._offset + size > form.max_bytes:
                raise Ended("limit")
            self._count = self._files.packets_of(size)
            while len(self._packets) < self._count:
                if rounds == form.rounds:
                    raise Ended("rounds")
                rounds += 1
                yield from self._round()
            packets = b"".join(
                self._packets[position] for position in range(self._count)
            )
            covered = packets if form.checksum_covers_fill else packets[:size]
            if crc16(self.link, covered) == ready["checksum"]:
                return packets[:size]
            if rounds == form.rounds:
                raise Ended("checksum")
            if not size:  # an empty block has no packets and did not count a round
                rounds += 1

    def _load(self, length: int) -> Generator[Action, Optional[Outcome], Values]:
        """Request to load a block. Return the values of the ready frame."""
        self._packets, self._count = {}, 0
        place = {**self._file, "offset": self._offset, "length": length}
        form = self._form
        yield from self._execute(form.load, place)
        ready, _ = yield from self._poll(
            form.ready, "ready", True, form.poll_interval, form.ready_timeout
        )
        if ready["error"]:
            raise Ended("parameter")
        return ready

    def _round(self) -> Steps:
        """Request and receive one burst of the missing packets."""
        if self._packets:
            yield from self._send_hole_map()
        missing = self._count - len(self._packets)
        self._last = self._now
        values = {
            "length": self._form.message_length,
            "ignore_hole_map": not self._packets,
        }
        # Send it once. The packets show that it was received.
        burst = self._telecommand(self._form.burst, values, repeat=False)
        outcome = yield from self._outcome_of(burst)
        if isinstance(outcome, Refused):
            raise Ended("refused")
        if self._bus != "uart":
            yield from self._fetch(missing)
            return
        silence = self._form.silence
        self._last = max(self._last, self._now)
        while len(self._packets) < self._count and self._now < self._last + silence:
            yield Wait(self._last + silence)

    def _fetch(self, packets: int) -> Steps:
        """Request this number of packets, one at a time."""
        id = need(
            self._files.packet_ids.get(self._bus), f"file_transfer.download.{self._bus}"
        )
        for _ in range(packets):
            outcome = yield from self._outcome_of(Request("telemetry", id, repeat=True))
            if isinstance(outcome, Done):
                counter, data = self._files.counter_bytes, outcome.data
                number = int.from_bytes(data[:counter], self.link.order)
                self._packet(number, data[counter:])

    def _send_hole_map(self) -> Steps:
        form = need(self.link.hole_map, "file_transfer.hole_map")
        first = self._files.first_packet
        for piece, id in enumerate(form.telecommands[: _maps(self.link, self._count)]):
            # Packets of the last burst may still arrive between two messages.
            received = [first + position for position in self._packets]
            pieces = HoleMap(self.link, self._count, received).messages()
            message = self.link.TELECOMMANDS[id]()
            setattr(message, form.attribute, pieces[piece])
            data = message.to_bytes()
            yield from self._require(Request("telecommand", id, data, repeat=True))


class Upload(FileProcedure):
    """Upload a file, block by block. ``sent`` is the number of committed bytes.

    Raise `RangeError` for a destination that is not supported, `TooLongError` if it is
    too small, and `UnsupportedError`.
    """

    def __init__(
        self, link: Link, destination: int, data: bytes, block: Optional[int] = None
    ) -> None:
        super().__init__(link)
        form = self._form = need(self._files.upload, "file_transfer.upload")
        supported = form.destinations
        if supported and destination not in supported:
            raise RangeError("destination", one_of(supported), destination)
        most = form.destination_bytes
        if most is not None and len(data) > most:
            raise TooLongError(most, len(data))
        self.sent = 0
        self._destination, self._data = destination, data
        self._block_bytes = min(
            block or self._files.block_bytes, self._files.block_bytes
        )

    @property
    def progress(self) -> tuple[int, Optional[int]]:
        return self.sent, len(self._data)

    def _run(self) -> Steps:
        values = {
            "destination": self._destination,
            "block_size": self._form.block_size,
        }
        form = self._form
        yield from self._execute(form.initiate, values)
        yield from self._poll(
            form.initiated, "busy", False, form.poll_interval, form.erase_timeout
        )
        while self.sent < len(self._data):
            data = self._data[self.sent : self.sent + self._block_bytes]
            yield from self._block(data)
            self.sent += len(data)

    def _block(self, data: bytes) -> Steps:
        files, form, rounds = self._files, self._form, 0
        count = files.packets_of(len(data))
        filled = data.ljust(count * files.packet_bytes, bytes((files.fill,)))
        covered = filled if form.checksum_covers_fill else data
        while True:
            yield from self._execute(form.begin)
            missing = [files.first_packet + position for position in range(count)]
            while missing:
                if rounds == form.rounds:
                    raise Ended("rounds")
                rounds += 1
                for number in missing:
                    at = (number - files.first_packet) * files.packet_bytes
                    piece = filled[at : at + files.packet_bytes]
                    values = {"number": number, "bytes": piece}
                    yield from self._execute(form.packet, values, repeat=False)
                missing = yield from self._missing(count)
            reported, _ = yield from self._frame(form.checksum)
            if reported["checksum"] == crc16(self.link, covered):
                is_committed = yield from self._commit(len(data))
                if is_committed:
                    return
            if rounds == form.rounds:
                raise Ended("checksum")

    def _missing(self, count: int) -> Generator[Action, Optional[Outcome], list[int]]:
        """Return the numbers of the packets that the node has not received."""
        form = need(self.link.hole_map, "file_transfer.hole_map")
        data = b""
        for id in form.telemetry[: _maps(self.link, count)]:
            done = yield from self._require(Request("telemetry", id, repeat=True))
            frame = self.link.TELEMETRY[id].from_bytes(done.data)
            data += getattr(frame, form.attribute)
        padded = data.ljust(form.bytes, b"\0")
        return HoleMap.from_bytes(self.link, count, padded).missing()

    def _commit(self, length: int) -> Generator[Action, Optional[Outcome], bool]:
        """Commit the block. Return whether the node succeeded."""
        values = {
            "destination": self._destination,
            "offset": self.sent,
            "length": length,
        }
        form = self._form
        yield from self._execute(form.finalize, values)
        status, _ = yield from self._poll(
            form.finalized, "busy", False, form.poll_interval, form.finalize_timeout
        )
        return not status["error"]


class Erase(FileProcedure):
    """Delete a file, or all files.

    Deletion of all files ends when the node is not busy.
    """

    def __init__(
        self, link: Link, type: int = 0, counter: int = 0, all: bool = False
    ) -> None:
        super().__init__(link)
        self._form = need(self._files.erase, "file_transfer.erase")
        self._values = {"type": type, "counter": counter, "all": all}

    def _run(self) -> Steps:
        form = self._form
        yield from self._execute(form.request, self._values)
        if self._values["all"]:
            yield from self._poll(
                form.progress, "busy", False, form.poll_interval, form.timeout
            )


class Format(FileProcedure):
    """Format the medium of the node."""

    def __init__(self, link: Link) -> None:
        super().__init__(link)
        self._form = need(self._files.format, "file_transfer.format")

    def _run(self) -> Steps:
        form = self._form
        yield from self._execute(form.request)
        yield from self._poll(
            form.progress, "busy", False, form.poll_interval, form.timeout
        )


def _maps(link: Link, packets: int) -> int:
    """Return the number of messages for the hole map of a block."""
    bits = 8 * need(link.hole_map, "file_transfer.hole_map").message_bytes
    return -(-packets // bits)
