"""Client that sends requests and reports their outcomes, on any link.

The application calls it with the time, received bytes and requests, and takes out bytes
to send and events. The line of the link (`lines`) encodes and decodes; the client has
the time-outs, the retries and the queue of requests.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Generic, Optional

from .._base import Message
from .._errors import LengthError
from .._hints import Buffer, N
from .awaited import MOST_AWAITED, Arrival, Awaited, LateResponses, Request, Slot
from .bus_lines import CanLine, UartLine
from .can import CanPacket
from .errors import BusyError, UnsupportedError
from .events import Busy, Done, Event, Late, Progress, Refused, Reply, Sent, Timeout
from .i2c import I2cTransfer
from .i2c_line import I2cLine
from .lines import Line
from .link import Bus, Link, Settings
from .message_ids import (
    NodeMessage,
    NodeMessageClass,
    class_of,
    message_of,
    requested_id,
    sent_id,
)
from .packet_formats import Direction, Response
from .stream_line import StreamLine


class Client(Generic[N]):
    """A client on a bus, or without ``bus`` on a framed link.

    Pass received data to `received`, `packet` (CAN) or `transferred` (I2C), and call
    `tick` at `deadline` at the latest. After each call, take the data to send from
    `output`, `packets` or `transfers`. Times are in milliseconds of any monotonic clock.

    Requests are sent in the order in which they began. A request waits while as many
    are in progress as the device handles, or while a response to another request could
    be taken for a response to it.

    Every request ends with one outcome: `Sent` if nothing responds to it, otherwise
    `Done`, `Refused`, `Busy` or `Timeout`. Unsolicited telemetry is reported as
    `Arrived`, a response to a request that has ended as `Late`, any other response as
    `Stray`.

    ``crc``: use optional checksums of a bus. ``address``: address of the client on CAN.
    ``values``: values of the frame fields of a framed link that the sender chooses, such
    as ``source``; see `Sender`. ``requests``: largest number of requests in progress and
    waiting. Raise `UnsupportedError` for a link that the ICD does not describe.
    """

    def __init__(
        self,
        link: Link[N],
        bus: Optional[Bus] = None,
        *,
        crc: bool = False,
        address: int = 0,
        settings: Optional[Settings] = None,
        values: Optional[Mapping[str, int]] = None,
        requests: Optional[int] = None,
    ) -> None:
        self.link = link
        self.bus: Optional[Bus] = bus
        self.settings = settings or link.settings
        self._line = _line_of(link, bus, crc, address, values)
        self._max_requests = requests
        self.begun = 0
        """Handle of the last request."""
        self._slots: list[Slot] = []  # in the order in which they began
        self._late: list[LateResponses] = []
        self._now = 0.0  # time of the last call
        self._next_output = 0.0  # the gap after the last transmission ends then

    @property
    def busy(self) -> bool:
        """Whether a request is in progress."""
        return bool(self._slots)

    @property
    def deadline(self) -> Optional[float]:
        """Time in ms at which `tick` must be called at the latest; None if idle."""
        times = [slot.until for slot in self._slots if slot.state != "queued"]
        slot = self._queued()
        if slot:
            # It may be possible to send the request then.
            ends = [self._next_output, *(late.until for late in self._blocking(slot))]
            times += [end for end in ends if end > self._now]
        return min(times, default=None)

    @property
    def discarded(self) -> int:
        """Number of received bytes that are not part of a message."""
        return self._line.discarded

    def request(self, now: float, message: NodeMessageClass[N, Message]) -> None:
        """Request telemetry or read a configuration. See `start`."""
        request = Request("telemetry", requested_id(self.link, message))
        self._begin(now, request, kind=class_of(message))

    def send(
        self,
        now: float,
        message: NodeMessage[N],
        repeat: bool = False,
        reply: Optional[NodeMessageClass[N, Message]] = None,
    ) -> None:
        """Send a telecommand or set a configuration.

        See `start`; also raise `RangeError`. ``reply``: on a framed link, class of the
        reply, if the ICD does not specify one.
        """
        id, data = sent_id(self.link, message), message_of(message).to_bytes()
        request = Request("telecommand", id, data, repeat)
        if reply is None:
            self._begin(now, request)
        else:
            self._begin(now, request, requested_id(self.link, reply), class_of(reply))

    def start(self, now: float, request: Request, reply: Optional[int] = None) -> None:
        """Start a request. ``reply`` is the id of the reply to a telecommand on a framed
        link.

        Raise `UnknownIdError` and `LengthError`. Raise `BusyError` if there are too
        many requests. Raise `UnsupportedError` for telemetry that no telecommand
        without values requests.
        """
        self._begin(now, request, reply)

    def output(self) -> bytes:
        """UART and framed links: return the next encoded message to send, or no bytes.

        Its times count from the previous call of another method.
        """
        unit = None if self.bus in ("can", "i2c") else self._transmit()
        return unit or b""

    def packets(self) -> list[CanPacket]:
        """CAN: return the packets to send, each once. Times count as in `output`."""
        packets: list[CanPacket] = []
        while self.bus == "can" and (more := self._transmit()):
            packets += more
        return packets

    def transfers(self) -> list[I2cTransfer]:
        """I2C: return the transactions to perform, each once. Times count as in `output`.

        Call `transferred` once for each transaction, in this order. There are no more
        while the results of eight transactions are missing.
        """
        line = self._line
        if not isinstance(line, I2cLine):
            return []
        while transfer := self._transmit():
            line.put(transfer)
        return line.take()

    def sent(self, handle: int) -> Optional[Sent]:
        """End a request that was sent and that nothing responds to, without waiting for
        `tick`. Return None for any other request.
        """
        for slot in self._slots:
            if slot.handle == handle and slot.state == "sent":
                return self._sent(slot)
        return None

    def cancel(
        self,
        kind: Optional[Direction] = None,
        id: Optional[int] = None,
        handle: Optional[int] = None,
    ) -> None:
        """Cancel a request, or all, without an event. A late response is `Late`.

        ``handle``: only the request of this handle.
        """
        for slot in [*self._slots]:
            request = slot.plan.request
            is_meant = kind in (None, request.kind) and id in (None, request.id)
            if is_meant and handle in (None, slot.handle):
                self._end(slot)

    def tick(self, now: float) -> list[Event]:
        """Process timeouts. Call at `deadline` (in ms) at the latest."""
        events = self._line.expire(now)
        self._set_time(now)
        for slot in [*self._slots]:
            if slot.state != "queued" and now >= slot.until:
                events += self._expired(now, slot)
        return events

    def received(self, now: float, data: Buffer) -> list[Event]:
        """UART and framed links: process received bytes, a piece of the stream of any
        size, or one packet.
        """
        if self.bus not in (None, "uart"):
            raise UnsupportedError("bytes are received on UART and framed links only")
        return self._received(now, data)

    def packet(self, now: float, packet: CanPacket) -> list[Event]:
        """CAN: process a received packet."""
        if self.bus != "can":
            raise UnsupportedError("packets are received on CAN only")
        return self._received(now, packet)

    def transferred(self, now: float, data: Optional[Buffer]) -> list[Event]:
        """I2C: process the bytes that were read; None if the transaction failed.

        The result of a transaction whose time-out has passed, or whose request has
        ended, is reported as `Late`.
        """
        line = self._line
        if not isinstance(line, I2cLine):
            raise UnsupportedError("transactions have results on I2C only")
        transfer = line.finish()
        events = self.tick(now)  # may end the request of this transaction
        read = None if data is None else bytes(data)
        slot = next((each for each in self._slots if each.unit is transfer), None)
        if transfer is None or slot is None:
            return [*events, line.unawaited(transfer, read)]
        slot.unit = None
        if read is None:
            if not slot.is_polled:  # the node has not received the telecommand
                slot.owed.clear()
            return events + self._unanswered(now, slot)
        if not transfer.read:
            return events + self._written(now, slot)
        arrival = line.arrival(transfer, read)
        if not isinstance(arrival, Arrival):
            return [*events, arrival, *self._unanswered(now, slot)]
        poll, response = slot.awaited.exchange.poll, slot.awaited.matching(arrival)
        if response is None or (poll and not poll.until.of(arrival.content)):
            return events + self._unanswered(now, slot)
        return events + self._responded(now, slot, response, arrival)

    def _received(self, now: float, received: Any) -> list[Event]:
        events = self.tick(now)
        for arrival in self._line.arrivals(now, received, self._awaited):
            if isinstance(arrival, Arrival):
                events += self._arrived(now, arrival)
            else:
                events.append(arrival)
        return events

    def _awaited(self) -> Iterator[Awaited]:
        """Yield the responses that may arrive."""
        yield from (slot.awaited for slot in self._slots if slot.is_awaited)
        yield from (late.awaited for late in self._late)

    def _arrived(self, now: float, arrival: Arrival) -> list[Event]:
        """Process telemetry or a packet without a message."""
        for slot in self._slots:
            response = slot.awaited.matching(arrival)
            if response and slot.is_awaited:
                is_reply = response.verdict == "reply"
                if not is_reply or slot.kind in (None, arrival.type):
                    return self._responded(now, slot, response, arrival)
        for late in self._late:
            response = late.awaited.matching(arrival)
            if response:
                late.owed.remove(response.verdict_of(arrival.content))
                self._late = [entry for entry in self._late if entry.owed]
                return [Late(arrival.id, arrival.data, arrival.type)]
        return [arrival.unawaited]

    def _responded(
        self, now: float, slot: Slot, response: Response, arrival: Arrival
    ) -> list[Event]:
        """Process a response to a request."""
        verdict, content = response.verdict_of(arrival.content), arrival.content
        data, type, telemetry = arrival.data, arrival.type, response.telemetry
        id, handle = slot.plan.request.id, slot.handle
        slot.owed.remove(verdict)
        if verdict == "progress":
            slot.latest = max(slot.latest, min(now + slot.timeout, slot.limit))
            if slot.state == "wait":  # the pause of a busy device stays as it is
                slot.until = slot.latest
            return [Progress(id, data, type, handle)]
        if verdict in ("ack", "reply"):
            slot.missing -= {verdict}
            if slot.missing and verdict == "reply" and telemetry is not None:
                return [Reply(id, data, type, telemetry, handle)]
            if slot.missing:
                return [Progress(id, data, type, handle)]
            self._end(slot)
            return [Done(id, slot.attempts, data, type, telemetry, handle)]
        is_left = slot.attempts <= self.settings.retries
        if verdict == "again" and is_left and self._line.checks_telecommands:
            self._queue(slot)
            return []
        code = response.reason.of(content) if response.reason else None
        reason = next((name for value, name in response.reasons if value == code), None)
        if verdict == "busy" and is_left:
            slot.state, slot.until = "pause", now + self.settings.busy_pause
            return [Progress(id, data, type, handle)]
        self._end(slot)
        if verdict == "busy":
            return [Busy(id, slot.attempts, code, reason, handle)]
        detail = response.detail.of(content) if response.detail else None
        # The packets of framed links have a checksum: no refusal is damaged.
        is_damaged = bool(self.bus and response.reasons) and reason is None
        ended = id, slot.attempts, code, reason, detail, data, type, handle, is_damaged
        return [Refused(*ended)]

    def _begin(
        self,
        now: float,
        request: Request,
        reply: Optional[int] = None,
        kind: Optional[type[Message]] = None,
    ) -> None:
        plan = self._line.plan(request, reply)
        if self._max_requests is not None and len(self._slots) >= self._max_requests:
            raise BusyError("as many requests are going on as there may be")
        least, most = plan.lengths
        length = len(plan.request.data)
        if not least <= length <= most:
            nearest = most if length > most else least
            raise LengthError(f"telecommand {plan.sent.id}", nearest, length)
        self._line.check(plan.sent)
        self.begun += 1
        self._set_time(now)
        timeout = plan.awaited.exchange.timeout or self.settings.reply_timeout
        self._slots.append(Slot(self.begun, plan, timeout, kind))

    def _set_time(self, now: float) -> None:
        """Store the time, and drop responses that can no longer arrive."""
        self._now = now
        self._late = [late for late in self._late if now < late.until]

    def _queued(self) -> Optional[Slot]:
        """Return the oldest request that is to be sent."""
        return next((slot for slot in self._slots if slot.state == "queued"), None)

    def _transmit(self) -> Any:
        """Encode the next request that may be sent; return None without one."""
        slot, now = self._queued(), self._now
        if slot is None or not self._may_be_sent(slot):
            return None
        poll = slot.awaited.exchange.poll
        if poll and slot.is_polled:
            unit = self._line.encode(Request("telemetry", poll.telemetry))
        else:
            unit = self._line.encode(slot.plan.sent)
            slot.attempts += 1
            slot.awaited = slot.awaited.sent(self._line.header)
            slot.missing = slot.awaited.needed
            slot.owed.add_transmission()
            slot.latest = now + slot.timeout
            slot.limit = now + self.settings.progress_for
        slot.unit, slot.state, slot.until = unit, "wait", now + slot.timeout
        if not (slot.missing or self._line.has_results):
            slot.state, slot.until = "sent", now
        self._next_output = now + self.settings.gap
        return unit

    def _may_be_sent(self, slot: Slot) -> bool:
        """Return whether the device handles the request now, and no response to another
        request could be taken for a response to it.
        """
        if self._now < self._next_output:
            return False
        if not slot.awaited.responses or slot.is_polled:
            return True
        others = [other for other in self._slots if other is not slot]
        in_flight = sum(other.state in ("wait", "pause") for other in others)
        return (
            in_flight < self.settings.in_flight
            and not self._blocking(slot)
            and len(self._unfinished(slot)) < MOST_AWAITED
            and not any(map(slot.awaited.is_like, self._unfinished(slot)))
        )

    def _unfinished(self, slot: Slot) -> list[Awaited]:
        """Return the responses to other requests in progress.

        This includes requests that are to be sent again: otherwise one of these and this
        request could each wait until the other has ended.
        """
        return [
            each.awaited for each in self._slots if each is not slot and each.missing
        ]

    def _blocking(self, slot: Slot) -> list[LateResponses]:
        """Return the late responses that must arrive or expire before the request is
        sent.

        These are the late responses that the client could take for a response to the
        request. If the client can store no more late responses, all of them must arrive
        or expire.
        """
        if not slot.awaited.responses or slot.is_polled:
            return []
        is_full = len(self._unfinished(slot)) + len(self._late) >= MOST_AWAITED
        return [
            late for late in self._late if is_full or slot.awaited.is_like(late.awaited)
        ]

    def _expired(self, now: float, slot: Slot) -> list[Event]:
        """Process the end of the time of a state."""
        if slot.state == "sent":
            return [self._sent(slot)]
        if slot.state == "wait":
            return self._unanswered(now, slot)
        if slot.poll_end is not None and now >= slot.poll_end:
            return [self._timeout(slot)]
        slot.state = "queued"
        return []

    def _unanswered(self, now: float, slot: Slot) -> list[Event]:
        """Process a missing or unusable response: poll or send again, or end the
        request.
        """
        self._withdraw(slot)
        if slot.is_polled:
            is_left = slot.poll_end is not None and now < slot.poll_end
        else:
            is_left = slot.plan.repeats and slot.attempts <= self.settings.retries
        if not is_left:
            return [self._timeout(slot)]
        if not self._line.has_results:
            self._queue(slot)
            return []
        # A failure can be immediate here: give the node some time.
        slot.state, slot.until = "pause", now + self.settings.poll_interval
        if not slot.is_polled:
            slot.poll_end = now + self.settings.poll_timeout
        return []

    def _written(self, now: float, slot: Slot) -> list[Event]:
        """Process a telecommand that is transmitted: poll its response, if it has one."""
        if not slot.missing:
            return [self._sent(slot)]
        slot.is_polled = True
        slot.poll_end = slot.latest = now + self.settings.poll_timeout
        return self._unanswered(now, slot)

    def _queue(self, slot: Slot) -> None:
        """Send a request again, as soon as it may be sent."""
        slot.state, slot.is_polled, slot.poll_end = "queued", False, None

    def _sent(self, slot: Slot) -> Sent:
        self._end(slot)
        return Sent(slot.plan.request.id, slot.attempts, slot.handle)

    def _timeout(self, slot: Slot) -> Timeout:
        self._end(slot)
        return Timeout(slot.plan.request.id, slot.attempts, slot.handle)

    def _withdraw(self, slot: Slot) -> None:
        """Withdraw a transmission that was not taken: nothing responds to it."""
        if self._line.withdraw(slot.unit) and not slot.is_polled:
            slot.owed.clear()
        slot.unit = None

    def _end(self, slot: Slot) -> None:
        """End a request, and remember the responses that may still arrive."""
        self._withdraw(slot)
        self._slots.remove(slot)
        if slot.owed:
            # A response counts from the transmission or from progress, not from the end
            # of the request.
            until = slot.latest + self.settings.late
            if self._now < until:
                self._late.append(LateResponses(slot.awaited, slot.owed, until))


def _line_of(
    link: Link[Any],
    bus: Optional[Bus],
    checks: bool,
    address: int,
    values: Optional[Mapping[str, int]],
) -> Line:
    """Return the line of a client. Raise `UnsupportedError`."""
    if bus is None:
        if checks:
            raise UnsupportedError("the frames have the checksum, and leave no choice")
        return StreamLine(link, values)
    if values:
        raise UnsupportedError("only framed links have values to choose")
    if bus == "uart":
        return UartLine(link, checks)
    if bus == "can":
        return CanLine(link, checks, address)
    if bus == "i2c":
        return I2cLine(link, checks)
    raise UnsupportedError(f"a bus is 'uart', 'can' or 'i2c', not {bus!r}")
