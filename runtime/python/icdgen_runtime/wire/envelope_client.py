"""Client for messages with header and trailer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, Literal, Optional

from .._base import Message
from .._errors import LengthError, UnknownIdError
from .._hints import Buffer, N
from .client import Request
from .envelope import Direction, StreamRow
from .errors import BusyError, UnsupportedError, need
from .events import Arrived, Done, Event, Gap, LineError, Timeout
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

_NO_REQUEST = Request("telecommand", 0)


@dataclass(eq=False)
class _Slot:
    """A request, and the previous request if its reply may still arrive."""

    request: Request = _NO_REQUEST
    state: Literal["idle", "hold", "wait"] = "idle"
    sent: int = 0  # id of the telecommand
    reply: Optional[int] = None  # id of the expected reply
    kind: Optional[type[Message]] = None  # class of the expected reply, if given
    attempts: int = 0
    until: float = 0
    was_taken: bool = False  # by `output`
    late: Optional[tuple[int, float]] = None  # reply that may still arrive, until when


class EnvelopeClient(Generic[N]):
    """A client for messages with header and trailer, in a stream or in packets.

    Pass received data to `received`, and call `tick` at `deadline` at the latest. Take
    the data to send from `output`, one message at a time. Times are in milliseconds of
    any monotonic clock.

    Unsolicited telemetry is reported as `Arrived`. A telecommand without a reply in the
    ICD is `Done` when it is sent, any other when its reply has arrived. Replies are
    assigned to requests by their ids. Up to ``requests`` requests with different
    replies may be in progress at once.

    ``values``: values of the frame fields that the sender chooses, such as ``source``;
    see `Sender`.
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
        self.begun: Optional[int] = None
        """Id of the reply to the last request; None if it has none."""
        self._slots: list[_Slot] = []
        self._unsent: list[_Slot] = []

    @property
    def busy(self) -> bool:
        """Whether a request is in progress."""
        return any(slot.state != "idle" for slot in self._slots)

    @property
    def deadline(self) -> Optional[float]:
        """Time in ms at which `tick` must be called at the latest; None if idle."""
        ends = (slot.until for slot in self._slots if slot.state != "idle")
        return min(ends, default=None)

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

        Raise `UnknownIdError` and `LengthError`. Raise `BusyError` if another request
        waits for that reply, or if there are too many requests. Raise
        `UnsupportedError` for telemetry that is not the reply to a telecommand without
        parameters.
        """
        return self._begin(now, request, reply)

    def output(self) -> bytes:
        """Return the next encoded message to send, or no bytes."""
        if not self._unsent:
            return b""
        slot = self._unsent.pop(0)
        slot.was_taken = True
        return self._sender.encode(slot.sent, slot.request.data)

    def cancel(
        self,
        kind: Optional[Direction] = None,
        id: Optional[int] = None,
        reply: Optional[int] = None,
    ) -> None:
        """Cancel a request, or all, without an event; drop the remaining output.

        ``reply``: only the request that waits for telemetry of that id.
        """
        for slot in self._slots:
            is_meant = kind in (None, slot.request.kind) and id in (
                None,
                slot.request.id,
            )
            if is_meant and reply in (None, slot.reply):
                self._drop(slot)
                if slot.state != "idle":
                    self._remember(slot, slot.until)
                slot.state = "idle"

    def tick(self, now: float) -> list[Event]:
        """Process timeouts. Call at `deadline` (in ms) at the latest."""
        events: list[Event] = []
        for slot in self._slots:
            if slot.state == "idle" or now < slot.until:
                continue
            is_left = slot.request.repeat and slot.attempts <= self.settings.retries
            if slot.state == "hold" or is_left:
                events += self._transmit(now, slot)
            else:
                self._end(now, slot, True)
                events.append(Timeout(slot.request.id, slot.attempts, slot.reply))
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
        if event.event != "message" or event.id is None:
            return LineError(event.event, event.id)
        for slot in self._slots:
            is_asked = slot.state == "wait" and slot.was_taken
            is_awaited = is_asked and slot.reply == event.id
            if is_awaited and slot.kind in (None, event.kind):
                self._end(now, slot, slot.attempts > 1)
                id, attempts = slot.request.id, slot.attempts
                return Done(id, attempts, event.data, event.kind, event.id)
        return Arrived(event.id, event.data, event.values, event.kind)

    def _begin(
        self,
        now: float,
        request: Request,
        reply: Optional[int] = None,
        kind: Optional[type[Message]] = None,
    ) -> list[Event]:
        row = self._row(request)
        if request.kind == "telemetry":
            reply, request = request.id, Request("telemetry", request.id, b"", True)
        elif reply is None:
            reply = row.reply
        elif all(entry.id != reply for entry in self._form.telemetry):
            raise UnknownIdError(self.link.node, "telemetry", reply)
        slot = self._free_slot(reply)
        if not row.least <= len(request.data) <= row.most:
            nearest = row.most if len(request.data) > row.most else row.least
            raise LengthError(f"telecommand {row.id}", nearest, len(request.data))
        slot.request, slot.sent, slot.reply, slot.kind = request, row.id, reply, kind
        slot.attempts, slot.was_taken = 0, False
        self.begun = reply
        late = [
            entry.late[1]
            for entry in self._slots
            if entry.late and entry.late[0] == reply
        ]
        if now < max(late, default=now):
            slot.state, slot.until = "hold", max(late)
            return []
        return self._transmit(now, slot)

    def _row(self, request: Request) -> StreamRow:
        """Return the telecommand that is sent."""
        rows, id = self._form.telecommands, request.id
        if request.kind == "telecommand":
            row = next((row for row in rows if row.id == id), None)
        elif any(row.id == id for row in self._form.telemetry):
            asking = (row for row in rows if row.reply == id and row.least == 0)
            row = next(asking, None)
            if row is None:
                what = "is sent unasked: no telecommand without parameters asks for it"
                raise UnsupportedError(f"telemetry {id} {what}")
        else:
            row = None
        if row is None:
            raise UnknownIdError(self.link.node, request.kind, id)
        return row

    def _free_slot(self, reply: Optional[int]) -> _Slot:
        """Return a slot for a request whose reply no other request waits for."""
        waiting = (slot.reply for slot in self._slots if slot.state != "idle")
        if reply is not None and reply in waiting:
            raise BusyError(f"a request waits for telemetry {reply} already")
        for slot in self._slots:
            if slot.state == "idle" and slot not in self._unsent:
                return slot
        if self._max_requests is not None and len(self._slots) >= self._max_requests:
            raise BusyError("as many requests are going on as there may be")
        self._slots.append(_Slot())
        return self._slots[-1]

    def _transmit(self, now: float, slot: _Slot) -> list[Event]:
        """Send the request, for the first time or again."""
        slot.attempts += 1
        if slot not in self._unsent:
            self._unsent.append(slot)
        if slot.reply is None:
            slot.state = "idle"
            return [Done(slot.request.id, slot.attempts)]
        slot.state, slot.until = "wait", now + self.settings.reply_timeout
        return []

    def _end(self, now: float, slot: _Slot, may_be_answered_again: bool) -> None:
        slot.state = "idle"
        self._drop(slot)
        if may_be_answered_again:
            self._remember(slot, now)

    def _drop(self, slot: _Slot) -> None:
        """Drop the remaining output."""
        if slot in self._unsent:
            self._unsent.remove(slot)

    def _remember(self, slot: _Slot, since: float) -> None:
        """Remember that the reply may still arrive, or arrive again."""
        if slot.was_taken and slot.reply is not None:
            slot.late = slot.reply, since + self.settings.reply_timeout
