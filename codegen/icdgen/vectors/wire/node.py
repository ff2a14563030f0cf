"""Simulated node with files for procedures; derived from the roles of the ICD.

It responds to requests and loses some.
"""

from __future__ import annotations

from random import Random
from typing import Any

from icdgen_runtime.wire.client import Request
from icdgen_runtime.wire.crc import crc16
from icdgen_runtime.wire.files import HoleMap

from icdgen import codec
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import UART, Step
from icdgen.runtime_objects.operations import AnyLink


class FileNode:
    """Simulated node with files.

    ``files``: content by type and counter. ``loss``: probability that a packet, reply
    or acknowledge is lost.
    """

    def __init__(
        self,
        link: AnyLink,
        facts: Facts,
        bus: str,
        source: Random,
        loss: float = 0.0,
    ) -> None:
        assert facts.files and facts.hole_map and facts.crc16
        self.link, self.facts, self.form = link, facts, facts.files
        self.bus, self.source, self.loss = bus, source, loss
        self.files: dict[tuple[int, int], bytes] = {}
        self.pointer = 0
        self.block = b""  # loaded for download
        # Received packets as reported by the client in its hole maps.
        self.map = bytes(facts.hole_map.bytes)
        # Packets to be read, on buses where the client reads them
        self.queue: list[int] = []
        self.uploaded: dict[int, bytes] = {}
        self.program = b""
        self.polls = 0  # remaining polls until the node reports completion
        self.steps = {
            step.message.ids[0]: (name, step) for name, step in self.form.steps.items()
        }
        self.holes = {
            id: n
            for n, m in enumerate(facts.hole_map.messages)
            for id in (m.telecommand_id, m.telemetry_id)
        }

    def lost(self) -> bool:
        return self.source.random() < self.loss

    def answer(self, request: Request) -> list[dict[str, Any]]:
        """Return the events that a client would report: packets, then the outcome."""
        if request.kind == "telecommand":
            acknowledged = self.facts.telecommands[request.id].acknowledge
            if acknowledged and self.lost():  # either the request or its acknowledge
                return [
                    *(self._telecommand(request) if self.lost() else ()),
                    {"event": "timeout"},
                ]
            if not acknowledged and self.lost():
                # An unacknowledged telecommand always succeeds for the client, even if
                # it is lost.
                return [{"event": "done", "bytes": ""}]
            return [*self._telecommand(request), {"event": "done", "bytes": ""}]
        return [{"event": "done", "bytes": self._telemetry(request.id).hex()}]

    def _raw(self, step: Step, data: bytes) -> dict[str, Any]:
        raw = codec.decode(self.facts.node, step.message, data)
        return {role: raw[name] for role, name in step.fields.items()}

    def _telecommand(self, request: Request) -> list[dict[str, Any]]:
        if request.id in self.holes:
            size = len(request.data)
            at = self.holes[request.id] * size
            self.map = self.map[:at] + request.data + self.map[at + size :]
            return []
        name, step = self.steps[request.id]
        raw = self._raw(step, request.data)
        if name == "list.reset":
            self.pointer, self.polls = 0, 1
        elif name == "list.advance":
            self.pointer, self.polls = self.pointer + 1, 1
        elif name == "download.load":
            content, self.polls = self.files[raw["type"], raw["counter"]], 1
            self.block = content[raw["offset"] : raw["offset"] + raw["length"]]
        elif name == "download.burst":
            return self._burst(bool(raw["ignore_hole_map"]))
        elif name in ("upload.initiate", "erase.request", "format.request"):
            self.polls = 2
        elif name == "upload.begin":
            self.uploaded = {}
        elif name == "upload.packet":
            self.uploaded[raw["number"] - self.form.first_packet] = raw["bytes"]
        elif name == "upload.finalize":
            data = b"".join(self.uploaded[n] for n in range(len(self.uploaded)))[
                : raw["length"]
            ]
            self.program = (
                self.program[: raw["offset"]].ljust(raw["offset"], b"\xff") + data
            )
            self.polls = 1
        return []

    def _packet(self, position: int) -> bytes:
        size = self.form.packet_bytes
        data = self.block[position * size : (position + 1) * size].ljust(size, b"\xee")
        return (
            self.facts.bytes_of(
                self.form.first_packet + position, self.form.counter_bytes
            )
            + data
        )

    def _burst(self, everything: bool) -> list[dict[str, Any]]:
        count = self.facts.packets_of(len(self.block))
        first = self.form.first_packet
        lost = (
            range(count)
            if everything
            else [
                number - first
                for number in HoleMap.from_bytes(self.link, count, self.map).missing()
            ]
        )
        if self.bus != UART:
            self.queue = list(lost)
            return []
        sent = [
            (n, self._packet(n)[self.form.counter_bytes :])
            for n in lost
            if not self.lost()
        ]
        return [
            {"event": "packet", "number": first + n, "bytes": data.hex()}
            for n, data in sent
        ]

    def _telemetry(self, id: int) -> bytes:
        if id in self.holes:
            size = self.facts.telemetry[id].length
            received = [self.form.first_packet + n for n in self.uploaded]
            map_ = HoleMap(self.link, self.form.block_packets, received).to_bytes()
            return map_[self.holes[id] * size : (self.holes[id] + 1) * size]
        if id == self.form.packet_ids.get(self.bus):
            while self.queue and self.lost():
                self.queue.pop(0)
            position = self.queue.pop(0) if self.queue else self.form.block_packets
            return self._packet(position)
        name, step = self.steps[id]
        # The node becomes ready after a number of polls, independent of time.
        busy, self.polls = int(self.polls > 0), max(0, self.polls - 1)
        return step.frame(self.facts.node, self._values_of(name, busy))

    def _sum(self, data: bytes) -> int:
        return crc16(self.link, data)

    def _values_of(self, step: str, busy: int) -> dict[str, Any]:
        """Return the values of the frame of a step, by role."""
        if step == "list.information":
            return {"busy": 1} if busy else self._listed()
        if step == "download.ready":
            return (
                {}
                if busy
                else {
                    "ready": 1,
                    "checksum": self._sum(self.block),
                    "length": len(self.block),
                }
            )
        if step == "upload.checksum":
            return {
                "checksum": self._sum(
                    b"".join(self.uploaded[n] for n in sorted(self.uploaded))
                )
            }
        return {"busy": busy}

    def _listed(self) -> dict[str, Any]:
        if self.pointer >= len(self.files):
            return {}
        (type_, counter), content = list(self.files.items())[self.pointer]
        about = {
            "size": len(content),
            "time": 0x51634000,
            "checksum": self._sum(content),
        }
        return {"type": type_, "counter": counter, **about}
