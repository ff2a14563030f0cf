"""Client that sends one request at a time over UART, I2C or CAN and reports its
outcome.

The client is a state machine without clock and I/O. Each call receives the time in
milliseconds, `out` collects the bytes or packets to send, and each call returns events.
An event is a mapping with the key ``event``:

- ``done``, ``refused``, ``timeout``: end of the request, with ``id`` and ``attempts``
- ``packet``, ``log``: unsolicited message of the node
- ``checksum``, ``unchecked``: frame with a wrong checksum, or without a mandatory one;
  the client waits on
- ``stray``: message that no request waits for, such as a late acknowledge
- error events of the UART decoder and of the CAN joiner
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from icdgen import codec
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Message
from icdgen.protocol import can, i2c, uart
from icdgen.protocol.errors import BusyError, ChecksumError, LengthError, UnknownIdError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import CAN, I2C, UART, Settings

# HOLD waits for a late response of the previous request, WAIT for the response, PAUSE
# for the next poll, POLL for its result.
IDLE, HOLD, WAIT, PAUSE, POLL = "idle", "hold", "wait", "pause", "poll"

Event = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Request:
    """Request of a telecommand or of telemetry.

    ``repeat``: whether the client may send it again although the node may have received
    it; always true for telemetry. ``reply``: id of the telemetry that responds to a
    telecommand sent in a packet format, if the ICD does not define one.
    """

    kind: str
    id: int
    data: bytes = b""
    repeat: bool = False
    reply: int | None = None


class Client:
    """Client on one bus.

    ``crc``: whether optional checksums are used on this bus. ``address``: address of
    the client on CAN.
    """

    def __init__(
        self,
        facts: Facts,
        bus: str,
        crc: bool = False,
        address: int = 0,
        settings: Settings | None = None,
    ) -> None:
        self.facts, self.bus, self.address = facts, bus, address
        self.settings = settings or facts.client
        form = facts.checksum
        # `..._always`: the node rejects messages without checksum, so the client has no
        # choice.
        self._checks_sent = bool(
            form and bus in (form.telecommand_buses if crc else form.telecommand_always)
        )
        self._checks_frames = bool(
            form and bus in (form.telemetry_buses if crc else form.telemetry_always)
        )
        if bus == UART:
            self._decoder = uart.Decoder(need(facts.framing, "uart"), facts.longest)
        elif bus == CAN:
            self._joiner = can.Joiner(facts, address, 1)
        else:
            need(facts.i2c_address, "i2c")
        # UART: bytes; CAN: packets; I2C: (bytes to write, count to read)
        self.out: list[Any] = []
        # I2C: number of transactions put into `out`, and of those whose result was
        # reported.
        self._transfers_asked = self._transfers_reported = 0
        self.state = IDLE
        self.request: Request | None = None
        self.attempts = 0
        self._until = 0  # end of the state in ms, unless an event ends it earlier
        self._is_written = False  # I2C: telecommand is sent, its acknowledge is polled
        self._give_up = 0  # end of polling in ms
        # Id of a request with a possible late response, and time limit of it
        self._late: tuple[int, int] | None = None

    @property
    def deadline(self) -> int | None:
        """Latest time of the next call of `tick`; None if no call is needed."""
        return None if self.state == IDLE else self._until

    def start(self, now: int, request: Request) -> list[Event]:
        """Start a request.

        Raises `BusyError`, `UnknownIdError` and `LengthError`.
        """
        message = self._message(request)
        if self.state != IDLE or self.out:
            raise BusyError
        if request.kind == TELECOMMAND and len(request.data) != message.length:
            raise LengthError(message.length, len(request.data))
        # Reading telemetry or setting the same configuration twice does no harm.
        if request.kind == TELEMETRY or message.kind == CONFIGURATION:
            request = replace(request, repeat=True)
        self.request, self.attempts = request, 0
        # A late response to the previous request of this id could be taken for the
        # response to this one.
        if self._late and self._late[0] == request.id and now < self._late[1]:
            self.state, self._until = HOLD, self._late[1]
            return []
        return self._transmit(now)

    def tick(self, now: int) -> list[Event]:
        """Process the passage of time."""
        events = self._line_errors(self._joiner.expire(now)) if self.bus == CAN else []
        # The state ends only at its deadline; earlier calls only expire CAN packets.
        if self.state == IDLE or now < self._until:
            return events
        if self.state == HOLD:
            return events + self._transmit(now)
        if self.state == PAUSE:
            if now >= self._give_up:
                return events + self._timeout(now)
            # The telecommand has arrived: only the poll for its acknowledge is sent
            # again.
            if self.bus == I2C and self._is_written:
                self._poll(now)
                return events
            return events + self._transmit(now)
        if self.state == POLL:
            return events + self._pause(now)
        return events + self._no_reply(now)

    def received(self, now: int, data: bytes) -> list[Event]:
        """UART: process the next bytes of the stream."""
        events = self.tick(now)
        for decoded in self._decoder.feed(data):
            events += (
                self._uart_message(now, decoded.message)
                if decoded.message
                else [{"event": decoded.event}]
            )
        return events

    def packet(self, now: int, packet: can.Packet) -> list[Event]:
        """CAN: process a packet."""
        events = self.tick(now)
        for joined in self._joiner.feed(now, packet):
            if joined.message:
                events += self._can_message(now, joined.message)
            else:
                events += self._line_errors([joined])
        return events

    def transferred(self, now: int, data: bytes | None) -> list[Event]:
        """I2C: process the result of the oldest unreported transaction of `out`.

        ``data``: the bytes read; None if the transaction failed.
        """
        # Evaluated before `tick`, which may end the request
        awaited = self._unreported == 1 and self._awaits_transfer
        self._transfers_reported += self._unreported > 0
        events = self.tick(now)
        if not (awaited and self._awaits_transfer):
            return [*events, {"event": "stray", "bytes": (data or b"").hex()}]
        if self.state == POLL:
            return events + (
                self._pause(now) if data is None else self._polled(now, data)
            )
        request = self._current
        if data is None:
            return events + self._no_reply(now)
        if request.kind == TELEMETRY:
            try:
                return events + self._done(
                    now, i2c.reply(self.facts, request.id, data, self._checks_frames)
                )
            except ValueError:
                return [
                    *events,
                    {"event": "malformed", "id": request.id},
                    *self._no_reply(now),
                ]
        message = self._message(request)
        if not message.acknowledge:
            return events + self._done(now)
        self._is_written = True
        self._give_up = now + self.settings.poll_timeout
        return events + self._pause(now)

    def cancel(self) -> None:
        """Cancel the request without an event, and its output that was not taken.

        The client reports a late response to it as ``stray``.
        """
        if self.bus == I2C:
            self._transfers_asked -= len(self.out)
        self.out.clear()
        # A request in the state HOLD was never sent, so no response to it can come.
        if self.state != IDLE and self.attempts:
            self._late = (self._current.id, self._until + self.settings.reply_timeout)
        self.state, self.request = IDLE, None

    @property
    def _unreported(self) -> int:
        """I2C: number of transactions taken from `out` whose result was not reported,
        earlier requests included.
        """
        return self._transfers_asked - len(self.out) - self._transfers_reported

    @property
    def _awaits_transfer(self) -> bool:
        """I2C: whether the last transaction of the current request is taken and its
        result outstanding.
        """
        return self.state in (WAIT, POLL) and not self.out

    @property
    def _current(self) -> Request:
        assert self.request
        return self.request

    def _message(self, request: Request) -> Message:
        table = (
            self.facts.telecommands
            if request.kind == TELECOMMAND
            else self.facts.telemetry
        )
        if request.id not in table:
            raise UnknownIdError(request.id)
        return table[request.id]

    def _transmit(self, now: int) -> list[Event]:
        """Send the request or repeat it."""
        request = self._current
        self.attempts += 1
        self._is_written = False
        self.state, self._until = WAIT, now + self.settings.reply_timeout
        message = self._message(request)
        checked = request.kind == TELECOMMAND and self._checks_sent
        message_bytes = i2c.telecommand(self.facts, request.id, request.data, checked)
        if self.bus == UART:
            self.out.append(uart.encode(self._decoder.framing, message_bytes))
        elif self.bus == CAN:
            kind = "telecommand" if request.kind == TELECOMMAND else "request"
            node = need(self.facts.can, "can").node_address
            self.out += can.split(
                self.facts,
                can.Message(kind, request.id, self.address, node, message_bytes[1:]),
            )
        else:
            size = (
                i2c.read_length(self.facts, message, self._checks_frames)
                if request.kind == TELEMETRY
                else 0
            )
            self._transact(message_bytes, size)
        if self.bus != I2C and request.kind == TELECOMMAND and not message.acknowledge:
            return self._done(now)
        return []

    def _done(self, now: int, data: bytes = b"") -> list[Event]:
        return self._end(now, {"event": "done", "bytes": data.hex()})

    def _refused(
        self, now: int, code: int | None, parameter: int | None = None
    ) -> list[Event]:
        """Process a negative acknowledge.

        After a checksum error of the transmission, the request is sent again.
        """
        reason = next(
            (name for name, value in self.facts.errors.items() if value == code), None
        )
        # The request itself was valid.
        if (
            reason == "checksum"
            and self._checks_sent
            and self.attempts <= self.settings.retries
        ):
            return self._transmit(now)
        return self._end(
            now,
            {
                "event": "refused",
                "code": code,
                "reason": reason,
                "parameter": parameter,
            },
        )

    def _timeout(self, now: int) -> list[Event]:
        return self._end(now, {"event": "timeout"})

    def _end(self, now: int, event: Event) -> list[Event]:
        # Each attempt may have its response, and the last one may come after the time
        # limit.
        id, may_respond_again = (
            self._current.id,
            self.attempts > 1 or event["event"] == "timeout",
        )
        self._late = (
            (id, now + self.settings.reply_timeout) if may_respond_again else None
        )
        self.state, self.request = IDLE, None
        return [{**event, "id": id, "attempts": self.attempts}]

    def _no_reply(self, now: int) -> list[Event]:
        """Repeat the request or end it, after no usable response."""
        if not self._current.repeat or self.attempts > self.settings.retries:
            return self._timeout(now)
        # I2C reports this at once: the node gets some time before the next attempt
        if self.bus == I2C:
            self.state, self._until = PAUSE, now + self.settings.poll_interval
            self._give_up = now + self.settings.poll_timeout
            return []
        return self._transmit(now)

    def _uart_message(self, now: int, message: bytes) -> list[Event]:
        kind, id = uart.kind(self.facts, message), message[0]
        if kind == uart.LOG:
            return [{"event": "log", "bytes": message.hex()}]
        if kind == uart.PACKET:
            at = 1 + need(self.facts.files, "file_transfer").counter_bytes
            return [
                {
                    "event": "packet",
                    "number": self.facts.number(message[1:at]),
                    "bytes": message[at:].hex(),
                }
            ]
        request = self._current if self.state == WAIT else None
        if (
            request
            and kind == uart.REPLY
            and request.kind == TELEMETRY
            and id == request.id
        ):
            return self._replied(now, id, message[1:])
        if request and kind == uart.ACKNOWLEDGE and request.kind == TELECOMMAND:
            acknowledged, code = uart.acknowledged(self.facts, message)
            if acknowledged == request.id:
                return (
                    self._done(now)
                    if code == self.facts.errors.get("none", 0)
                    else self._refused(now, code)
                )
        return [{"event": "stray", "bytes": message.hex()}]

    def _can_message(self, now: int, message: can.Message) -> list[Event]:
        request = self._current if self.state == WAIT else None
        node = need(self.facts.can, "can").node_address
        if request and message.id == request.id and message.source == node:
            if request.kind == TELECOMMAND and message.kind == "acknowledge":
                return self._done(now)
            if (request.kind, message.kind) in (
                (TELECOMMAND, "refusal"),
                (TELEMETRY, "request_refusal"),
            ):
                return self._refused(now, None)
            if request.kind == TELEMETRY and message.kind == "reply":
                return self._replied(now, message.id, message.data)
        return [
            {"event": "stray", "bytes": bytes([message.id]).hex() + message.data.hex()}
        ]

    def _replied(self, now: int, id: int, data: bytes) -> list[Event]:
        """Process a reply.

        A checksum is accepted on each bus that can have it, and required where it is
        mandatory.
        """
        form, length = self.facts.checksum, self.facts.telemetry[id].length
        # The length of the reply shows whether it has a checksum.
        if (
            form
            and self.bus in form.telemetry_buses
            and len(data) == length + form.bytes
        ):
            try:
                return self._done(now, i2c.reply(self.facts, id, data, True))
            except ChecksumError:
                return [{"event": "checksum", "id": id}]
        if len(data) != length:
            return [{"event": "malformed", "id": id}]
        return (
            [{"event": "unchecked", "id": id}]
            if self._checks_frames
            else self._done(now, data)
        )

    def _line_errors(self, events: list[can.Event]) -> list[Event]:
        return [{"event": event.event, "id": event.id} for event in events]

    def _poll(self, now: int) -> None:
        polled = need(self.facts.polled, "i2c.acknowledge")
        self.state, self._until = POLL, now + self.settings.reply_timeout
        size = i2c.read_length(self.facts, polled.message, self._checks_frames)
        self._transact(bytes([polled.message.ids[0]]), size)

    def _transact(self, write: bytes, read: int) -> None:
        self._transfers_asked += 1
        self.out.append((write, read))

    def _pause(self, now: int) -> list[Event]:
        """Wait for the next poll."""
        if now >= self._give_up:
            return self._timeout(now)
        self.state, self._until = PAUSE, now + self.settings.poll_interval
        return []

    def _polled(self, now: int, data: bytes) -> list[Event]:
        polled = need(self.facts.polled, "i2c.acknowledge")
        try:
            frame = i2c.reply(
                self.facts, polled.message.ids[0], data, self._checks_frames
            )
        except ValueError:
            return [
                {"event": "malformed", "id": polled.message.ids[0]},
                *self._pause(now),
            ]
        raw = codec.decode(self.facts.node, polled.message, frame)
        # The frame still describes an earlier telecommand, or this one is not
        # processed.
        if raw[polled.id] != self._current.id or not raw[polled.processed]:
            return self._pause(now)
        code, parameter = raw[polled.error], raw[polled.parameter]
        if code == self.facts.errors.get("none", 0):
            return self._done(now)
        return self._refused(now, int(code), int(parameter))
