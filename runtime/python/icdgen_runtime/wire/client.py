"""Client that sends one request at a time and reports its outcome, on any bus."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Literal, NamedTuple, Optional

from .._base import Message
from .._errors import LengthError, UnknownIdError
from .._hints import Buffer, N
from .can import CanEvent, CanJoiner, CanMessage, CanPacket, can_split
from .envelope import Direction
from .errors import BusyError, ChecksumError, UnsupportedError, need
from .events import (
    Arrived,
    Done,
    Event,
    Late,
    LineError,
    Log,
    Refused,
    Sent,
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

    kind: Direction
    id: int
    data: bytes = b""
    repeat: bool = False


MOST_AWAITED = 8
"""Largest number of requests whose responses are awaited or may still arrive late, and of
I2C transactions whose results are awaited.
"""


@dataclass
class _Late:
    """Responses that may still arrive although their request has ended."""

    kind: Direction
    id: int
    responses: int
    until: float


class Client(Generic[N]):
    """A client on one bus.

    Pass received data to `received`, `packet` or `transferred`, and call `tick` at
    `deadline` at the latest. Take the data to send from `output`, `packets` or
    `transfers`. Times are in milliseconds of any monotonic clock.

    Every request ends with one outcome: `Sent` if nothing responds to it, otherwise
    `Done`, `Refused` or `Timeout`. Unsolicited telemetry is reported as `Arrived`, a
    response to a request that has ended as `Late`, any other response as `Stray`.

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
        self.link = link
        self.bus: Bus = bus
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
        # I2C: transactions taken whose results were not yet passed to `transferred`
        self._taken: list[I2cTransfer] = []
        # hold: wait until no response to an earlier request can arrive. wait: for the
        # response. I2C only: pause until the next poll or attempt. poll: wait for the
        # result.
        self._state: Literal["idle", "hold", "wait", "pause", "poll"] = "idle"
        self._request = Request("telemetry", 0)
        self._attempts = 0
        self._until: float = 0  # end of the state
        self._latest: float = 0  # until when a response is in time
        self._owed = 0  # number of responses that may still arrive
        self._untaken = 0  # number of transmissions whose output was not taken
        self._is_written = False  # I2C: telecommand is sent, acknowledge is polled
        self._poll_end: float = 0  # when polling ends
        # A new request waits while a late response could be taken for its own.
        self._late: list[_Late] = []

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
        self._request, self._attempts, self._owed = request, 0, 0
        return self._transmit_or_hold(now)

    def output(self) -> bytes:
        """UART: return the bytes to send, each once."""
        taken, self._stream = self._stream, []
        self._untaken = 0
        return b"".join(taken)

    def packets(self) -> list[CanPacket]:
        """CAN: return the packets to send, each once."""
        taken, self._packets = self._packets, []
        self._untaken = 0
        return taken

    def transfers(self) -> list[I2cTransfer]:
        """I2C: return the transactions to perform, each once.

        Call `transferred` once for each transaction, in this order. There are no more
        while the results of eight transactions are missing.
        """
        free = MOST_AWAITED - len(self._taken)
        taken, self._transfers = self._transfers[:free], self._transfers[free:]
        self._untaken = min(self._untaken, len(self._transfers))
        self._taken += taken
        return taken

    def cancel(self) -> None:
        """Cancel the request without an event, and drop its remaining output.

        Another request may begin at once, except one to which a late response to the
        cancelled one could belong: it waits. The late response is `Late`.
        """
        self._stream, self._packets, self._transfers = [], [], []
        self._owed -= self._untaken  # nothing responds to what was not sent
        self._untaken = 0
        if self.busy:
            self._end()

    def tick(self, now: float) -> list[Event]:
        """Process timeouts. Call at `deadline` (in ms) at the latest."""
        events: list[Event] = []
        if self._joiner:
            events += map(_line_error, self._joiner.expire(now))
        self._forget(now)
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
        return events + self._no_longer_held(now)

    def packet(self, now: float, packet: CanPacket) -> list[Event]:
        """CAN: process a received packet."""
        events = self.tick(now)
        for result in need(self._joiner, "can").feed(now, packet):
            if result.message:
                events += self._can_message(now, result.message)
            else:
                events.append(_line_error(result))
        return events + self._no_longer_held(now)

    def transferred(self, now: float, data: Optional[Buffer]) -> list[Event]:
        """I2C: process the bytes that were read; None if the transaction failed.

        The result of a transaction whose time-out has passed, or whose request has
        ended, is reported as `Late`.
        """
        is_awaited = len(self._taken) == 1 and self._awaits_transfer
        transfer = self._taken.pop(0) if self._taken else None
        events = self.tick(now)  # may end the request of this transaction
        read = None if data is None else bytes(data)
        if transfer is None:
            return [*events, Stray(read or b"")]
        if not (is_awaited and self._awaits_transfer):
            return [*events, self._late_transfer(transfer, read)]
        if self._state == "poll":
            return events + self._polled(now, read)
        if read is None:
            self._owed = 0
            return events + self._no_reply(now)
        if self._request.kind == "telemetry":
            frame, fault = self._read_frame(self._request.id, read)
            if fault:
                return [*events, fault, *self._no_reply(now)]
            return events + self._done(frame)
        if not self.link.commands[self._request.id].acknowledged:
            return events + self._sent()
        self._is_written = True
        self._poll_end = self._latest = now + self.settings.poll_timeout
        return events + self._pause(now)

    @property
    def _awaits_transfer(self) -> bool:
        """I2C: whether the last transfer is taken and belongs to the request."""
        return self._state in ("wait", "poll") and not self._transfers

    def _late_transfer(self, transfer: I2cTransfer, data: Optional[bytes]) -> Event:
        """Return the event of a transaction whose result nothing awaits any more."""
        id = transfer.write[0]
        if data is None or not transfer.read:
            return Late(id, b"")
        frame, fault = self._read_frame(id, data)
        return fault or Late(id, frame, self.link.TELEMETRY.which(id, frame))

    def _read_frame(self, id: int, data: bytes) -> tuple[bytes, Optional[Event]]:
        """I2C: return the frame in the bytes read, and the fault if it is damaged."""
        try:
            return i2c_reply(self.link, id, data, self._checks_frames), None
        except ChecksumError:
            return b"", LineError("checksum", id)
        except LengthError:
            return b"", LineError("length", id)

    def _transmit_or_hold(self, now: float) -> list[Event]:
        """Send the request, or wait while a late response could be taken for its own."""
        self._forget(now)
        # So that the responses to all requests can be remembered, no other one is sent.
        is_full = len(self._late) == MOST_AWAITED
        ends = [late.until for late in self._late if is_full or self._is_of(late)]
        if not ends:
            return self._transmit(now)
        self._state, self._until = "hold", min(ends)
        return []

    def _no_longer_held(self, now: float) -> list[Event]:
        """Send the request if the late response has arrived for which it waits."""
        return self._transmit_or_hold(now) if self._state == "hold" else []

    def _forget(self, now: float) -> None:
        """Forget the late responses that can no longer arrive."""
        self._late = [late for late in self._late if now < late.until]

    def _is_of(self, late: _Late) -> bool:
        return (late.kind, late.id) == (self._request.kind, self._request.id)

    def _transmit(self, now: float) -> list[Event]:
        """Send the request, for the first time or again."""
        request = self._request
        is_telecommand = request.kind == "telecommand"
        is_answered = not is_telecommand or self.link.commands[request.id].acknowledged
        self._attempts += 1
        self._untaken += 1
        self._is_written = False
        self._state, self._until = "wait", now + self.settings.reply_timeout
        self._latest = self._until
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
            # A transaction brings telemetry itself; only an acknowledge is polled.
            self._owed = int(is_telecommand and is_answered)
            return []
        if not is_answered:
            return self._sent()
        self._owed += 1
        return []

    def _expired(self, now: float) -> list[Event]:
        """Process the end of the time of a state."""
        if self._state == "wait":
            return self._no_reply(now)
        if self._state == "poll":
            return self._pause(now)
        if self._state == "pause":
            if now >= self._poll_end:
                return self._timeout()
            if self._is_written:
                self._poll(now)
                return []
        if self._state == "hold":
            return self._transmit_or_hold(now)
        return self._transmit(now)

    def _no_reply(self, now: float) -> list[Event]:
        """Process a missing or unusable reply: send again or end the request."""
        if not self._request.repeat or self._attempts > self.settings.retries:
            return self._timeout()
        if self.bus == "i2c":  # a failure is immediate here: give the node some time
            self._state, self._until = "pause", now + self.settings.poll_interval
            self._poll_end = now + self.settings.poll_timeout
            return []
        return self._transmit(now)

    def _pause(self, now: float) -> list[Event]:
        """Poll again after the poll interval, until the poll timeout."""
        if now >= self._poll_end:
            return self._timeout()
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
        frame, fault = self._read_frame(form.telemetry, data)
        if fault:
            return [fault, *self._pause(now)]
        acknowledge = self.link.TELEMETRY[form.telemetry].from_bytes(frame)
        if getattr(acknowledge, form.id) != self._request.id or not getattr(
            acknowledge, form.processed
        ):
            return self._pause(now)
        code = int(getattr(acknowledge, form.error))
        if code == self.link.errors.get("none", 0):
            return self._done()
        return self._refused(now, code, int(getattr(acknowledge, form.parameter)))

    def _uart_message(self, now: float, message: bytes) -> list[Event]:
        link = self.link
        kind, id = uart_kind(link, message), message[0]
        if kind == "log":
            return [Log(message, LogMessage.decode(link, message))]
        if kind == "packet":
            telemetry = link.unsolicited[id]
            type = link.TELEMETRY.which(telemetry, message[1:])
            return [Arrived(telemetry, message[1:], {}, type)]
        if kind == "reply":
            return self._replied(id, message[1:])
        if kind == "acknowledge" and link.acknowledge:
            command = message[link.acknowledge.id_at]
            code = message[link.acknowledge.error_at]
            if self._waits_for("telecommand", command):
                if code == link.errors.get("none", 0):
                    return self._done()
                return self._refused(now, code)
            if self._is_late("telecommand", command):
                return [Late(id, message[1:])]
        return [Stray(message[1:], id)]

    def _can_message(self, now: float, message: CanMessage) -> list[Event]:
        id, kind = message.id, message.kind
        if message.source != need(self.link.can, "can").node_address:
            return [Stray(message.data, id)]
        if kind == "reply":
            return self._replied(id, message.data)
        if kind in ("acknowledge", "refusal", "request_refusal"):
            request: Direction = (
                "telemetry" if kind == "request_refusal" else "telecommand"
            )
            if self._waits_for(request, id):
                is_done = kind == "acknowledge"
                return self._done() if is_done else self._refused(now, None)
            if self._is_late(request, id):
                return [Late(id, message.data)]
        return [Stray(message.data, id)]

    def _replied(self, id: int, data: bytes) -> list[Event]:
        """Process telemetry."""
        if id not in self.link.frames:
            return [Stray(data, id)]
        frame, fault = self._frame(id, data)
        if fault:
            return [fault]
        if self._waits_for("telemetry", id):
            return self._done(frame)
        kind = self.link.TELEMETRY.which(id, frame)
        if self._is_late("telemetry", id):
            return [Late(id, frame, kind)]
        return [Stray(frame, id, kind)]

    def _frame(self, id: int, data: bytes) -> tuple[bytes, Optional[Event]]:
        """Return the frame in telemetry, and the fault if it is damaged.

        Its length shows whether it has a checksum.
        """
        form, length = self.link.checksum, self.link.frames[id]
        may_be_checked = form is not None and self.bus in form.telemetry_buses
        if form and may_be_checked and len(data) == length + form.bytes:
            try:
                return i2c_reply(self.link, id, data, True), None
            except ChecksumError:
                return b"", LineError("checksum", id)
        if len(data) != length:
            return b"", LineError("length", id)
        return data, LineError("unchecked", id) if self._checks_frames else None

    def _waits_for(self, kind: Direction, id: int) -> bool:
        request = self._request
        return self._state == "wait" and (kind, id) == (request.kind, request.id)

    def _is_late(self, kind: Direction, id: int) -> bool:
        """Return whether this is a response to a request that has ended, and count it."""
        found = [late for late in self._late if (late.kind, late.id) == (kind, id)]
        for late in found:
            late.responses -= 1
        self._late = [late for late in self._late if late.responses]
        return bool(found)

    def _done(self, frame: bytes = b"") -> list[Event]:
        id, message = self._request.id, None
        if self._request.kind == "telemetry":
            message = self.link.TELEMETRY[id]
        self._end(is_answered=True)
        return [Done(id, self._attempts, frame, message)]

    def _sent(self) -> list[Event]:
        self._end()
        return [Sent(self._request.id, self._attempts)]

    def _refused(
        self, now: float, code: Optional[int], parameter: Optional[int] = None
    ) -> list[Event]:
        """Process a rejected request. After a wrong checksum it is sent again."""
        codes = {number: role for role, number in self.link.errors.items()}
        reason = None if code is None else codes.get(code)
        is_left = self._attempts <= self.settings.retries
        if reason == "checksum" and self._checks_sent and is_left:
            self._owed -= 1
            return self._transmit(now)
        self._end(is_answered=True)
        id = self._request.id
        return [Refused(id, self._attempts, code, reason, parameter)]

    def _timeout(self) -> list[Event]:
        self._end()
        return [Timeout(self._request.id, self._attempts)]

    def _end(self, is_answered: bool = False) -> None:
        """End the request, and remember the responses that may still arrive."""
        self._state = "idle"
        owed = self._owed - is_answered
        if owed > 0:
            # A response counts from the last transmission, not from the end.
            until = self._latest + self.settings.late
            kind, id = self._request.kind, self._request.id
            self._late.append(_Late(kind, id, owed, until))


def _line_error(event: CanEvent) -> LineError:
    return LineError(event.event, event.id)
