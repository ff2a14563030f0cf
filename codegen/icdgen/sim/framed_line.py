"""The device on a line with header and trailer: periodic telemetry, and responses to
telecommands.

`FramedLine` decodes telecommands, lets the program execute them, and sends the response
that the ICD describes for the outcome.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from icdgen_runtime.wire.device import PacketData, response_of, response_to
from icdgen_runtime.wire.packet_formats import Stream, Verdict
from icdgen_runtime.wire.sender import Sender
from icdgen_runtime.wire.stream import StreamDecoder

from icdgen import codec
from icdgen.icd.buses import UART
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.icd.variants import ids_of
from icdgen.procedures.counterpart import Refused
from icdgen.protocol.facts import need
from icdgen.protocol.packet_formats import DATAGRAM
from icdgen.sim.computer import Computer
from icdgen.sim.device_line import DeviceLine
from icdgen.sim.faults import Faults
from icdgen.sim.refusals import first_refusal_code, refusal_code, refusal_names

Cause = Literal["unknown_id", "length", "value", "checksum", "busy"]
"""Why a telecommand is refused: a key of `reasons` in `link: commands`."""

# Event of the decoder -> cause.
_CAUSES: dict[str, Cause] = {
    "unknown_id": "unknown_id",
    "length": "length",
    "checksum": "checksum",
}
_SUCCESS: tuple[Verdict, ...] = ("ack", "reply")


DEFAULT_PERIOD = 1000  # ms, of unsolicited telemetry


@dataclass
class _Period:
    """Telemetry that is sent periodically, and when it is sent next, in ms."""

    message: Message
    period: int
    next: int


class FramedLine(DeviceLine):
    """A line whose messages have header and trailer.

    ``chosen`` are the values of the frame fields that the sender chooses.
    """

    def __init__(
        self, computer: Computer, faults: Faults, chosen: Mapping[str, int]
    ) -> None:
        super().__init__(computer, faults)
        program = computer.program
        self.form: Stream = need(program.link.stream, "stream")
        self.keeps_packets = self.form.delimited_by == DATAGRAM
        packets = self.form.packets_of("telecommand")
        self._is_checked = any(packet.check for packet in packets)
        self._chosen = chosen
        self.sender = Sender(program.link, "telemetry", chosen)
        self.decoder = StreamDecoder(program.link, "telecommand")
        self.ids = ids_of(program.icd, program.node)
        section = program.icd.protocol_of(program.node)["link"]
        commands: Mapping[str, Any] = section.get("commands", {})
        self._names_of_causes: Mapping[str, str] = commands.get("reasons", {})
        responses = [
            row for exchange in self.form.exchanges for row in exchange.responses
        ]
        # Response that refuses a telecommand, by its id.
        self._refusals = {
            row.id: response
            for row in self.form.telecommands
            if (response := response_of(self.form, row.id, "nak")) is not None
        }
        if not self._refusals:
            self.no_refusal = (
                "it needs `nak` in `link: commands`, or values of a `status` that do "
                "not confirm"
            )
        is_busy_a_reason = bool(self._refusals) and "busy" in self._names_of_causes
        if not is_busy_a_reason and not any(
            response_of(self.form, row.id, "busy") for row in self.form.telecommands
        ):
            self.no_busy_response = (
                "it needs `busy` in `link: commands`, in the values of a `status`, or "
                "in the `reasons` of refusals"
            )
        responding = {response.telemetry for response in responses}
        requested = {row.id: row.is_requested for row in self.form.telemetry}
        # Periodic telemetry, and telemetry that nothing requests
        self.unsolicited: list[Message] = []
        for id, variants in self.ids.telemetry.items():
            is_unasked = id not in responding and not requested.get(id)
            for variant in variants:
                if variant.message.period_ms is not None or is_unasked:
                    self.unsolicited.append(variant.message)
        every = computer.settings.every_ms
        self._periods: list[_Period] = []
        if every != 0:
            self._periods = [
                _Period(message, every or message.period_ms or DEFAULT_PERIOD, 0)
                for message in self.unsolicited
            ]
        self._header = b""  # of the received telecommand or request

    @property
    def reasons(self) -> tuple[str, ...]:
        names = [refusal_names(response) for response in self._refusals.values()]
        return tuple(dict.fromkeys(name for each in names for name in each))

    def is_reason(self, text: str) -> bool:
        responses = self._refusals.values()
        return any(refusal_code(each, text) is not None for each in responses)

    def without(self, reason: str) -> list[str]:
        names: list[str] = []
        for id, response in self._refusals.items():
            if refusal_code(response, reason) is None:
                variants = self.ids.telecommand[id]
                names += [variant.message.name for variant in variants]
        return names

    def received(self, now: int, data: bytes) -> None:
        self.tick(now)
        for event in self.decoder.feed(data):
            self._header = event.header
            if event.event == "request" and event.id is not None:
                self._request(now, event.id)
                continue
            if event.event != "message" or event.id is None:
                self.computer.program.count(event.event)
                cause = _CAUSES.get(event.event)
                if cause is not None and event.id is not None:
                    is_request = event.is_request
                    self._refuse(now, event.id, b"", cause, is_request=is_request)
                continue
            on = "upload" if self._is_packet(event.id) else "telecommand"
            for _, received_data in self.faults.apply(on, event.data):
                # The decoder has checked the checksum, so a fault behind it must be
                # refused here.
                if received_data == event.data or not self._is_checked:
                    self._telecommand(now, event.id, received_data)
                else:
                    self._refuse(now, event.id, received_data, "checksum")

    def tick(self, now: int) -> None:
        super().tick(now)
        for row in self._periods:
            if now >= row.next:
                # Keep the period after a delay, without sending the missed messages.
                row.next = now - (now - row.next) % row.period + row.period
                self._send_telemetry(now, row.message)

    def log(self, now: int) -> None:
        for message in self.unsolicited:
            self._send_telemetry(now, message)

    def _send_telemetry(self, now: int, message: Message) -> None:
        assert message.telemetry_id is not None
        data = self.computer.program.current(now, message)
        self._send(now, "telemetry", message.telemetry_id, data)

    @property
    def next_tick(self) -> int | None:
        return min((row.next for row in self._periods), default=None)

    def _telecommand(self, now: int, id: int, data: bytes) -> None:
        program, settings = self.computer.program, self.computer.settings
        fault = self.faults.fault("nak", "telecommand")
        if fault is not None and id in self._refusals:
            self._refuse(now, id, data, "value", fault.reason)
            return
        is_busy = now < program.free_at or self.faults.hits("busy", "telecommand")
        # Without a response for it, the device takes the telecommand all the same.
        if is_busy and self._defer(now, id, data):
            return
        message = self._message(id, data)
        if not isinstance(message, Message):
            self._refuse(now, id, data, message)
            return
        program.count("telecommands")
        if message.kind == CONFIGURATION:
            program.values.put(message, data)
        try:
            program.counterpart.telecommand(now, message, data)
        except Refused:
            self._refuse(now, id, data, "value")
            return
        program.free_at = now + settings.processing_ms
        if self.faults.hits("silence", "telecommand"):
            return
        if self.faults.hits("foreign", "telecommand"):
            id, data = self._other_telecommand(id)
        for verdict in _SUCCESS:
            self._respond(now + settings.processing_ms, id, data, verdict)
        for packet in program.counterpart.packets(UART):
            assert packet.message.telemetry_id is not None
            self._send(now, "packet", packet.message.telemetry_id, packet.data)

    def _is_packet(self, id: int) -> bool:
        """Return whether a telecommand has a packet of a block."""
        counterpart = self.computer.program.counterpart
        variants = self.ids.telecommand.get(id, ())
        return any(counterpart.is_packet(variant.message) for variant in variants)

    def _request(self, now: int, id: int) -> None:
        """Respond to the request of telemetry."""
        program = self.computer.program
        if now < program.free_at and self._defer(now, id, b"", is_request=True):
            return
        program.count("requests")
        self._respond(now, id, b"", "reply", is_request=True)

    def _message(self, id: int, data: bytes) -> Message | Cause:
        """Return the telecommand, or the cause why it is refused."""
        program = self.computer.program
        messages = [variant.message for variant in self.ids.telecommand[id]]
        message = codec.message_of_frame_if_any(program.icd, messages, data)
        if message is None:
            lengths = [
                range(each.layout.shortest, each.length + 1) for each in messages
            ]
            if not any(len(data) in each for each in lengths):
                return "length"
            # Constants distinguish messages that share an id, such as the number of a
            # command: another constant is another telecommand.
            return "unknown_id" if len(messages) > 1 else "value"
        try:
            raw = codec.decode(program.icd.node(message.node), message, data)
        except codec.LengthError:
            return "length"  # a counter does not match the length
        return message if program.first_invalid(message, raw) is None else "value"

    def _other_telecommand(self, id: int) -> tuple[int, bytes]:
        """Return id and data of another telecommand.

        Prefer a telecommand that has the same responses.
        """
        rows = {row.id: row for row in self.form.telecommands}
        candidates = [
            row for row in rows.values() if row.exchange is not None and row.id != id
        ]
        if not candidates:
            return id ^ 1, b""  # nothing responds to an id that the node does not have
        own = rows[id].exchange
        # Then only the numbers that the response repeats reveal the wrong telecommand.
        # A client that does not compare these numbers accepts the response.
        other = min(candidates, key=lambda row: row.exchange != own)
        return other.id, bytes(other.least)

    def _refuse(
        self,
        now: int,
        id: int,
        data: bytes,
        cause: Cause,
        reason: str | None = None,
        is_request: bool = False,
    ) -> None:
        """Refuse a telecommand, or the request of telemetry, with the reason of the ICD
        for a cause, or with ``reason``.
        """
        name = self._names_of_causes.get(cause) if reason is None else reason
        # Damaged telecommands are ignored, unless the ICD has a reason for them.
        if cause == "checksum" and name is None:
            return
        self.computer.program.count("refused")
        if self.faults.hits("silence", "telecommand"):
            return
        response = response_of(self.form, id, "nak", is_request)
        if response is not None:
            if name is None:
                number = first_refusal_code(response)
            else:
                number = refusal_code(response, name)
            self._respond(now, id, data, "nak", number, is_request)

    def _defer(self, now: int, id: int, data: bytes, is_request: bool = False) -> bool:
        """Respond that the device is busy. Return whether there is such a response."""
        if response_of(self.form, id, "busy", is_request) is not None:
            self._respond(now, id, data, "busy", is_request=is_request)
            return True
        can_refuse = response_of(self.form, id, "nak", is_request) is not None
        if "busy" not in self._names_of_causes or not can_refuse:
            return False
        self._refuse(now, id, data, "busy", is_request=is_request)
        return True

    def _respond(
        self,
        now: int,
        id: int,
        data: bytes,
        verdict: Verdict,
        reason: int | None = None,
        is_request: bool = False,
    ) -> None:
        """Send a response, if there is one."""
        program = self.computer.program
        response = response_of(self.form, id, verdict, is_request)
        if response is None:
            return
        telemetry = b""
        if response.packet is None:
            responding = id if response.telemetry is None else response.telemetry
            message = self.ids.telemetry[responding][0].message
            telemetry = program.current(now, message)
        sent = response_to(
            program.link,
            id,
            data,
            verdict,
            reason,
            telemetry,
            is_request,
            self._header,
            self._chosen,
        )
        on = "reply" if verdict == "reply" else "acknowledge"
        if isinstance(sent, PacketData):
            self.queue(now, on, self.sender.encode_packet(*sent))
        elif sent is not None:
            self._send(now, on, *sent)

    def _send(self, now: int, on: str, id: int, data: bytes) -> None:
        self.queue(now, on, self.sender.encode(id, data))
