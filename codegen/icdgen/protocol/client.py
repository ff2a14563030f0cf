"""The client: one request at a time, from sending to its outcome, over any bus.

A step machine without clock and without I/O: every call is given the time in milliseconds; `out` holds what is to be
sent, and each call returns events, mappings with the key ``event``:

- ``done``, ``refused``, ``timeout``: the end of the request, each with ``id`` and ``attempts``
- ``packet``, ``log``: what the node sent of its own accord
- ``stray``: what nobody waits for, such as a late acknowledge
- the events of the UART decoder and of the CAN joiner that tell of errors
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from icdgen import codec
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.protocol import can, i2c, uart
from icdgen.protocol.facts import CAN, I2C, UART, Client, Facts, need

TELECOMMAND, TELEMETRY = "telecommand", "telemetry"
IDLE, HOLD, WAIT, PAUSE, POLL = "idle", "hold", "wait", "pause", "poll"

Event = dict


class NotNow(RuntimeError):
    """A request is going on: another one would overrun the node's buffer."""


class UnknownId(LookupError):
    """The node has no such message."""


@dataclass(frozen=True, slots=True)
class Request:
    """``repeat``: whether it may be sent again although it may have arrived. Of telemetry it always may."""

    kind: str
    id: int
    data: bytes = b""
    repeat: bool = False


class Machine:
    """A client on one bus. ``checked``: with checksums, where the ICD has them for the bus; ``address``: ours, on CAN."""

    def __init__(
        self, known: Facts, bus: str, checked: bool = False, address: int = 0, settings: Client | None = None
    ) -> None:
        self.known, self.bus, self.address = known, bus, address
        self.settings = settings or known.client
        form = known.checksum if checked else None
        self.checks_telecommands = bool(form and bus in form.telecommand_buses)
        self.checks_telemetry = bool(form and bus in form.telemetry_buses)
        if bus == UART:
            self.decoder = uart.Decoder(need(known.framing, "uart"), known.longest)
        elif bus == CAN:
            self.joiner = can.Joiner(known, address, 1)
        else:
            need(known.i2c_address, "i2c")
        self.out: list = []  # UART: bytes; CAN: packets; I2C: (bytes to write, count to read)
        self._asked_for = self._told_of = 0  # I2C: transactions that went to `out`, and those that came back
        self.state = IDLE
        self.request: Request | None = None
        self.attempts = 0
        self.until = 0  # when the state ends by itself
        self._sent_whole = False  # I2C: the telecommand is sent, its acknowledge is polled
        self.give_up = 0  # when polling ends
        self.echo: tuple[int, int] | None = None  # id and end of what may still be answered a second time

    @property
    def deadline(self) -> int | None:
        """When `tick` wants to be called at the latest; None: not at all."""
        return None if self.state == IDLE else self.until

    def start(self, now: int, request: Request) -> list[Event]:
        """Begins a request. Raises `NotNow`, `UnknownId`, `icdgen.protocol.i2c.WrongLength`."""
        message = self._message(request)
        if self.state != IDLE or self.out:
            raise NotNow
        if request.kind == TELECOMMAND and len(request.data) != message.length:
            raise i2c.WrongLength(message.length, len(request.data))
        if request.kind == TELEMETRY or message.kind == CONFIGURATION:
            request = replace(request, repeat=True)
        self.request, self.attempts = request, 0
        if self.echo and self.echo[0] == request.id and now < self.echo[1]:
            self.state, self.until = HOLD, self.echo[1]
            return []
        return self._send(now)

    def tick(self, now: int) -> list[Event]:
        """Lets time pass."""
        events = self._joiner_errors(self.joiner.expire(now)) if self.bus == CAN else []
        if self.state == IDLE or now < self.until:
            return events
        if self.state == HOLD:
            return events + self._send(now)
        if self.state == PAUSE:
            if now >= self.give_up:
                return events + self._timeout(now)
            if self.bus == I2C and self._sent_whole:
                self._poll(now)
                return events
            return events + self._send(now)
        if self.state == POLL:
            return events + self._again(now)
        return events + self._no_reply(now)

    def received(self, now: int, data: bytes) -> list[Event]:
        """UART: the next bytes of the stream."""
        events = self.tick(now)
        for found in self.decoder.feed(data):
            events += self._uart_message(now, found.message) if found.message else [{"event": found.event}]
        return events

    def packet(self, now: int, packet: can.Packet) -> list[Event]:
        """CAN: a packet."""
        events = self.tick(now)
        for found in self.joiner.feed(now, packet):
            if found.message:
                events += self._can_message(now, found.message)
            else:
                events += self._joiner_errors([found])
        return events

    def transferred(self, now: int, data: bytes | None) -> list[Event]:
        """I2C: what was read in the oldest transaction that `out` asked for and nothing was told of; None: it failed."""
        awaited = self._owed == 1 and self._awaits_transfer  # before time passes, which may end that request
        self._told_of += self._owed > 0
        events = self.tick(now)
        if not (awaited and self._awaits_transfer):
            return [*events, {"event": "stray", "bytes": (data or b"").hex()}]
        if self.state == POLL:
            return events + (self._again(now) if data is None else self._polled(now, data))
        request = self._now
        if data is None:
            return events + self._no_reply(now)
        if request.kind == TELEMETRY:
            try:
                return events + self._done(now, i2c.reply(self.known, request.id, data, self.checks_telemetry))
            except ValueError:
                return [*events, {"event": "malformed", "id": request.id}, *self._no_reply(now)]
        message = self._message(request)
        if not message.acknowledge:
            return events + self._done(now)
        self._sent_whole = True
        self.give_up = now + self.settings.poll_timeout
        return events + self._again(now)

    def cancel(self) -> None:
        """Gives up the request, without an event, and what of it has not been taken; a late reply to it is ``stray``."""
        if self.bus == I2C:
            self._asked_for -= len(self.out)
        self.out.clear()
        if self.state != IDLE and self.attempts:
            self.echo = (self._now.id, self.until + self.settings.reply_timeout)
        self.state, self.request = IDLE, None

    @property
    def _owed(self) -> int:
        """I2C: transactions that were taken and of which nothing was told, whoever asked for them."""
        return self._asked_for - len(self.out) - self._told_of

    @property
    def _awaits_transfer(self) -> bool:
        """I2C: whether the last transaction that was asked for is taken, and that of the request."""
        return self.state in (WAIT, POLL) and not self.out

    @property
    def _now(self) -> Request:
        assert self.request
        return self.request

    def _message(self, request: Request) -> Message:
        table = self.known.telecommands if request.kind == TELECOMMAND else self.known.telemetry
        if request.id not in table:
            raise UnknownId(request.id)
        return table[request.id]

    def _send(self, now: int) -> list[Event]:
        """Sends the request, for the first time or again."""
        request = self._now
        self.attempts += 1
        self._sent_whole = False
        self.state, self.until = WAIT, now + self.settings.reply_timeout
        message = self._message(request)
        checked = request.kind == TELECOMMAND and self.checks_telecommands
        whole = i2c.telecommand(self.known, request.id, request.data, checked)
        if self.bus == UART:
            self.out.append(uart.encode(self.decoder.framing, whole))
        elif self.bus == CAN:
            kind = "telecommand" if request.kind == TELECOMMAND else "request"
            node = need(self.known.can, "can").node_address
            self.out += can.split(self.known, can.Message(kind, request.id, self.address, node, whole[1:]))
        else:
            size = i2c.read_length(self.known, message, self.checks_telemetry) if request.kind == TELEMETRY else 0
            self._transact(whole, size)
        if self.bus != I2C and request.kind == TELECOMMAND and not message.acknowledge:
            return self._done(now)
        return []

    def _done(self, now: int, data: bytes = b"") -> list[Event]:
        return self._end(now, {"event": "done", "bytes": data.hex()})

    def _refused(self, now: int, code: int | None, parameter: int | None = None) -> list[Event]:
        """The node refused it. A wrong checksum is no fault of the request: it is sent again."""
        reason = next((name for name, value in self.known.errors.items() if value == code), None)
        if reason == "checksum" and self.checks_telecommands and self.attempts <= self.settings.retries:
            return self._send(now)
        return self._end(now, {"event": "refused", "code": code, "reason": reason, "parameter": parameter})

    def _timeout(self, now: int) -> list[Event]:
        return self._end(now, {"event": "timeout"})

    def _end(self, now: int, event: Event) -> list[Event]:
        id, late = self._now.id, self.attempts > 1 or event["event"] == "timeout"
        self.echo = (id, now + self.settings.reply_timeout) if late else None
        self.state, self.request = IDLE, None
        return [{**event, "id": id, "attempts": self.attempts}]

    def _no_reply(self, now: int) -> list[Event]:
        """There was no reply, or none that can be used: once more, or the end."""
        if not self._now.repeat or self.attempts > self.settings.retries:
            return self._timeout(now)
        if self.bus == I2C:  # the bus said so at once: give the node some time
            self.state, self.until = PAUSE, now + self.settings.poll_interval
            self.give_up = now + self.settings.poll_timeout
            return []
        return self._send(now)

    def _uart_message(self, now: int, message: bytes) -> list[Event]:
        kind, id = uart.kind(self.known, message), message[0]
        if kind == uart.LOG:
            return [{"event": "log", "bytes": message.hex()}]
        if kind == uart.PACKET:
            at = 1 + need(self.known.files, "file_transfer").counter_bytes
            return [{"event": "packet", "number": self.known.number(message[1:at]), "bytes": message[at:].hex()}]
        request = self._now if self.state == WAIT else None
        if request and kind == uart.REPLY and request.kind == TELEMETRY and id == request.id:
            if len(message) - 1 == self._message(request).length:
                return self._done(now, message[1:])
            return [{"event": "malformed", "id": id}]
        if request and kind == uart.ACKNOWLEDGE and request.kind == TELECOMMAND:
            acknowledged, code = uart.acknowledged(self.known, message)
            if acknowledged == request.id:
                return self._done(now) if code == self.known.errors.get("none", 0) else self._refused(now, code)
        return [{"event": "stray", "bytes": message.hex()}]

    def _can_message(self, now: int, message: can.Message) -> list[Event]:
        request = self._now if self.state == WAIT else None
        node = need(self.known.can, "can").node_address
        if request and message.id == request.id and message.source == node:
            if request.kind == TELECOMMAND and message.kind == "acknowledge":
                return self._done(now)
            if (request.kind, message.kind) in ((TELECOMMAND, "refusal"), (TELEMETRY, "request_refusal")):
                return self._refused(now, None)
            if request.kind == TELEMETRY and message.kind == "reply":
                if len(message.data) == self._message(request).length:
                    return self._done(now, message.data)
                return [{"event": "malformed", "id": message.id}]
        return [{"event": "stray", "bytes": bytes([message.id]).hex() + message.data.hex()}]

    def _joiner_errors(self, events: list[can.Event]) -> list[Event]:
        return [{"event": event.event, "id": event.id} for event in events]

    def _poll(self, now: int) -> None:
        polled = need(self.known.polled, "i2c.acknowledge")
        self.state, self.until = POLL, now + self.settings.reply_timeout
        size = i2c.read_length(self.known, polled.message, self.checks_telemetry)
        self._transact(bytes([polled.message.ids[0]]), size)

    def _transact(self, write: bytes, read: int) -> None:
        self._asked_for += 1
        self.out.append((write, read))

    def _again(self, now: int) -> list[Event]:
        """Polls once more after a while."""
        if now >= self.give_up:
            return self._timeout(now)
        self.state, self.until = PAUSE, now + self.settings.poll_interval
        return []

    def _polled(self, now: int, data: bytes) -> list[Event]:
        polled = need(self.known.polled, "i2c.acknowledge")
        try:
            frame = i2c.reply(self.known, polled.message.ids[0], data, self.checks_telemetry)
        except ValueError:
            return [{"event": "malformed", "id": polled.message.ids[0]}, *self._again(now)]
        raw = codec.decode(self.known.node, polled.message, frame)
        if raw[polled.id] != self._now.id or not raw[polled.processed]:
            return self._again(now)
        code, parameter = raw[polled.error], raw[polled.parameter]
        if code == self.known.errors.get("none", 0):
            return self._done(now)
        return self._refused(now, int(code), int(parameter))  # type: ignore[arg-type]
