"""The device on a line with envelopes: what it sends by itself, and what it answers with."""

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
from icdgen.sim.due import Due
from icdgen.sim.faults import Faults


class EnvelopeLine:
    """Every call is given the time in milliseconds; `pieces` gives what is due. ``chosen``: values of the envelope's fields."""

    def __init__(self, computer: Computer, faults: Faults, chosen: Mapping[str, int]) -> None:
        self.computer, self.faults = computer, faults
        program = computer.program
        self.form = need(program.known.stream, "stream")
        self.sender = Sender(program.link, "telemetry", chosen)
        self.decoder = StreamDecoder(program.link, "telecommand")
        self.ids = ids_of(program.icd, program.node)
        section = program.icd.protocol_of(program.node)["stream"]
        self.replies: dict[str, str] = section.get("replies", {})
        answers = set(self.replies.values())
        self.unasked = [one.message for those in self.ids.telemetry.values() for one in those]
        self.unasked = [message for message in self.unasked if message.name not in answers]
        self._every = computer.settings.every_ms
        self._next = 0
        self._due = Due()

    @property
    def keeps_packets(self) -> bool:
        """Whether each piece is a packet of its own."""
        return self.form.delimited_by == PACKET

    def received(self, now: int, data: bytes) -> None:
        """The next bytes from the client, or a packet."""
        self.tick(now)
        for event in self.decoder.feed(data):
            if event.event == "message" and event.id is not None:
                for _, one in self.faults.spoil("telecommand", event.data):
                    if one == event.data or self.form.check is None:
                        self._telecommand(now, event.id, one)
            else:
                self.computer.program.count(event.event)

    def tick(self, now: int) -> None:
        """Lets time pass."""
        self.computer.tick(now)
        if self._every and now >= self._next:
            self._next = now - (now - self._next) % self._every + self._every
            self.log(now)

    def log(self, now: int) -> None:
        """Sends at once all that it sends by itself."""
        for message in self.unasked:
            self._send(now, "telemetry", message)

    def pieces(self, now: int) -> list[bytes]:
        """The messages that are due."""
        return self._due.pop(now)

    @property
    def deadline(self) -> int | None:
        """When `tick` and `pieces` want to be called at the latest."""
        return min(self._due.times + ([self._next] if self._every else []), default=None)

    def _telecommand(self, now: int, id: int, data: bytes) -> None:
        program = self.computer.program
        message = self._message(id, data)
        if message is None or not self._is_taken(message, data):
            program.count("refused")
            return
        program.count("telecommands")
        if message.kind == CONFIGURATION:
            program.values.put(message, data)
        reply = program.values.messages.get(self.replies.get(message.name, ""))
        if reply is not None:
            self._send(now + self.computer.settings.processing_ms, "reply", reply)

    def _message(self, id: int, data: bytes) -> Message | None:
        try:
            return codec.which(self.computer.icd, [one.message for one in self.ids.telecommand.get(id, ())], data)
        except codec.LengthError:
            return None

    def _is_taken(self, message: Message, data: bytes) -> bool:
        program = self.computer.program
        try:
            raw = codec.decode(program.icd.node(message.node), message, data)
        except codec.LengthError:
            return False  # it has not as many elements as it says
        return program.misfit(message, raw) is None

    def _send(self, now: int, on: str, message: Message) -> None:
        assert message.telemetry_id is not None
        line = self.sender.encode(message.telemetry_id, self.computer.program.current(now, message))
        for delay, data in self.faults.spoil(on, line):
            self._due.push(now + delay, data)
