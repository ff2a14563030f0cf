"""File transfer in the device: list, download, upload, erase, format.

The ICD assigns messages to the steps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from icdgen_runtime.wire.files import HoleMap
from icdgen_runtime.wire.link import Link

from icdgen.icd.model import Message
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Files
from icdgen.sim.storage import Storage, checksum_of

Raw = dict[str, "int | bytes"]


class Refused(Exception):
    """A parameter is invalid: the field of this name, or the first field."""

    def __init__(self, field: str | None = None) -> None:
        super().__init__(field)
        self.field = field


class Packet(NamedTuple):
    """A packet of the download buffer."""

    number: int
    data: bytes


class Transfers:
    """State of all transfers of a program.

    ``busy_ms`` is the duration of slow steps.
    """

    def __init__(
        self, facts: Facts, link: Link, form: Files, storage: Storage, busy_ms: int
    ) -> None:
        self.facts, self.link, self.form, self.storage, self.busy_ms = (
            facts,
            link,
            form,
            storage,
            busy_ms,
        )
        self.pointer = 0
        self.block = b""
        self.loaded = self.bad = False
        self.map = bytearray(facts.hole_map.bytes if facts.hole_map else 0)
        self.received: dict[int, bytes] = {}
        self.failed = False
        self.busy: dict[str, int] = {}  # step -> time of its end
        self.fetched = Packet(
            0, bytes([form.fill]) * form.packet_bytes
        )  # last requested packet
        self.burst: list[int] = []  # positions of packets that the client will request
        self.pushed: list[Packet] = []  # unsolicited packets to send
        self.maps: dict[str, tuple[str, slice]] = (
            {}
        )  # message -> field, and range of the map
        if holes := facts.hole_map:
            for index, message in enumerate(holes.messages):
                self.maps[message.name] = holes.field, slice(
                    index * holes.message_bytes, (index + 1) * holes.message_bytes
                )
        self.steps = form.steps
        handlers: dict[str, Callable[[int, Raw], None]] = {
            "list.reset": self._reset_list,
            "list.advance": self._advance,
            "download.load": self._load,
            "download.burst": self._burst,
            "upload.initiate": self._initiate,
            "upload.begin": self._begin,
            "upload.packet": self._packet,
            "upload.finalize": self._finalize,
            "erase.request": self._erase,
            "format.request": self._format,
        }
        providers: dict[str, Callable[[int], Raw]] = {
            "list.information": self._information,
            "download.ready": self._ready,
            "upload.initiated": lambda now: {
                "busy": self._is_busy("upload.initiate", now)
            },
            "upload.checksum": self._checksum,
            "upload.finalized": lambda now: {
                "busy": self._is_busy("upload.finalize", now),
                "error": int(self.failed),
            },
            "erase.progress": lambda now: {"busy": self._is_busy("erase.request", now)},
            "format.progress": lambda now: {
                "busy": self._is_busy("format.request", now)
            },
        }
        self.telecommands = {
            step.message.name: (step, handlers[name])
            for name, step in self.steps.items()
            if name in handlers
        }
        self.frames = [
            (step, providers[name])
            for name, step in self.steps.items()
            if name in providers
        ]

    def telecommand(self, now: int, message: Message, raw: Raw) -> None:
        """Process a telecommand of the transfers; ignore others. Raise `Refused`."""
        if message.name in self.maps:
            field, part = self.maps[message.name]
            self.map[part] = raw[field]  # type: ignore[assignment]
        if message.name in self.telecommands:
            step, take = self.telecommands[message.name]
            take(now, {role: raw[name] for role, name in step.fields.items()})

    def answer(self, now: int, message: Message) -> Raw:
        """Return values of the fields that report the state of a transfer."""
        result: Raw = {}
        if message.name in self.maps:
            field, part = self.maps[message.name]
            result[field] = bytes(self.map[part])
        for step, give in self.frames:
            if step.message.name == message.name:
                values = give(now)
                result |= {
                    name: values[role]
                    for role, name in step.fields.items()
                    if role in values
                }
        return result

    def fetch(self) -> Packet:
        """Return the next packet of the burst.

        After the last packet, it is repeated. Before a burst, the packet contains fill
        bytes.
        """
        if self.burst:
            self.fetched = self._packet_at(self.burst.pop(0))
        return self.fetched

    def _is_busy(self, step: str, now: int) -> int:
        return int(now < self.busy.get(step, now))

    def _start(self, step: str, now: int) -> None:
        self.busy[step] = now + self.busy_ms

    def _reset_list(self, now: int, _: Raw) -> None:
        self.pointer = 0
        self._start("list.reset", now)

    def _advance(self, now: int, _: Raw) -> None:
        self.pointer = min(self.pointer + 1, len(self.storage.files))
        self._start("list.reset", now)

    def _information(self, now: int) -> Raw:
        files, busy = list(self.storage.files.items()), self._is_busy("list.reset", now)
        if busy or self.pointer >= len(files):
            return {
                "busy": busy,
                "type": 0,
                "counter": 0,
                "size": 0,
                "time": 0,
                "checksum": 0,
            }
        (type_, counter), file = files[self.pointer]
        about = {
            "size": len(file.data),
            "time": file.time,
            "checksum": checksum_of(self.link, file.data),
        }
        return {"busy": 0, "type": type_, "counter": counter, **about}

    def _load(self, now: int, values: Raw) -> None:
        self.block, self.loaded, self.bad, self.burst = b"", True, False, []
        self._start("download.load", now)
        content = self.storage.read(self.link, values["type"], values["counter"])  # type: ignore[arg-type]
        offset, length = int(values["offset"]), int(values["length"])
        if content is None or offset > len(content) or length > self.form.block_bytes:
            self.bad = True
        else:
            self.block = content[offset : offset + length]

    def _ready(self, now: int) -> Raw:
        if not self.loaded or self._is_busy("download.load", now):
            return {"ready": 0, "error": 0, "checksum": 0, "length": 0}
        covered = self.block
        if self.form.download and self.form.download.checksum_covers_fill:
            covered = b"".join(
                self._packet_at(at).data
                for at in range(self.facts.packets_of(len(covered)))
            )
        checksum = checksum_of(self.link, covered)
        return {
            "ready": 1,
            "error": int(self.bad),
            "checksum": checksum,
            "length": len(self.block),
        }

    def _burst(self, now: int, values: Raw) -> None:
        if (
            self.form.download
            and values.get("length", 0) != self.form.download.message_length
        ):
            self.bad = True
            raise Refused()
        count = self.facts.packets_of(len(self.block))
        self.burst = list(range(count))
        if not values.get("ignore_hole_map") and self.facts.hole_map:
            missing = HoleMap.from_bytes(self.link, count, bytes(self.map)).missing()
            self.burst = [number - self.form.first_packet for number in missing]
        self.pushed = [self._packet_at(at) for at in self.burst]

    def _packet_at(self, position: int) -> Packet:
        size = self.form.packet_bytes
        data = self.block[position * size : (position + 1) * size].ljust(
            size, bytes([self.form.fill])
        )
        return Packet(self.form.first_packet + position, data)

    def _initiate(self, now: int, values: Raw) -> None:
        self.storage.programs[self._destination(values)] = bytearray()
        self.received, self.failed = {}, False
        self._clear_map()
        self._start("upload.initiate", now)

    def _destination(self, values: Raw) -> int:
        destination = int(values["destination"])
        if (
            self.form.upload
            and self.form.upload.destinations
            and destination not in self.form.upload.destinations
        ):
            raise Refused()
        return destination

    def _begin(self, now: int, _: Raw) -> None:
        self.received = {}
        self._clear_map()

    def _clear_map(self) -> None:
        empty = (
            0x00 if not self.facts.hole_map or self.facts.hole_map.received else 0xFF
        )
        self.map = bytearray([empty]) * len(self.map)

    def _packet(self, now: int, values: Raw) -> None:
        number = int(values["number"])
        position, form = number - self.form.first_packet, self.facts.hole_map
        if (
            not 0 <= position < self.form.block_packets
        ):  # a damaged counter must not exhaust the memory
            return
        self.received[position] = values["bytes"]  # type: ignore[assignment]
        if form and position // 8 < len(self.map):
            weight = 1 << (7 - position % 8 if form.msb0 else position % 8)
            self.map[position // 8] ^= (
                weight if bool(self.map[position // 8] & weight) != form.received else 0
            )

    def _upload_block(self) -> bytes:
        empty = bytes([self.form.fill]) * self.form.packet_bytes
        return b"".join(
            self.received.get(at, empty)
            for at in range(max(self.received, default=-1) + 1)
        )

    def _checksum(self, now: int) -> Raw:
        return {"checksum": checksum_of(self.link, self._upload_block())}

    def _finalize(self, now: int, values: Raw) -> None:
        block, length = self._upload_block(), int(values["length"])
        destination, offset = self._destination(values), int(values["offset"])
        room = self.form.upload.destination_bytes if self.form.upload else None
        self.failed = length > len(block) or not self.storage.write(
            destination, offset, block[:length], room
        )
        self._start("upload.finalize", now)

    def _erase(self, now: int, values: Raw) -> None:
        if values.get("all"):
            self.storage.files.clear()
            self._start("erase.request", now)
        else:
            self.storage.files.pop((values["type"], values["counter"]), None)  # type: ignore[arg-type]
        self.pointer = 0

    def _format(self, now: int, _: Raw) -> None:
        self.storage.files.clear()
        self.pointer = 0
        self._start("format.request", now)
