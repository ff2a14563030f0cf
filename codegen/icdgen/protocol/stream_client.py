"""Client over a packet format of the ICD.

Requests with different telemetry responses run at the same time.

Reference implementation. Like `client.Client`, it is a state machine without clock and
I/O, and each call receives the time in milliseconds. Events are mappings: the events of
the decoder, ``done`` and ``timeout``. A ``message`` event is a message that no request
waits for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from icdgen.icd.model import TELECOMMAND, TELEMETRY
from icdgen.protocol import stream
from icdgen.protocol.client import HOLD, IDLE, WAIT, Event, Request
from icdgen.protocol.envelope import Stream, StreamRow
from icdgen.protocol.errors import BusyError, LengthError, UnknownIdError
from icdgen.protocol.facts import Facts, Unsupported, need
from icdgen.protocol.sections import Settings


@dataclass(slots=True, eq=False)
class Slot:
    """State of one request, and the previous request of the slot whose response may
    still arrive.
    """

    request: Request = field(default_factory=lambda: Request(TELECOMMAND, 0))
    state: str = IDLE
    sent: int = 0  # id of the telecommand
    reply: int | None = None
    attempts: int = 0
    until: int = 0  # end of the state in ms, unless an event ends it earlier
    was_taken: bool = False  # whether the caller took the message from `output`
    late: int | None = None  # id of telemetry that may still arrive
    late_until: int = 0


class Client:
    """Client with up to ``requests`` simultaneous requests."""

    def __init__(
        self, facts: Facts, requests: int, settings: Settings | None = None
    ) -> None:
        self.form: Stream = need(facts.stream, "stream")
        self.settings = settings or facts.client
        self._decoder = stream.Decoder(self.form, TELEMETRY)
        self._slots = [Slot() for _ in range(requests)]
        self._untaken: list[Slot] = []
        # Next sequence number, by id if `per_id`
        self._next: dict[int | None, int] = {}

    @property
    def deadline(self) -> int | None:
        """Latest time of the next call of `tick`; None if no call is needed."""
        return min(
            (slot.until for slot in self._slots if slot.state != IDLE), default=None
        )

    def start(self, now: int, request: Request) -> list[Event]:
        """Start a request.

        Raises `UnknownIdError`, `Unsupported`, `BusyError` and `LengthError`.
        """
        row = self._row(request)
        reply = request.id if request.kind == TELEMETRY else row.reply
        if request.reply is not None:
            reply = request.reply
            if all(row.id != reply for row in self.form.telemetry):
                raise UnknownIdError(f"no telemetry has the id {reply}")
        slot = self._free(reply)
        if not row.least <= len(request.data) <= row.most:
            raise LengthError(
                row.most if len(request.data) > row.most else row.least,
                len(request.data),
            )
        slot.request = replace(
            request, repeat=request.repeat or request.kind == TELEMETRY
        )
        slot.sent, slot.reply = row.id, reply
        slot.attempts, slot.was_taken = 0, False
        # A late response to a previous request could be taken for the response to this
        # one.
        late = [
            slot.late_until
            for slot in self._slots
            if slot.late is not None and slot.late == reply
        ]
        if now < max(late, default=now):
            slot.state, slot.until = HOLD, max(late)
            return []
        return list(self._transmit(now, slot))

    def output(self) -> list[bytes]:
        """Return the messages to send, each once."""
        taken, self._untaken = self._untaken, []
        for slot in taken:
            slot.was_taken = True
        return [self._line(slot) for slot in taken]

    def cancel(self, kind: str | None = None, id: int | None = None) -> None:
        """Cancel matching requests without an event, and their output that was not
        taken.

        Without arguments, cancel all requests.
        """
        for slot in self._slots:
            if kind in (None, slot.request.kind) and id in (None, slot.request.id):
                self._drop(slot)
                if slot.state != IDLE and slot.was_taken:
                    slot.late, slot.late_until = (
                        slot.reply,
                        slot.until + self.settings.reply_timeout,
                    )
                slot.state = IDLE

    def tick(self, now: int) -> list[Event]:
        """Process the passage of time."""
        events: list[Event] = []
        for slot in self._slots:
            if slot.state == IDLE or now < slot.until:
                continue
            if slot.state == HOLD or (
                slot.request.repeat and slot.attempts <= self.settings.retries
            ):
                events += self._transmit(now, slot)
            else:
                events.append(self._end(now, slot, "timeout"))
        return events

    def received(self, now: int, data: bytes) -> list[Event]:
        """Process the next bytes of the stream, or a packet."""
        return self.tick(now) + [
            self._event_of(now, event) for event in self._decoder.feed(data)
        ]

    def _event_of(self, now: int, event: stream.Event) -> Event:
        if event.event == stream.MESSAGE:
            for slot in self._slots:
                if slot.state == WAIT and slot.was_taken and slot.reply == event.id:
                    return self._end(now, slot, "done") | {
                        "reply": event.id,
                        "bytes": event.data.hex(),
                    }
        return event_row(event)

    def _row(self, request: Request) -> StreamRow:
        """Return the telecommand to send for a request."""
        id, rows = request.id, self.form.telecommands
        if request.kind == TELEMETRY:
            # Telemetry is requested by the telecommand without data whose reply it is.
            rows = tuple(row for row in rows if row.reply == id and row.least == 0)
            if not rows and any(row.id == id for row in self.form.telemetry):
                raise Unsupported(f"telemetry {id} is sent unasked")
        else:
            rows = tuple(row for row in rows if row.id == id)
        if not rows:
            raise UnknownIdError(f"there is no {request.kind} of id {id}")
        return rows[0]

    def _free(self, reply: int | None) -> Slot:
        """Return a free slot.

        Raises `BusyError` if all are in use or another request waits for the same
        reply.
        """
        if reply is not None and any(
            slot.state != IDLE and slot.reply == reply for slot in self._slots
        ):
            raise BusyError
        for slot in self._slots:
            if slot.state == IDLE and slot not in self._untaken:
                return slot
        raise BusyError

    def _transmit(self, now: int, slot: Slot) -> Iterator[Event]:
        """Send the request or repeat it."""
        slot.attempts += 1
        if slot not in self._untaken:
            self._untaken.append(slot)
        if slot.reply is None:
            slot.state = IDLE
            yield {"event": "done", "id": slot.request.id, "attempts": 1, "bytes": ""}
        else:
            slot.state, slot.until = WAIT, now + self.settings.reply_timeout

    def _end(self, now: int, slot: Slot, outcome: str) -> Event:
        slot.state = IDLE
        self._drop(slot)
        if slot.was_taken and (slot.attempts > 1 or outcome == "timeout"):
            slot.late, slot.late_until = slot.reply, now + self.settings.reply_timeout
        return {"event": outcome, "id": slot.request.id, "attempts": slot.attempts}

    def _drop(self, slot: Slot) -> None:
        if slot in self._untaken:
            self._untaken.remove(slot)

    def _line(self, slot: Slot) -> bytes:
        place, values = self.form.of("sequence"), {}
        if place:
            key = slot.sent if self.form.per_id else None
            values["sequence"] = number = self._next.get(key, place.values[0])
            self._next[key] = number + 1 & place.mask
        return stream.encode(
            self.form, TELECOMMAND, slot.sent, slot.request.data, values
        )


def event_row(event: stream.Event) -> Event:
    """Return an event of the decoder as a mapping."""
    row: dict[str, Any] = {"event": event.event}
    if event.id is not None:
        row["id"] = event.id
    if event.event == stream.MESSAGE:
        row |= {"bytes": event.data.hex(), **dict(event.values)}
    if event.event == stream.GAP:
        row["missing"] = event.missing
    return row
