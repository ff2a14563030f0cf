"""The device on a UART: a byte stream with times and faults."""

from __future__ import annotations

from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen.protocol.sections import UART
from icdgen.sim.computer import Computer
from icdgen.sim.device_line import DeviceLine
from icdgen.sim.faults import Faults
from icdgen.sim.program import Outcome

FLAGS: dict[str, str] = {  # event of the decoder -> role in the statistics
    "unexpected_start": "uart_incomplete",
    "protocol_error": "uart_protocol",
    "overrun": "overrun",
}


class Line(DeviceLine):
    """A UART. The pieces of the byte stream may have any size."""

    def __init__(self, computer: Computer, faults: Faults) -> None:
        super().__init__(computer, faults)
        # All programs of a device use its line and its framing.
        self.link = computer.program.link
        self.decoder = UartDecoder(
            self.link, computer.program.facts.longest_telecommand
        )

    def received(self, now: int, data: bytes) -> None:
        self.tick(now)
        for event in self.decoder.feed(data):
            if event.event == "message":
                self._message(now, event.message)
            elif event.event in FLAGS:
                self.computer.program.count(FLAGS[event.event])

    def tick(self, now: int) -> None:
        super().tick(now)
        log = self.computer.program.log_due(now)
        if log is not None:
            self._send(now, "log", log)

    def log(self, now: int) -> None:
        message = self.computer.program.log_message(now)
        if message is not None:
            self._send(now, "log", message)

    def pieces(self, now: int) -> list[bytes]:
        return [self.take(now)]

    def take(self, now: int) -> bytes:
        """Return the bytes that are due."""
        return b"".join(super().pieces(now))

    def _message(self, now: int, message: bytes) -> None:
        facts = self.computer.program.facts
        if facts.telemetry_ids.first <= message[0] <= facts.telemetry_ids.last:
            for _, received in self.faults.apply("request", message):
                self._request(now, received)
            return
        form = facts.files.upload if facts.files else None
        upload = form is not None and form.packet.message.telecommand_id == message[0]
        for _, received in self.faults.apply(
            "upload" if upload else "telecommand", message
        ):
            self._telecommand(now, received)

    def _request(self, now: int, message: bytes) -> None:
        if len(message) != 1:
            return
        frame = self.computer.frame(now, message[0])
        if frame is not None:
            form = self.computer.program.facts.checksum
            checked = form is not None and UART in form.telemetry_always
            self._send(now, "reply", i2c_write(self.link, message[0], frame, checked))

    def _telecommand(self, now: int, message: bytes) -> None:
        if not message:
            return
        program = self.computer.program
        outcome: Outcome | None
        if self.faults.hits("nack", "telecommand"):
            outcome = program.refuse(message)
        else:
            outcome = self.computer.take(now, message, UART)
        if outcome is None:
            return
        form = program.facts.acknowledge
        if outcome.acknowledge and form:
            acknowledge = bytearray(form.length)
            acknowledge[form.id_at], acknowledge[form.error_at] = (
                message[0],
                outcome.code,
            )
            self._send(
                now + self.computer.settings.processing_ms,
                "acknowledge",
                bytes(acknowledge),
            )
        if outcome.reset is None:
            self._push(now)

    def _push(self, now: int) -> None:
        """Send the packets of a burst, which are unsolicited on a UART."""
        program = self.computer.program
        transfers = program.transfers
        if (
            transfers is None
            or not transfers.pushed
            or UART not in transfers.form.packet_ids
        ):
            return
        pushed, transfers.pushed, transfers.burst = transfers.pushed, [], []
        head = bytes([transfers.form.packet_ids[UART]])
        for packet in pushed:
            number = program.facts.bytes_of(packet.number, transfers.form.counter_bytes)
            self._send(now, "packet", head + number + packet.data)

    def _send(self, now: int, on: str, message: bytes) -> None:
        self.queue(now, on, uart_encode(self.link, message))
