"""Client for messages with header and trailer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Generic, Literal, NamedTuple, Optional

from .._base import Message
from .._errors import LengthError, UnknownIdError
from .._hints import Buffer, N
from .client import MOST_AWAITED, Request
from .envelope import (
    Direction,
    Exchange,
    PacketForm,
    Response,
    StreamRow,
    TelemetryRequest,
    Verdict,
)
from .errors import BusyError, UnsupportedError, need
from .events import (
    Arrived,
    Busy,
    Done,
    Event,
    Gap,
    Late,
    LineError,
    Progress,
    Refused,
    Reply,
    Sent,
    Stray,
    Timeout,
)
from .link import Link, Settings
from .message_ids import (
    NodeMessage,
    NodeMessageClass,
    class_of,
    message_of,
    requested_id,
    sent_id,
)
from .sender import Sender
from .stream import StreamDecoder, StreamEvent

_NO_EXCHANGE = Exchange((), ())
_NEEDED: tuple[Verdict, ...] = ("ack", "reply")


Arrival = tuple[Optional[int], Optional[int]]
"""Id of telemetry and index of a packet without a message; one of them is None."""


class _Awaited(NamedTuple):
    """Responses to a request: what can arrive, and the numbers that it must repeat."""

    responses: tuple[Response, ...]
    sources: tuple[Optional[int], ...]
    """Numbers of what is sent. Those in its header are known when it was sent."""
    exchange: Exchange
    nameless: Optional[StreamRow] = None
    """Expected telemetry that a packet without its id carries."""

    def sent(self, header: bytes) -> _Awaited:
        """Return the responses to a packet that was sent with this header."""
        if not self.exchange.in_header:
            return self
        plain = self.sources[: -self.exchange.in_header]
        return self._replace(sources=(*plain, *self.exchange.numbers_in(header)))

    def _is_in_message(self, source: int) -> bool:
        """Return whether a number is in id and data, so that it is known before it is
        sent.
        """
        return source < len(self.sources) - self.exchange.in_header

    @property
    def needed(self) -> frozenset[Verdict]:
        """Return the responses without which a request is not done."""
        return frozenset(
            verdict
            for verdict in _NEEDED
            if any(response.can_be(verdict) for response in self.responses)
        )

    def matching(self, arrival: Arrival, data: bytes) -> Optional[Response]:
        """Return the response that telemetry or a packet is; None if it is none of
        them.
        """
        for response in self.responses:
            if (response.telemetry, response.packet) == arrival and all(
                echo.place.of(data) == self.sources[echo.source]
                for echo in response.echoes
            ):
                return response
        return None

    def is_like(self, other: _Awaited) -> bool:
        """Return whether a response to one request could be taken for a response to the
        other.
        """
        if self.nameless and other.nameless:
            return True
        return any(
            (mine.telemetry, mine.packet) == (theirs.telemetry, theirs.packet)
            and not any(
                echo.place == repeated.place
                and self._is_in_message(echo.source)
                and other._is_in_message(repeated.source)
                and self.sources[echo.source] != other.sources[repeated.source]
                for echo in mine.echoes
                for repeated in theirs.echoes
            )
            for mine in self.responses
            for theirs in other.responses
        )


class _Owed:
    """Numbers of responses that may still arrive, for each needed verdict.

    One number for all verdicts would not do: an acknowledge that comes twice would
    count as the reply that is still missing.
    """

    def __init__(self, needed: frozenset[Verdict]) -> None:
        self._numbers = dict.fromkeys(needed, 0)

    def __bool__(self) -> bool:
        return any(self._numbers.values())

    def add_transmission(self) -> None:
        """Count the responses to one more transmission."""
        for verdict in self._numbers:
            self._numbers[verdict] += 1

    def remove(self, received: Verdict) -> None:
        """Count off what has arrived: a refusal replaces all responses."""
        if received == "progress":
            return
        for verdict, number in self._numbers.items():
            if number and (received == verdict or received not in _NEEDED):
                self._numbers[verdict] = number - 1


@dataclass(eq=False)
class _Slot:
    """A request in progress."""

    handle: int
    request: Request
    sent_id: Optional[int]  # of the telecommand; None: the request of telemetry
    awaited: _Awaited
    timeout: float
    repeats: bool  # whether it may be sent again after a time-out
    kind: Optional[type[Message]]  # class of the reply, if the caller gave it
    # "sent": nothing responds to it; "wait": for a response; "pause": the device is busy
    state: Literal["queued", "sent", "wait", "pause"] = "queued"
    attempts: int = 0
    until: float = 0  # end of the state
    latest: float = 0  # until when a response is in time
    limit: float = 0  # until when progress extends `latest`
    missing: frozenset[Verdict] = frozenset()
    owed: _Owed = field(init=False)

    def __post_init__(self) -> None:
        self.owed = _Owed(self.awaited.needed)

    @property
    def is_awaited(self) -> bool:
        """Whether a response may arrive, also to an earlier attempt."""
        return self.state == "wait" or bool(self.owed)


@dataclass(eq=False)
class _Late:
    """Responses that may still arrive although their request has ended."""

    awaited: _Awaited
    owed: _Owed
    until: float


class EnvelopeClient(Generic[N]):
    """A client for messages with header and trailer, in a stream or in packets.

    Pass received data to `received`, and call `tick` at `deadline` at the latest. After
    each call, take the data to send from `output`, one message at a time. Times are in
    milliseconds of any monotonic clock.

    Requests are sent in the order in which they began. A request waits while as many
    are in progress as the device handles, or while a response to another request could
    be taken for a response to it.

    Every request ends with one outcome: `Sent` if nothing responds to it, otherwise
    `Done`, `Refused`, `Busy` or `Timeout`. Unsolicited telemetry is reported as
    `Arrived`, a response to a request that has ended as `Late`, any other response as
    `Stray`.

    ``values``: values of the frame fields that the sender chooses, such as ``source``;
    see `Sender`. ``requests``: largest number of requests in progress and waiting.
    """

    def __init__(
        self,
        link: Link[N],
        settings: Optional[Settings] = None,
        values: Optional[Mapping[str, int]] = None,
        requests: Optional[int] = None,
    ) -> None:
        self.link = link
        self.settings = settings or link.settings
        self._form = need(link.stream, "stream")
        self._sender = Sender(link, "telecommand", values)
        self._decoder = StreamDecoder(link)
        self._max_requests = requests
        self.begun = 0
        """Handle of the last request."""
        self._slots: list[_Slot] = []  # in the order in which they began
        self._late: list[_Late] = []
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
        if self._queued():
            # It may be possible to send the request then.
            ends = [self._next_output, *(late.until for late in self._late)]
            times += [end for end in ends if end > self._now]
        return min(times, default=None)

    @property
    def discarded(self) -> int:
        """Number of received bytes that are not part of a message."""
        return self._decoder.discarded

    def request(self, now: float, message: NodeMessageClass[N, Message]) -> list[Event]:
        """Request telemetry by the telecommand that it replies to. See `start`."""
        request = Request("telemetry", requested_id(self.link, message))
        return self._begin(now, request, kind=class_of(message))

    def send(
        self,
        now: float,
        message: NodeMessage[N],
        repeat: bool = False,
        reply: Optional[NodeMessageClass[N, Message]] = None,
    ) -> list[Event]:
        """Send a telecommand. See `start`; also raise `RangeError`.

        ``reply``: class of the reply, if the ICD does not specify one.
        """
        id, data = sent_id(self.link, message), message_of(message).to_bytes()
        request = Request("telecommand", id, data, repeat)
        if reply is None:
            return self._begin(now, request)
        return self._begin(
            now, request, requested_id(self.link, reply), class_of(reply)
        )

    def start(
        self, now: float, request: Request, reply: Optional[int] = None
    ) -> list[Event]:
        """Start a request. ``reply`` is the id of the reply to a telecommand.

        Raise `UnknownIdError` and `LengthError`. Raise `BusyError` if there are too
        many requests. Raise `UnsupportedError` for telemetry that no telecommand
        without values requests.
        """
        return self._begin(now, request, reply)

    def output(self) -> bytes:
        """Return the next encoded message to send, or no bytes.

        Its times count from the previous call of another method.
        """
        slot, now = self._queued(), self._now
        if slot is None or not self._may_be_sent(slot):
            return b""
        if slot.sent_id is None:
            line = self._sender.encode_request(slot.request.id)
        else:
            line = self._sender.encode(slot.sent_id, slot.request.data)
        slot.attempts += 1
        slot.awaited = slot.awaited.sent(self._sender.header)
        slot.missing = slot.awaited.needed
        slot.owed.add_transmission()
        slot.state = "wait" if slot.missing else "sent"
        slot.until = slot.latest = now + slot.timeout if slot.missing else now
        slot.limit = now + self.settings.progress_for
        self._next_output = now + self.settings.gap
        return line

    def sent(self, handle: int) -> Optional[Sent]:
        """End a request that was sent and that nothing responds to, without waiting for
        `tick`. Return None for any other request.
        """
        for slot in self._slots:
            if slot.handle == handle and slot.state == "sent":
                self._end(slot)
                return Sent(slot.request.id, slot.attempts, handle)
        return None

    def cancel(
        self,
        kind: Optional[Direction] = None,
        id: Optional[int] = None,
        handle: Optional[int] = None,
    ) -> None:
        """Cancel a request, or all, without an event.

        ``handle``: only the request of this handle.
        """
        for slot in [*self._slots]:
            is_meant = kind in (None, slot.request.kind) and id in (
                None,
                slot.request.id,
            )
            if is_meant and handle in (None, slot.handle):
                self._end(slot)

    def tick(self, now: float) -> list[Event]:
        """Process timeouts. Call at `deadline` (in ms) at the latest."""
        self._set_time(now)
        events: list[Event] = []
        for slot in [*self._slots]:
            if slot.state == "queued" or now < slot.until:
                continue
            is_left = slot.repeats and slot.attempts <= self.settings.retries
            if slot.state == "pause" or (slot.state == "wait" and is_left):
                slot.state = "queued"
                continue
            self._end(slot)
            event = Sent if slot.state == "sent" else Timeout
            events.append(event(slot.request.id, slot.attempts, slot.handle))
        return events

    def received(self, now: float, data: Buffer) -> list[Event]:
        """Process received bytes: a piece of the stream, or one packet."""
        events = self.tick(now)
        for event in self._decoder.feed(data):
            events.append(self._event_of(now, event))
        return events

    def _event_of(self, now: float, event: StreamEvent) -> Event:
        if event.event == "gap":
            return Gap(event.id, event.missing)
        event = self._identified(event)
        if event.event not in ("message", "packet") or event.id is None:
            return LineError(event.event, event.id)
        id, data, kind = event.id, event.data, event.kind
        arrival: Arrival = (
            (None, event.packet) if event.packet is not None else (id, None)
        )
        for slot in self._slots:
            response = slot.awaited.matching(arrival, data)
            if response and slot.is_awaited:
                is_reply = response.verdict == "reply"
                if not is_reply or slot.kind in (None, kind):
                    return self._responded(now, slot, response, event)
        for late in self._late:
            response = late.awaited.matching(arrival, data)
            if response:
                late.owed.remove(response.verdict_of(data))
                self._late = [entry for entry in self._late if entry.owed]
                return Late(id, data, kind)
        if event.packet is not None or id in self._form.confirming:
            return Stray(data, id, kind)
        return Arrived(id, data, event.values, kind)

    def _identified(self, event: StreamEvent) -> StreamEvent:
        """Return the telemetry that a packet without its id carries: that of the request
        whose response it can be. If it has the length of none, return this error.
        Return any other event, and the packet if no response is awaited, unchanged.
        """
        if event.packet is None:
            return event
        packet = self._form.packets[event.packet]
        if packet.content != "requested":
            return event
        data = event.data[packet.header_bytes : -packet.trailer_bytes or None]
        awaited = [slot.awaited for slot in self._slots if slot.is_awaited]
        awaited += [late.awaited for late in self._late]
        rows = [each.nameless for each in awaited if each.nameless]
        for row in rows:
            if row.least <= len(data) <= row.most:
                kind = self.link.TELEMETRY.which(row.id, bytes(data))
                return StreamEvent(
                    "message", row.id, data, event.values, event.missing, kind
                )
        return StreamEvent("length", rows[0].id) if rows else event

    def _responded(
        self, now: float, slot: _Slot, response: Response, event: StreamEvent
    ) -> Event:
        """Process a response to a request."""
        verdict, data = response.verdict_of(event.data), event.data
        id, response_id, handle = slot.request.id, response.telemetry, slot.handle
        slot.owed.remove(verdict)
        if verdict == "progress":
            slot.latest = max(slot.latest, min(now + slot.timeout, slot.limit))
            if slot.state == "wait":  # the pause of a busy device stays as it is
                slot.until = slot.latest
            return Progress(id, data, event.kind, handle)
        if verdict in ("ack", "reply"):
            slot.missing -= {verdict}
            if slot.missing and verdict == "reply" and response_id is not None:
                return Reply(id, data, event.kind, response_id, handle)
            if slot.missing:
                return Progress(id, data, event.kind, handle)
            self._end(slot)
            return Done(id, slot.attempts, data, event.kind, response_id, handle)
        code = response.reason.of(data) if response.reason else None
        reason = next((name for value, name in response.reasons if value == code), None)
        if verdict == "busy":
            if slot.attempts <= self.settings.retries:
                slot.state, slot.until = "pause", now + self.settings.busy_pause
                return Progress(id, data, event.kind, handle)
            self._end(slot)
            return Busy(id, slot.attempts, code, reason, handle)
        self._end(slot)
        return Refused(id, slot.attempts, code, reason, None, data, event.kind, handle)

    def _begin(
        self,
        now: float,
        request: Request,
        reply: Optional[int] = None,
        kind: Optional[type[Message]] = None,
    ) -> list[Event]:
        row = self._row(request)
        if request.kind == "telemetry":
            size = row.least if row else self._requesting_packet().reserved
            request = Request("telemetry", request.id, bytes(size), True)
        elif reply is not None and self._form.row("telemetry", reply) is None:
            raise UnknownIdError(self.link.node, "telemetry", reply)
        if self._max_requests is not None and len(self._slots) >= self._max_requests:
            raise BusyError("as many requests are going on as there may be")
        if row and not row.least <= len(request.data) <= row.most:
            nearest = row.most if len(request.data) > row.most else row.least
            raise LengthError(f"telecommand {row.id}", nearest, len(request.data))
        exchange_index = row.exchange if row else self._request_form().exchange
        exchange = (
            _NO_EXCHANGE
            if exchange_index is None
            else self._form.exchanges[exchange_index]
        )
        responses = exchange.responses
        if row is None:
            responses = tuple(
                (
                    each._replace(telemetry=request.id)
                    if (each.telemetry, each.packet) == (None, None)
                    else each
                )
                for each in responses
            )
        replies = [each for each in responses if each.can_be("reply")]
        if reply is not None and all(each.telemetry != reply for each in replies):
            others = (each for each in responses if each not in replies)
            responses = (*others, Response(reply, "reply"))
        sent_id = row.id if row else request.id
        nameless = self._nameless(reply if row else request.id)
        telecommand = sent_id.to_bytes(4, "big") + request.data
        unknown = [None] * exchange.in_header
        sources = (*exchange.numbers(telecommand), *unknown)
        self.begun += 1
        self._set_time(now)
        self._slots.append(
            _Slot(
                self.begun,
                request,
                row.id if row else None,
                _Awaited(responses, sources, exchange, nameless),
                exchange.timeout or self.settings.reply_timeout,
                request.repeat or (row is not None and row.repeats),
                kind,
            )
        )
        return []

    def _row(self, request: Request) -> Optional[StreamRow]:
        """Return the telecommand that is sent; None for a request of telemetry by a
        packet.
        """
        rows, id = self._form.telecommands, request.id
        if request.kind == "telecommand":
            row = next((row for row in rows if row.id == id), None)
        else:
            row = next((row for row in rows if row.requests == id), None)
            telemetry = self._form.row("telemetry", id)
            if row is None and telemetry and telemetry.is_requested:
                return None
            if row is None and telemetry:
                what = "is sent unasked: nothing requests it without values"
                raise UnsupportedError(f"telemetry {id} {what}")
        if row is None:
            raise UnknownIdError(self.link.node, request.kind, id)
        return row

    def _nameless(self, telemetry: Optional[int]) -> Optional[StreamRow]:
        """Return telemetry that a packet without its id carries; None for any other."""
        for row in self._form.telemetry:
            if row.id == telemetry:
                content = self._form.packets[row.packet].content
                return row if content == "requested" else None
        return None

    def _request_form(self) -> TelemetryRequest:
        return need(self._form.request, "requests")

    def _requesting_packet(self) -> PacketForm:
        return self._form.packets[self._request_form().packet]

    def _set_time(self, now: float) -> None:
        """Store the time, and drop responses that can no longer arrive."""
        self._now = now
        self._late = [late for late in self._late if now < late.until]

    def _queued(self) -> Optional[_Slot]:
        """Return the oldest request that is to be sent."""
        return next((slot for slot in self._slots if slot.state == "queued"), None)

    def _may_be_sent(self, slot: _Slot) -> bool:
        """Return whether the device handles the request now, and no response to another
        request could be taken for a response to it.
        """
        if self._now < self._next_output:
            return False
        if not slot.awaited.responses:
            return True
        others = [other for other in self._slots if other is not slot]
        in_flight = sum(other.state in ("wait", "pause") for other in others)
        # Also requests that are to be sent again: otherwise one of these and this
        # request could each wait until the other has ended.
        awaited = [other.awaited for other in others if other.missing]
        awaited += [late.awaited for late in self._late]
        return (
            in_flight < self.settings.in_flight
            and len(awaited) < MOST_AWAITED
            and not any(map(slot.awaited.is_like, awaited))
        )

    def _end(self, slot: _Slot) -> None:
        """End a request, and remember the responses that may still arrive."""
        self._slots.remove(slot)
        if slot.owed:
            # A response counts from the transmission or from progress, not from the end
            # of the request.
            until = slot.latest + self.settings.late
            if self._now < until:
                self._late.append(_Late(slot.awaited, slot.owed, until))
