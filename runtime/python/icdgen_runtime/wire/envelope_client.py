"""A client over a link whose messages travel in envelopes: it sends, listens, and asks where something answers."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Generic, Literal, Optional

from .._base import Message
from .._errors import LengthError, UnknownIdError
from .._hints import Buffer, KindOf, N, SpokenBy, class_of, message_of
from .client import Request
from .envelope import StreamRow
from .errors import BusyError, UnsupportedError, need
from .events import Arrived, Done, Event, Gap, LineError, Timeout
from .link import Link, Settings
from .sender import Sender
from .spoken import requested, sent
from .stream import StreamDecoder, StreamEvent


class EnvelopeClient(Generic[N]):
    """A client over a stream of bytes, or packets, with envelopes.

    It is told what happens and when, in milliseconds of any clock that never goes back:
    `received`, and `tick` at the latest at `deadline`. What is to be sent is taken from
    `output`, a message at a time.

    Telemetry that comes unasked is `Arrived`. A telecommand that the ICD names no reply to
    is `Done` when it is sent; another one when the reply has come. ``values``: of the fields
    of the envelope that the sender chooses, such as ``source``; see `Sender`.
    """

    def __init__(
        self,
        link: Link[N],
        settings: Optional[Settings] = None,
        values: Optional[Mapping[str, int]] = None,
    ) -> None:
        self.link = link
        self.settings = settings or link.settings
        self._form = need(link.stream, "stream")
        self._sender = Sender(link, "telecommand", values)
        self._decoder = StreamDecoder(link)
        self._output: deque[bytes] = deque()
        self._state: Literal["idle", "hold", "wait"] = "idle"
        self._asked = Request("telecommand", 0)
        self._sent = (0, b"")  # id and data of the telecommand that asks
        self._reply: Optional[int] = None  # id of the telemetry that is waited for
        self._kind: Optional[type[Message]] = None  # what it must be, if that was said
        self._attempts = 0
        self._until: float = 0
        self._late: Optional[tuple[int, float]] = None  # id that may still come

    @property
    def busy(self) -> bool:
        """Whether a request is going on."""
        return self._state != "idle"

    @property
    def deadline(self) -> Optional[float]:
        """When `tick` wants to be called at the latest; None: not at all."""
        return self._until if self.busy else None

    @property
    def discarded(self) -> int:
        """Bytes of the stream that became part of no message."""
        return self._decoder.discarded

    def request(self, now: float, message: KindOf[N, Message]) -> list[Event]:
        """Asks for telemetry, with the telecommand that the ICD names for it. See `start`."""
        request = Request("telemetry", requested(self.link, message))
        return self._begin(now, request, class_of(message))

    def send(
        self,
        now: float,
        message: SpokenBy[N],
        repeat: bool = False,
        reply: Optional[KindOf[N, Message]] = None,
    ) -> list[Event]:
        """Sends a telecommand. See `start`; also raises `RangeError`.

        ``reply``: the telemetry that answers it, where the ICD does not say so.
        """
        id, data = sent(self.link, message), message_of(message).to_bytes()
        request = Request("telecommand", id, data, repeat)
        if reply is None:
            return self._begin(now, request)
        requested(self.link, reply)
        return self._begin(now, request, class_of(reply))

    def start(self, now: float, request: Request) -> list[Event]:
        """Begins a request.

        Raises `UnknownIdError`, `LengthError`, `BusyError` while another one is going on or
        its output has not been taken, and `UnsupportedError` for telemetry that no
        telecommand without parameters is answered with.
        """
        return self._begin(now, request)

    def output(self) -> bytes:
        """The next message to be sent, once; nothing if there is none."""
        return self._output.popleft() if self._output else b""

    def cancel(self) -> None:
        """Gives up the request, without an event, and what of it was not taken."""
        self._output.clear()
        if self._attempts and self._reply is not None and self.busy:
            self._late = self._reply, self._until + self.settings.reply_timeout
        self._state = "idle"

    def tick(self, now: float) -> list[Event]:
        """Lets time pass."""
        if not self.busy or now < self._until:
            return []
        if self._state == "hold":
            return self._transmit(now)
        if self._asked.repeat and self._attempts <= self.settings.retries:
            return self._transmit(now)
        self._end(now, True)
        return [Timeout(self._asked.id, self._attempts)]

    def received(self, now: float, data: Buffer) -> list[Event]:
        """The next bytes of the stream, or a packet."""
        events = self.tick(now)
        for found in self._decoder.feed(data):
            events.append(self._found(now, found))
        return events

    def _found(self, now: float, found: StreamEvent) -> Event:
        if found.event == "gap":
            return Gap(found.id, found.missing)
        if found.event != "message" or found.id is None:
            return LineError(found.event, found.id)
        is_awaited = self._state == "wait" and found.id == self._reply
        if is_awaited and self._kind in (None, found.kind):
            self._end(now, self._attempts > 1)
            return Done(self._asked.id, self._attempts, found.data, found.kind)
        return Arrived(found.id, found.data, found.values, found.kind)

    def _begin(
        self, now: float, request: Request, kind: Optional[type[Message]] = None
    ) -> list[Event]:
        row = self._row(request)
        if self.busy or self._output:
            raise BusyError("a request is going on")
        if request.kind == "telemetry":
            request = Request("telemetry", request.id, b"", True)
        elif not row.least <= len(request.data) <= row.most:
            nearest = row.most if len(request.data) > row.most else row.least
            raise LengthError(f"telecommand {row.id}", nearest, len(request.data))
        self._asked, self._attempts = request, 0
        self._sent = row.id, request.data
        self._kind, self._reply = kind, kind.IDS[-1] if kind else row.reply
        if self._late and self._late[0] == self._reply and now < self._late[1]:
            self._state, self._until = "hold", self._late[1]
            return []
        return self._transmit(now)

    def _row(self, request: Request) -> StreamRow:
        """The telecommand that is sent."""
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

    def _transmit(self, now: float) -> list[Event]:
        """Sends the request, for the first time or again."""
        self._attempts += 1
        self._output.append(self._sender.encode(*self._sent))
        if self._reply is None:
            self._end(now, False)
            return [Done(self._asked.id, self._attempts)]
        self._state, self._until = "wait", now + self.settings.reply_timeout
        return []

    def _end(self, now: float, may_be_answered_again: bool) -> None:
        self._state, self._late = "idle", None
        if may_be_answered_again and self._reply is not None:
            self._late = self._reply, now + self.settings.reply_timeout
