"""The device on a UART: a byte stream with times and faults.

`UartLine` is for links with ids of one byte and escape characters; ``framed_line`` is
for links with a packet format.
"""

from __future__ import annotations

from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen.icd.buses import UART
from icdgen.runtime_objects.links import acknowledge_of, responses_on
from icdgen.sim.computer import Computer
from icdgen.sim.device_line import DeviceLine
from icdgen.sim.faults import Faults
from icdgen.sim.program import TelecommandOutcome
from icdgen.sim.refusals import refusal_code, refusal_names

# Event of the decoder -> role in the statistics.
FLAGS: dict[str, str] = {
    "unexpected_start": "uart_incomplete",
    "protocol_error": "uart_protocol",
    "overrun": "overrun",
}


class UartLine(DeviceLine):
    """A UART. The pieces of the byte stream may have any size."""

    def __init__(self, computer: Computer, faults: Faults) -> None:
        super().__init__(computer, faults)
        # All programs of a device use its line and its framing.
        self.link = computer.program.link
        self.decoder = UartDecoder(
            self.link, computer.program.facts.longest_telecommand
        )
        program = computer.program
        self._acknowledge = next(iter(responses_on(self.link, UART)), None)
        is_acknowledged = self._acknowledge is not None and any(
            each.acknowledge for each in program.facts.telecommands.values()
        )
        if not is_acknowledged and program.facts.polled is None:
            self.no_refusal = (
                "it needs an `ack` of the UART, and telecommands that are acknowledged"
            )
        self.no_busy_response = "only a framed link (`link: framing`) can have one"

    @property
    def reasons(self) -> tuple[str, ...]:
        response = self.computer.program.refusing_response
        return refusal_names(response) if response else ()

    def is_reason(self, text: str) -> bool:
        response = self.computer.program.refusing_response
        return response is not None and refusal_code(response, text) is not None

    def received(self, now: int, data: bytes) -> None:
        self.tick(now)
        for event in self.decoder.feed(data):
            if event.event == "message":
                self._message(now, event.message)
            elif event.event in FLAGS:
                self.computer.program.count(FLAGS[event.event])

    def tick(self, now: int) -> None:
        super().tick(now)
        log = self.computer.program.take_due_log(now)
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
        telecommand = facts.telecommands.get(message[0])
        counterpart = self.computer.program.counterpart
        is_packet = telecommand is not None and counterpart.is_packet(telecommand)
        on = "upload" if is_packet else "telecommand"
        for _, received in self.faults.apply(on, message):
            self._telecommand(now, received)

    def _request(self, now: int, message: bytes) -> None:
        # A request is the id alone.
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
        outcome: TelecommandOutcome | None
        fault = self.faults.fault("nak", "telecommand")
        if fault is not None:
            outcome = program.refuse(message, fault.reason)
        else:
            outcome = self.computer.take(now, message, UART)
        if outcome is None:
            return
        is_silent = self.faults.hits("silence", "telecommand")
        if outcome.is_answered and self._acknowledge and not is_silent:
            is_foreign = self.faults.hits("foreign", "telecommand")
            id = message[0] ^ 1 if is_foreign else message[0]
            acknowledge = acknowledge_of(self.link, id, outcome.code)
            after = now + self.computer.settings.processing_ms
            self._send(after, "acknowledge", acknowledge)
        if outcome.reset is None:
            self._push(now)

    def _push(self, now: int) -> None:
        """Send the packets that the device sends unasked."""
        program = self.computer.program
        # Such packets can come under another id than that of their telemetry.
        heads = {id: head for head, id in program.facts.unsolicited.items()}
        for packet in program.counterpart.packets(UART):
            id = packet.message.telemetry_id
            assert id is not None
            self._send(now, "packet", bytes((heads.get(id, id),)) + packet.data)

    def _send(self, now: int, on: str, message: bytes) -> None:
        self.queue(now, on, uart_encode(self.link, message))
