"""The device on a line with header and trailer: periodic telemetry and responses."""

from __future__ import annotations

from collections.abc import Mapping

from icdgen_runtime.wire.sender import Sender
from icdgen_runtime.wire.stream import StreamDecoder

from icdgen import codec
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.icd.variants import ids_of
from icdgen.protocol.envelope import PACKET
from icdgen.protocol.facts import need
from icdgen.sim.computer import Computer
from icdgen.sim.device_line import DeviceLine
from icdgen.sim.faults import Faults


class EnvelopeLine(DeviceLine):
    """A line whose messages have header and trailer.

    ``chosen`` are the values of the frame fields that the sender chooses.
    """

    def __init__(
        self, computer: Computer, faults: Faults, chosen: Mapping[str, int]
    ) -> None:
        super().__init__(computer, faults)
        program = computer.program
        self.form = need(program.facts.stream, "stream")
        self.keeps_packets = self.form.delimited_by == PACKET
        self.sender = Sender(program.link, "telemetry", chosen)
        self.decoder = StreamDecoder(program.link, "telecommand")
        self.ids = ids_of(program.icd, program.node)
        section = program.icd.protocol_of(program.node)["stream"]
        self.replies: dict[str, str] = section.get("replies", {})
        answers = set(self.replies.values())
        messages = [
            variant.message
            for variants in self.ids.telemetry.values()
            for variant in variants
        ]
        self.unsolicited = [
            message for message in messages if message.name not in answers
        ]
        self._every = computer.settings.every_ms
        self._next = 0

    def received(self, now: int, data: bytes) -> None:
        self.tick(now)
        for event in self.decoder.feed(data):
            if event.event == "message" and event.id is not None:
                for _, received_data in self.faults.apply("telecommand", event.data):
                    if received_data == event.data or self.form.check is None:
                        self._telecommand(now, event.id, received_data)
            else:
                self.computer.program.count(event.event)

    def tick(self, now: int) -> None:
        super().tick(now)
        if self._every and now >= self._next:
            # Keep the period after a delay, without sending the missed messages.
            self._next = now - (now - self._next) % self._every + self._every
            self.log(now)

    def log(self, now: int) -> None:
        for message in self.unsolicited:
            self._send(now, "telemetry", message)

    @property
    def next_tick(self) -> int | None:
        return self._next if self._every else None

    def _telecommand(self, now: int, id: int, data: bytes) -> None:
        program = self.computer.program
        message = codec.message_of_frame_if_any(
            program.icd,
            [variant.message for variant in self.ids.telecommand.get(id, ())],
            data,
        )
        if message is None or not self._is_valid(message, data):
            program.count("refused")
            return
        program.count("telecommands")
        if message.kind == CONFIGURATION:
            program.values.put(message, data)
        reply = program.values.messages.get(self.replies.get(message.name, ""))
        if reply is not None:
            self._send(now + self.computer.settings.processing_ms, "reply", reply)

    def _is_valid(self, message: Message, data: bytes) -> bool:
        """Return whether the telecommand has a valid length and valid values."""
        program = self.computer.program
        try:
            raw = codec.decode(program.icd.node(message.node), message, data)
        except codec.LengthError:
            return False  # a counter does not match the length
        return program.first_invalid(message, raw) is None

    def _send(self, now: int, on: str, message: Message) -> None:
        assert message.telemetry_id is not None
        self.queue(
            now,
            on,
            self.sender.encode(
                message.telemetry_id, self.computer.program.current(now, message)
            ),
        )
