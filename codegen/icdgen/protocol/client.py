"""The client: one request at a time, from sending to its outcome, over any bus.

A step machine without clock and without I/O: every call is given the time in milliseconds; `out` holds what is to be
sent, and each call returns events, mappings with the key ``event``:

- ``done``, ``refused``, ``timeout``: the end of the request, each with ``id`` and ``attempts``
- ``packet``, ``log``: what the node sent of its own accord
- ``checksum``, ``unchecked``: a frame with a wrong checksum, or without the one that it must have; it is waited on
- ``stray``: what nobody waits for, such as a late acknowledge
- the events of the UART decoder and of the CAN joiner that tell of errors
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

IDLE, HOLD, WAIT, PAUSE, POLL = "idle", "hold", "wait", "pause", "poll"

Event = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Request:
    """``repeat``: whether it may be sent again although it may have arrived. Of telemetry it always may.

    ``reply``: over envelopes, id of the telemetry that answers a telecommand, where the ICD does not say so.
    """

    kind: str
    id: int
    data: bytes = b""
    repeat: bool = False
    reply: int | None = None


class Client:
    """A client on one bus. ``crc``: with checksums, where the ICD has them for the bus; ``address``: ours, on CAN."""

    def __init__(
        self, known: Facts, bus: str, crc: bool = False, address: int = 0, settings: Settings | None = None
    ) -> None:
        self.known, self.bus, self.address = known, bus, address
        self.settings = settings or known.client
        form = known.checksum
        self._checks_sent = bool(form and bus in (form.telecommand_buses if crc else form.telecommand_always))
        self._checks_frames = bool(form and bus in (form.telemetry_buses if crc else form.telemetry_always))
        if bus == UART:
            self._decoder = uart.Decoder(need(known.framing, "uart"), known.longest)
        elif bus == CAN:
            self._joiner = can.Joiner(known, address, 1)
        else:
            need(known.i2c_address, "i2c")
        self.out: list[Any] = []  # UART: bytes; CAN: packets; I2C: (bytes to write, count to read)
        # I2C: transactions that went to `out`, and those that came back
        self._transfers_asked = self._transfers_reported = 0
        self.state = IDLE
        self.request: Request | None = None
        self.attempts = 0
        self._until = 0  # when the state ends by itself
        self._is_written = False  # I2C: the telecommand is sent, its acknowledge is polled
        self._give_up = 0  # when polling ends
        self._late: tuple[int, int] | None = None  # id and end of what may still be answered a second time

    @property
    def deadline(self) -> int | None:
        """When `tick` wants to be called at the latest; None: not at all."""
        return None if self.state == IDLE else self._until

    def start(self, now: int, request: Request) -> list[Event]:
        """Begins a request. Raises `BusyError`, `UnknownIdError`, `LengthError`."""
        message = self._message(request)
        if self.state != IDLE or self.out:
            raise BusyError
        if request.kind == TELECOMMAND and len(request.data) != message.length:
            raise LengthError(message.length, len(request.data))
        if request.kind == TELEMETRY or message.kind == CONFIGURATION:
            request = replace(request, repeat=True)
        self.request, self.attempts = request, 0
        if self._late and self._late[0] == request.id and now < self._late[1]:
            self.state, self._until = HOLD, self._late[1]
            return []
        return self._transmit(now)

    def tick(self, now: int) -> list[Event]:
        """Lets time pass."""
        events = self._line_errors(self._joiner.expire(now)) if self.bus == CAN else []
        if self.state == IDLE or now < self._until:
            return events
        if self.state == HOLD:
            return events + self._transmit(now)
        if self.state == PAUSE:
            if now >= self._give_up:
                return events + self._timeout(now)
            if self.bus == I2C and self._is_written:
                self._poll(now)
                return events
            return events + self._transmit(now)
        if self.state == POLL:
            return events + self._pause(now)
        return events + self._no_reply(now)

    def received(self, now: int, data: bytes) -> list[Event]:
        """UART: the next bytes of the stream."""
        events = self.tick(now)
        for found in self._decoder.feed(data):
            events += self._uart_message(now, found.message) if found.message else [{"event": found.event}]
        return events

    def packet(self, now: int, packet: can.Packet) -> list[Event]:
        """CAN: a packet."""
        events = self.tick(now)
        for found in self._joiner.feed(now, packet):
            if found.message:
                events += self._can_message(now, found.message)
            else:
                events += self._line_errors([found])
        return events

    def transferred(self, now: int, data: bytes | None) -> list[Event]:
        """I2C: what was read in the oldest transaction that `out` asked for and nothing was reported of; None: it failed."""
        awaited = self._owed == 1 and self._awaits_transfer  # before time passes, which may end that request
        self._transfers_reported += self._owed > 0
        events = self.tick(now)
        if not (awaited and self._awaits_transfer):
            return [*events, {"event": "stray", "bytes": (data or b"").hex()}]
        if self.state == POLL:
            return events + (self._pause(now) if data is None else self._polled(now, data))
        request = self._asked
        if data is None:
            return events + self._no_reply(now)
        if request.kind == TELEMETRY:
            try:
                return events + self._done(now, i2c.reply(self.known, request.id, data, self._checks_frames))
            except ValueError:
                return [*events, {"event": "malformed", "id": request.id}, *self._no_reply(now)]
        message = self._message(request)
        if not message.acknowledge:
            return events + self._done(now)
        self._is_written = True
        self._give_up = now + self.settings.poll_timeout
        return events + self._pause(now)

    def cancel(self) -> None:
        """Gives up the request, without an event, and what of it has not been taken; a late reply to it is ``stray``."""
        if self.bus == I2C:
            self._transfers_asked -= len(self.out)
        self.out.clear()
        if self.state != IDLE and self.attempts:
            self._late = (self._asked.id, self._until + self.settings.reply_timeout)
        self.state, self.request = IDLE, None

    @property
    def _owed(self) -> int:
        """I2C: transactions that were taken and of which nothing was reported, whoever asked for them."""
        return self._transfers_asked - len(self.out) - self._transfers_reported

    @property
    def _awaits_transfer(self) -> bool:
        """I2C: whether the last transaction that was asked for is taken, and that of the request."""
        return self.state in (WAIT, POLL) and not self.out

    @property
    def _asked(self) -> Request:
        assert self.request
        return self.request

    def _message(self, request: Request) -> Message:
        table = self.known.telecommands if request.kind == TELECOMMAND else self.known.telemetry
        if request.id not in table:
            raise UnknownIdError(request.id)
        return table[request.id]

    def _transmit(self, now: int) -> list[Event]:
        """Sends the request, for the first time or again."""
        request = self._asked
        self.attempts += 1
        self._is_written = False
        self.state, self._until = WAIT, now + self.settings.reply_timeout
        message = self._message(request)
        checked = request.kind == TELECOMMAND and self._checks_sent
        whole = i2c.telecommand(self.known, request.id, request.data, checked)
        if self.bus == UART:
            self.out.append(uart.encode(self._decoder.framing, whole))
        elif self.bus == CAN:
            kind = "telecommand" if request.kind == TELECOMMAND else "request"
            node = need(self.known.can, "can").node_address
            self.out += can.split(self.known, can.Message(kind, request.id, self.address, node, whole[1:]))
        else:
            size = i2c.read_length(self.known, message, self._checks_frames) if request.kind == TELEMETRY else 0
            self._transact(whole, size)
        if self.bus != I2C and request.kind == TELECOMMAND and not message.acknowledge:
            return self._done(now)
        return []

    def _done(self, now: int, data: bytes = b"") -> list[Event]:
        return self._end(now, {"event": "done", "bytes": data.hex()})

    def _refused(self, now: int, code: int | None, parameter: int | None = None) -> list[Event]:
        """The node refused it. A wrong checksum is no fault of the request: it is sent again."""
        reason = next((name for name, value in self.known.errors.items() if value == code), None)
        if reason == "checksum" and self._checks_sent and self.attempts <= self.settings.retries:
            return self._transmit(now)
        return self._end(now, {"event": "refused", "code": code, "reason": reason, "parameter": parameter})

    def _timeout(self, now: int) -> list[Event]:
        return self._end(now, {"event": "timeout"})

    def _end(self, now: int, event: Event) -> list[Event]:
        id, may_be_answered_again = self._asked.id, self.attempts > 1 or event["event"] == "timeout"
        self._late = (id, now + self.settings.reply_timeout) if may_be_answered_again else None
        self.state, self.request = IDLE, None
        return [{**event, "id": id, "attempts": self.attempts}]

    def _no_reply(self, now: int) -> list[Event]:
        """There was no reply, or none that can be used: once more, or the end."""
        if not self._asked.repeat or self.attempts > self.settings.retries:
            return self._timeout(now)
        if self.bus == I2C:  # the bus said so at once: give the node some time
            self.state, self._until = PAUSE, now + self.settings.poll_interval
            self._give_up = now + self.settings.poll_timeout
            return []
        return self._transmit(now)

    def _uart_message(self, now: int, message: bytes) -> list[Event]:
        kind, id = uart.kind(self.known, message), message[0]
        if kind == uart.LOG:
            return [{"event": "log", "bytes": message.hex()}]
        if kind == uart.PACKET:
            at = 1 + need(self.known.files, "file_transfer").counter_bytes
            return [{"event": "packet", "number": self.known.number(message[1:at]), "bytes": message[at:].hex()}]
        request = self._asked if self.state == WAIT else None
        if request and kind == uart.REPLY and request.kind == TELEMETRY and id == request.id:
            return self._replied(now, id, message[1:])
        if request and kind == uart.ACKNOWLEDGE and request.kind == TELECOMMAND:
            acknowledged, code = uart.acknowledged(self.known, message)
            if acknowledged == request.id:
                return self._done(now) if code == self.known.errors.get("none", 0) else self._refused(now, code)
        return [{"event": "stray", "bytes": message.hex()}]

    def _can_message(self, now: int, message: can.Message) -> list[Event]:
        request = self._asked if self.state == WAIT else None
        node = need(self.known.can, "can").node_address
        if request and message.id == request.id and message.source == node:
            if request.kind == TELECOMMAND and message.kind == "acknowledge":
                return self._done(now)
            if (request.kind, message.kind) in ((TELECOMMAND, "refusal"), (TELEMETRY, "request_refusal")):
                return self._refused(now, None)
            if request.kind == TELEMETRY and message.kind == "reply":
                return self._replied(now, message.id, message.data)
        return [{"event": "stray", "bytes": bytes([message.id]).hex() + message.data.hex()}]

    def _replied(self, now: int, id: int, data: bytes) -> list[Event]:
        """What came as the frame: with a checksum where there may be one, without where there need not."""
        form, length = self.known.checksum, self.known.telemetry[id].length
        if form and self.bus in form.telemetry_buses and len(data) == length + form.bytes:
            try:
                return self._done(now, i2c.reply(self.known, id, data, True))
            except ChecksumError:
                return [{"event": "checksum", "id": id}]
        if len(data) != length:
            return [{"event": "malformed", "id": id}]
        return [{"event": "unchecked", "id": id}] if self._checks_frames else self._done(now, data)

    def _line_errors(self, events: list[can.Event]) -> list[Event]:
        return [{"event": event.event, "id": event.id} for event in events]

    def _poll(self, now: int) -> None:
        polled = need(self.known.polled, "i2c.acknowledge")
        self.state, self._until = POLL, now + self.settings.reply_timeout
        size = i2c.read_length(self.known, polled.message, self._checks_frames)
        self._transact(bytes([polled.message.ids[0]]), size)

    def _transact(self, write: bytes, read: int) -> None:
        self._transfers_asked += 1
        self.out.append((write, read))

    def _pause(self, now: int) -> list[Event]:
        """Polls once more after a while."""
        if now >= self._give_up:
            return self._timeout(now)
        self.state, self._until = PAUSE, now + self.settings.poll_interval
        return []

    def _polled(self, now: int, data: bytes) -> list[Event]:
        polled = need(self.known.polled, "i2c.acknowledge")
        try:
            frame = i2c.reply(self.known, polled.message.ids[0], data, self._checks_frames)
        except ValueError:
            return [{"event": "malformed", "id": polled.message.ids[0]}, *self._pause(now)]
        raw = codec.decode(self.known.node, polled.message, frame)
        if raw[polled.id] != self._asked.id or not raw[polled.processed]:
            return self._pause(now)
        code, parameter = raw[polled.error], raw[polled.parameter]
        if code == self.known.errors.get("none", 0):
            return self._done(now)
        return self._refused(now, int(code), int(parameter))
