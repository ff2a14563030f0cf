"""Lines of UART and CAN, and what all buses have in common.

A line encodes the requests of a client and decodes what arrives; see `lines`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Optional, Union

from .._errors import UnknownIdError
from .._hints import Buffer
from .awaited import NO_EXCHANGE, Arrival, Awaited, Plan, Request, awaited_of
from .can import CanEvent, CanJoiner, CanMessage, CanPacket, can_split
from .errors import ChecksumError, UnsupportedError, need
from .events import Arrived, Event, LineError, Log, Stray
from .i2c import i2c_reply, i2c_write
from .link import Bus, CanKind, Link
from .logs import LogMessage
from .packet_formats import BusExchanges
from .uart import UartDecoder, uart_encode, uart_kind

ACKNOWLEDGE, REFUSAL, REQUEST_REFUSAL = range(3)
"""Indices of packets without a message."""
_PACKETS: dict[CanKind, int] = {
    "acknowledge": ACKNOWLEDGE,
    "refusal": REFUSAL,
    "request_refusal": REQUEST_REFUSAL,
}


class BusLine:
    """A line whose messages are an id and data.

    ``checks``: use optional checksums.
    """

    bus: Bus
    has_results = False
    header = b""

    def __init__(self, link: Link, checks: bool) -> None:
        self._link = link
        self._exchanges: BusExchanges = need(link.bus_exchanges.get(self.bus), self.bus)
        self.checks_telecommands = self._checks_frames = False
        if form := link.checksum:
            sent = form.telecommand_buses if checks else form.telecommand_always
            frames = form.telemetry_buses if checks else form.telemetry_always
            self.checks_telecommands = self.bus in sent
            self._checks_frames = self.bus in frames

    @property
    def discarded(self) -> int:
        """Number of received bytes that are not part of a message."""
        return 0

    def plan(self, request: Request, reply: Optional[int]) -> Plan:
        """Return how to send a request. Raise as `Line.plan`."""
        id, in_order = request.id, self.has_results
        command = self._link.commands.get(id)
        if request.kind == "telemetry":
            if id not in self._link.frames:
                raise UnknownIdError(self._link.node, "telemetry", id)
            request = Request("telemetry", id, b"", True)
            exchange = self._exchanges.request
            awaited = awaited_of(exchange, request, id, is_in_order=in_order)
            return Plan(request, request, (0, 0), awaited, True)
        if command is None:
            raise UnknownIdError(self._link.node, "telecommand", id)
        if reply is not None:
            raise UnsupportedError("telecommands on this bus have no reply")
        responding = self._exchanges.command if command.acknowledged else None
        awaited = awaited_of(responding or NO_EXCHANGE, request)
        lengths = command.length, command.length
        repeats = request.repeat or command.setting
        return Plan(request, request, lengths, awaited, repeats)

    def check(self, request: Request) -> None:
        """Raise the error of a request of the right length that cannot be encoded."""
        self.encode(request)

    def encode(self, request: Request) -> Any:
        """Return what the client gives to the application."""
        raise NotImplementedError

    def withdraw(self, unit: object) -> bool:
        """Return False: what was encoded was taken."""
        return False

    def expire(self, now: float) -> list[Event]:
        """Return no events: incomplete messages have no time."""
        return []

    def _message(self, request: Request) -> bytes:
        """Return the bytes of a request: id, data and checksum."""
        checked = request.kind == "telecommand" and self.checks_telecommands
        return i2c_write(self._link, request.id, request.data, checked)

    def _packet(self, packet: int, content: bytes) -> Arrival:
        """Return the arrival of a packet without a message."""
        id, data = content[0], content[1:]
        return Arrival(None, packet, content, id, data, None, Stray(data, id))

    def _telemetry(self, id: int, data: bytes) -> Union[Arrival, Event]:
        """Return the arrival of telemetry, or the fault if it is damaged."""
        if id not in self._link.frames:
            return Stray(data, id)
        frame, fault = self._frame(id, data)
        if fault:
            return fault
        type = self._link.TELEMETRY.which(id, frame)
        return Arrival(id, None, frame, id, frame, type, Stray(frame, id, type))

    def _frame(self, id: int, data: bytes) -> tuple[bytes, Optional[Event]]:
        """Return the frame in telemetry, and the fault if it is damaged.

        Its length shows whether it has a checksum.
        """
        form, length = self._link.checksum, self._link.frames[id]
        may_be_checked = form is not None and self.bus in form.telemetry_buses
        if form and may_be_checked and len(data) == length + form.bytes:
            try:
                return i2c_reply(self._link, id, data, True), None
            except ChecksumError:
                return b"", LineError("checksum", id)
        if len(data) != length:
            return b"", LineError("length", id)
        return data, LineError("unchecked", id) if self._checks_frames else None


class UartLine(BusLine):
    """The line of a UART with escape characters."""

    bus = "uart"

    def __init__(self, link: Link, checks: bool) -> None:
        super().__init__(link, checks)
        self._decoder = UartDecoder(link)

    @property
    def discarded(self) -> int:
        """Number of received bytes that are not part of a message."""
        return self._decoder.discarded

    def encode(self, request: Request) -> bytes:
        """Return the bytes of a request."""
        return uart_encode(self._link, self._message(request))

    def arrivals(
        self, now: float, received: Buffer, awaited: Callable[[], Iterator[Awaited]]
    ) -> Iterator[Union[Arrival, Event]]:
        """Yield what arrives in a piece of the stream."""
        for event in self._decoder.feed(received):
            if event.event == "message":
                yield self._arrival(event.message)
            else:
                yield LineError(event.event)

    def _arrival(self, message: bytes) -> Union[Arrival, Event]:
        link, id, data = self._link, message[0], message[1:]
        kind = uart_kind(link, message)
        if kind == "log":
            return Log(message, LogMessage.decode(link, message))
        if kind == "packet":
            telemetry = link.unsolicited[id]
            type = link.TELEMETRY.which(telemetry, data)
            return Arrived(telemetry, data, {}, type)
        if kind == "reply":
            return self._telemetry(id, data)
        if kind == "acknowledge":
            return self._packet(ACKNOWLEDGE, message)
        return Stray(data, id)


class CanLine(BusLine):
    """The line of a CAN bus. ``address``: address of the client."""

    bus = "can"

    def __init__(self, link: Link, checks: bool, address: int) -> None:
        super().__init__(link, checks)
        self._node, self._address = need(link.can, "can").node_address, address
        self._joiner = CanJoiner(link, address, 1)

    def encode(self, request: Request) -> list[CanPacket]:
        """Return the packets of a request."""
        kind: CanKind = "request" if request.kind == "telemetry" else "telecommand"
        data = self._message(request)[1:]
        message = CanMessage(kind, request.id, self._address, self._node, data)
        return can_split(self._link, message)

    def expire(self, now: float) -> list[Event]:
        """Return the events of incomplete messages whose time has passed."""
        return [_line_error(event) for event in self._joiner.expire(now)]

    def arrivals(
        self, now: float, received: CanPacket, awaited: Callable[[], Iterator[Awaited]]
    ) -> Iterator[Union[Arrival, Event]]:
        """Yield what arrives in a packet."""
        for event in self._joiner.feed(now, received):
            yield (
                self._arrival(event.message) if event.message else _line_error(event)
            )

    def _arrival(self, message: CanMessage) -> Union[Arrival, Event]:
        id, data = message.id, message.data
        if message.source != self._node:
            return Stray(data, id)
        if message.kind == "reply":
            return self._telemetry(id, data)
        if message.kind in _PACKETS:
            return self._packet(_PACKETS[message.kind], bytes((id,)) + data)
        return Stray(data, id)


def _line_error(event: CanEvent) -> LineError:
    return LineError(event.event, event.id)
