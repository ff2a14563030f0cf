"""Client that sends one request at a time and reports its outcome, on any bus."""

from __future__ import annotations

from typing import Generic, Literal, NamedTuple, Optional

from .._base import Message
from .._errors import IcdError, LengthError, UnknownIdError
from .._hints import Buffer, N
from .can import CanEvent, CanJoiner, CanMessage, CanPacket, can_split
from .errors import BusyError, ChecksumError, UnsupportedError, need
from .events import (
    Done,
    Event,
    LineError,
    Log,
    Malformed,
    Packet,
    Refused,
    Stray,
    Timeout,
)
from .i2c import I2cTransfer, i2c_read_length, i2c_reply, i2c_write
from .link import Bus, Link, Polled, Settings
from .logs import LogMessage
from .message_ids import (
    NodeMessage,
    NodeMessageClass,
    message_of,
    requested_id,
    sent_id,
)
from .uart import UartDecoder, uart_encode, uart_kind


class Request(NamedTuple):
    """A request to a node.

    ``repeat``: whether it may be sent again although the node may have received it.
    Requests of telemetry and settings may always be sent again.
    """

    kind: Literal["telecommand", "telemetry"]
    id: int
    data: bytes = b""
    repeat: bool = False


class Client(Generic[N]):
    """A client on one bus.

    Pass received data to `received`, `packet` or `transferred`, and call `tick` at
    `deadline` at the latest. Take the data to send from `output`, `packets` or
    `transfers`. Times are in milliseconds of any monotonic clock.

    ``crc``: use optional checksums. ``address``: address of the client on CAN. Raise
    `UnsupportedError` for a bus that the ICD does not describe.
    """

    def __init__(
        self,
        link: Link[N],
        bus: Bus,
        crc: bool = False,
        address: int = 0,
        settings: Optional[Settings] = None,
    ) -> None:
        self.link, self.bus = link, bus
        self.settings = settings or link.settings
        self._checks_sent = self._checks_frames = False
        if form := link.checksum:
            commands = form.telecommand_buses if crc else form.telecommand_always
            frames = form.telemetry_buses if crc else form.telemetry_always
            self._checks_sent, self._checks_frames = bus in commands, bus in frames
        self._address = address
        self._decoder: Optional[UartDecoder] = None
        self._joiner: Optional[CanJoiner] = None
        if bus == "uart":
            need(link.framing, "uart")
            self._decoder = UartDecoder(link)
        elif bus == "can":
            self._joiner = CanJoiner(link, address, 1)
        elif bus == "i2c":
            need(link.i2c_address, "i2c")
        else:
            raise UnsupportedError(f"a bus is 'uart', 'can' or 'i2c', not {bus!r}")
        self._stream: list[bytes] = []
        self._packets: list[CanPacket] = []
        self._transfers: list[I2cTransfer] = []
        # I2C: number of transfers taken, but not yet passed to `transferred`
        self._unreported = 0
        # hold: wait until no reply to an earlier request can arrive. wait: for the
        # reply. I2C only: pause until the next poll or attempt. poll: wait for the
        # result.
        self._state: Literal["idle", "hold", "wait", "pause", "poll"] = "idle"
        self._request = Request("telemetry", 0)
        self._attempts = 0
        self._until: float = 0
        self._is_written = False  # I2C: telecommand is sent, acknowledge is polled
        self._poll_end: float = 0  # when polling ends
        # Id of an ended request whose reply may still arrive, and until when. A new
        # request of this id waits, so that it does not take the old reply for its own.
        self._late: Optional[tuple[int, float]] = None

    @property
    def busy(self) -> bool:
        """Whether a request is in progress."""
        return self._state != "idle"

    @property
    def deadline(self) -> Optional[float]:
        """Time in ms at which `tick` must be called at the latest; None if idle."""
        return self._until if self.busy else None

    def request(self, now: float, message: NodeMessageClass[N, Message]) -> list[Event]:
        """Request telemetry or read a configuration. See `start`."""
        return self.start(now, Request("telemetry", requested_id(self.link, message)))

    def send(
        self, now: float, message: NodeMessage[N], repeat: bool = False
    ) -> list[Event]:
        """Send a telecommand or set a configuration.

        See `start`; also raise `RangeError`.
        """
        id, data = sent_id(self.link, message), message_of(message).to_bytes()
        return self.start(now, Request("telecommand", id, data, repeat))

    def start(self, now: float, request: Request) -> list[Event]:
        """Start a request.

        Raise `UnknownIdError`, `LengthError`, and `BusyError` while another request is
        in progress or its output has not been taken.
        """
        id = request.id
        command = self.link.commands.get(id)
        if request.kind == "telecommand":
            if command is None:
                raise UnknownIdError(self.link.node, "telecommand", id)
        elif id not in self.link.frames:
            raise UnknownIdError(self.link.node, "telemetry", id)
        if self.busy or self._stream or self._packets or self._transfers:
            raise BusyError("a request is going on")
        if request.kind == "telemetry":
            request = Request("telemetry", id, b"", True)
        elif command:
            if len(request.data) != command.length:
                name = f"telecommand {id}"
                raise LengthError(name, command.length, len(request.data))
            request = request._replace(repeat=request.repeat or command.setting)
        self._request, self._attempts = request, 0
        if self._late and self._late[0] == id and now < self._late[1]:
            self._state, self._until = "hold", self._late[1]
            return []
        return self._transmit(now)

    def output(self) -> bytes:
        """UART: return the bytes to send, each once."""
        taken, self._stream = self._stream, []
        return b"".join(taken)

    def packets(self) -> list[CanPacket]:
        """CAN: return the packets to send, each once."""
        taken, self._packets = self._packets, []
        return taken

    def transfers(self) -> list[I2cTransfer]:
        """I2C: return the transactions to perform, each once.

        Call `transferred` once for each transaction, in this order.
        """
        taken, self._transfers = self._transfers, []
        self._unreported += len(taken)
        return taken

    def cancel(self) -> None:
        """Cancel the request without an event, and drop its remaining output.

        The next request may begin at once. A late reply to the cancelled one is
        `Stray`.
        """
        self._stream, self._packets, self._transfers = [], [], []
        if self.busy and self._attempts:
            self._late = self._request.id, self._until + self.settings.reply_timeout
        self._state = "idle"

    def tick(self, now: float) -> list[Event]:
        """Process timeouts. Call at `deadline` (in ms) at the latest."""
        events: list[Event] = []
        if self._joiner:
            events += map(_line_error, self._joiner.expire(now))
        if self.busy and now >= self._until:
            events += self._expired(now)
        return events

    def received(self, now: float, data: Buffer) -> list[Event]:
        """UART: process received bytes, in pieces of any size."""
        events = self.tick(now)
        for result in need(self._decoder, "uart").feed(data):
            if result.event == "message":
                events += self._uart_message(now, result.message)
            else:
                events.append(LineError(result.event))
        return events

    def packet(self, now: float, packet: CanPacket) -> list[Event]:
        """CAN: process a received packet."""
        events = self.tick(now)
        for result in need(self._joiner, "can").feed(now, packet):
            if result.message:
                events += self._can_message(now, result.message)
            else:
                events.append(_line_error(result))
        return events

    def transferred(self, now: float, data: Optional[Buffer]) -> list[Event]:
        """I2C: process the bytes that were read; None if the transaction failed.

        The result of a request that has already ended is reported as `Stray`.
        """
        is_awaited = self._unreported == 1 and self._awaits_transfer
        self._unreported = max(0, self._unreported - 1)
        events = self.tick(now)  # may end the request of this transaction
        read = None if data is None else bytes(data)
        if not (is_awaited and self._awaits_transfer):
            return [*events, Stray(read or b"")]
        if self._state == "poll":
            return events + self._polled(now, read)
        if read is None:
            return events + self._no_reply(now)
        if self._request.kind == "telemetry":
            id = self._request.id
            try:
                frame = i2c_reply(self.link, id, read, self._checks_frames)
            except IcdError:
                return [*events, Malformed(id), *self._no_reply(now)]
            return events + self._done(now, frame)
        if not self.link.commands[self._request.id].acknowledged:
            return events + self._done(now)
        self._is_written = True
        self._poll_end = now + self.settings.poll_timeout
        return events + self._pause(now)

    @property
    def _awaits_transfer(self) -> bool:
        """I2C: whether the last transfer is taken and belongs to the request."""
        return self._state in ("wait", "poll") and not self._transfers

    def _transmit(self, now: float) -> list[Event]:
        """Send the request, for the first time or again."""
        request = self._request
        is_telecommand = request.kind == "telecommand"
        self._attempts += 1
        self._is_written = False
        self._state, self._until = "wait", now + self.settings.reply_timeout
        checked = is_telecommand and self._checks_sent
        message = i2c_write(self.link, request.id, request.data, checked)
        if self.bus == "uart":
            self._stream.append(uart_encode(self.link, message))
        elif self.bus == "can":
            node = need(self.link.can, "can").node_address
            head = CanMessage(
                "telecommand" if is_telecommand else "request",
                request.id,
                self._address,
                node,
                message[1:],
            )
            self._packets += can_split(self.link, head)
        else:
            checks = self._checks_frames
            length = 0
            if not is_telecommand:
                length = i2c_read_length(self.link, request.id, checks)
            self._transfers.append(I2cTransfer(message, length))
            return []
        if is_telecommand and not self.link.commands[request.id].acknowledged:
            return self._done(now)
        return []

    def _expired(self, now: float) -> list[Event]:
        """Process the end of the time of a state."""
        if self._state == "wait":
            return self._no_reply(now)
        if self._state == "poll":
            return self._pause(now)
        if self._state == "pause":
            if now >= self._poll_end:
                return self._timeout(now)
            if self._is_written:
                self._poll(now)
                return []
        return self._transmit(now)

    def _no_reply(self, now: float) -> list[Event]:
        """Process a missing or unusable reply: send again or end the request."""
        if not self._request.repeat or self._attempts > self.settings.retries:
            return self._timeout(now)
        if self.bus == "i2c":  # a failure is immediate here: give the node some time
            self._state, self._until = "pause", now + self.settings.poll_interval
            self._poll_end = now + self.settings.poll_timeout
            return []
        return self._transmit(now)

    def _pause(self, now: float) -> list[Event]:
        """Poll again after the poll interval, until the poll timeout."""
        if now >= self._poll_end:
            return self._timeout(now)
        self._state, self._until = "pause", now + self.settings.poll_interval
        return []

    def _poll(self, now: float) -> None:
        id = need(self.link.polled, "i2c.acknowledge").telemetry
        self._state, self._until = "poll", now + self.settings.reply_timeout
        length = i2c_read_length(self.link, id, self._checks_frames)
        self._transfers.append(I2cTransfer(bytes((id,)), length))

    def _polled(self, now: float, data: Optional[bytes]) -> list[Event]:
        """Process the acknowledge frame, or its absence."""
        if data is None:
            return self._pause(now)
        form: Polled = need(self.link.polled, "i2c.acknowledge")
        try:
            frame = i2c_reply(self.link, form.telemetry, data, self._checks_frames)
        except IcdError:
            return [Malformed(form.telemetry), *self._pause(now)]
        acknowledge = self.link.TELEMETRY[form.telemetry].from_bytes(frame)
        if getattr(acknowledge, form.id) != self._request.id or not getattr(
            acknowledge, form.processed
        ):
            return self._pause(now)
        code = int(getattr(acknowledge, form.error))
        if code == self.link.errors.get("none", 0):
            return self._done(now)
        return self._refused(now, code, int(getattr(acknowledge, form.parameter)))

    def _uart_message(self, now: float, message: bytes) -> list[Event]:
        link, request = self.link, self._request
        kind, id = uart_kind(link, message), message[0]
        if kind == "log":
            return [Log(message, LogMessage.decode(link, message))]
        if kind == "packet" and link.files:
            start = 1 + link.files.counter_bytes
            number = int.from_bytes(message[1:start], link.order)
            return [Packet(number, message[start:])]
        if self._state == "wait" and request.kind == "telemetry":
            if kind == "reply" and id == request.id:
                return self._replied(now, message[1:])
        elif self._state == "wait" and kind == "acknowledge" and link.acknowledge:
            form = link.acknowledge
            if message[form.id_at] == request.id:
                code = message[form.error_at]
                if code == link.errors.get("none", 0):
                    return self._done(now)
                return self._refused(now, code)
        return [Stray(message)]

    def _can_message(self, now: float, message: CanMessage) -> list[Event]:
        request, node = self._request, need(self.link.can, "can").node_address
        is_ours = message.id == request.id and message.source == node
        if self._state == "wait" and is_ours:
            if request.kind == "telecommand":
                if message.kind == "acknowledge":
                    return self._done(now)
                if message.kind == "refusal":
                    return self._refused(now, None)
            elif message.kind == "reply":
                return self._replied(now, message.data)
            elif message.kind == "request_refusal":
                return self._refused(now, None)
        return [Stray(bytes((message.id,)) + message.data)]

    def _replied(self, now: float, frame: bytes) -> list[Event]:
        id, form = self._request.id, self.link.checksum
        length = self.link.frames[id]
        may_be_checked = form is not None and self.bus in form.telemetry_buses
        if form and may_be_checked and len(frame) == length + form.bytes:
            try:
                return self._done(now, i2c_reply(self.link, id, frame, True))
            except ChecksumError:
                return [LineError("checksum", id)]
        if len(frame) != length:
            return [Malformed(id)]
        if self._checks_frames:
            return [LineError("unchecked", id)]
        return self._done(now, frame)

    def _done(self, now: float, frame: bytes = b"") -> list[Event]:
        id, message = self._request.id, None
        if self._request.kind == "telemetry":
            message = self.link.TELEMETRY[id]
        self._end(now, self._attempts > 1)
        return [Done(id, self._attempts, frame, message)]

    def _refused(
        self, now: float, code: Optional[int], parameter: Optional[int] = None
    ) -> list[Event]:
        """Process a rejected request. After a wrong checksum it is sent again."""
        codes = {number: role for role, number in self.link.errors.items()}
        reason = None if code is None else codes.get(code)
        is_left = self._attempts <= self.settings.retries
        if reason == "checksum" and self._checks_sent and is_left:
            return self._transmit(now)
        self._end(now, self._attempts > 1)
        id = self._request.id
        return [Refused(id, self._attempts, code, reason, parameter)]

    def _timeout(self, now: float) -> list[Event]:
        self._end(now, True)
        return [Timeout(self._request.id, self._attempts)]

    def _end(self, now: float, may_be_answered_again: bool) -> None:
        self._state, self._late = "idle", None
        if may_be_answered_again:
            self._late = self._request.id, now + self.settings.reply_timeout


def _line_error(event: CanEvent) -> LineError:
    return LineError(event.event, event.id)
