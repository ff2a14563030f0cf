"""Client over asyncio streams.

`AsyncSession` adds two streams and a clock to `client`, and waits until a request has
ended, while other tasks use the same session. `session` has the same for threads.
"""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple, Optional, TypeVar, overload

from .._base import Message
from .._hints import N
from .awaited import Request
from .events import Arrived, Event, Lost, Outcome, OutcomeOf
from .exchanges import (
    Exchange,
    Exchanges,
    P,
    Progress,
    T,
    client_of,
    data_of,
    executed,
    outcome_of,
)
from .link import Link, Settings
from .message_ids import M, NodeMessage, NodeMessageClass, class_of, message_of

_PIECE = 4096  # maximum bytes of a read
B = TypeVar("B", bound="_Box")


class _Locks(NamedTuple):
    read: asyncio.Lock
    write: asyncio.Lock


class _Box:
    """Events that any reading task has read for one task."""

    def __init__(self) -> None:
        self._events: deque[Event] = deque()

    def __bool__(self) -> bool:
        return bool(self._events)

    def add(self, event: Event) -> None:
        self._events.append(event)

    def take(self) -> list[Event]:
        """Remove all events and return them."""
        events = [*self._events]
        self._events.clear()
        return events


class _MessageBox(_Box):
    """The last ``limit`` unsolicited messages of these classes."""

    def __init__(self, kinds: tuple[object, ...], limit: int) -> None:
        super().__init__()
        self._kinds, self._limit, self._lost = kinds, limit, 0

    def add(self, event: Event) -> None:
        if isinstance(event, Arrived) and (
            not self._kinds or event.type in self._kinds
        ):
            super().add(event)
        if len(self._events) > self._limit:
            self._events.popleft()
            self._lost += 1

    def take_lost(self) -> int:
        """Return the number of messages lost since the previous call."""
        lost, self._lost = self._lost, 0
        return lost


class AsyncSession(Exchanges[N]):
    """Client over a byte stream: `Session` for asyncio.

    The application opens the streams, with `asyncio.open_connection` or a serial port
    (pyserial-asyncio). Their exceptions end the request, and so does its cancellation.
    `ConnectionResetError` reports that the other side closed the connection.

    Several tasks may send requests and receive messages. As many requests run
    concurrently as the device handles at a time, if their replies differ. Other requests
    wait for each other.

    ``clock`` returns seconds. ``on_event`` is called with each unsolicited event.
    ``values``: see `Session`.
    """

    def __init__(
        self,
        link: Link[N],
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        crc: bool = False,
        settings: Optional[Settings] = None,
        on_event: Optional[Callable[[Event], object]] = None,
        clock: Callable[[], float] = time.monotonic,
        values: Optional[Mapping[str, int]] = None,
    ) -> None:
        super().__init__(
            client_of(link, "uart", crc, settings, values), on_event, clock
        )
        self._reader, self._writer = reader, writer
        self._locks: Optional[_Locks] = None
        self._boxes: dict[object, _Box] = {}  # events by waiting task
        self._read_before: Optional[asyncio.Future[bytes]] = None

    async def get(self, message: NodeMessageClass[N, M]) -> M:
        """Request telemetry or read a configuration.

        Raise `RefusedError`, `ReplyTimeoutError` and the exceptions of
        `Client.request`.
        """
        outcome = await self._run(self._exchange(self.client.request, message))
        return class_of(message).from_bytes(data_of(outcome, class_of(message).NAME))

    async def ask(self, message: NodeMessageClass[N, M]) -> OutcomeOf[M]:
        """Request telemetry or read a configuration; return the outcome.

        Raise the exceptions of `Client.request`.
        """
        outcome = await self._run(self._exchange(self.client.request, message))
        return outcome_of(outcome, class_of(message))

    async def send(self, message: NodeMessage[N], repeat: bool = False) -> None:
        """Send a telecommand or set a configuration.

        Raise as `get` and `Client.send`.
        """
        outcome = await self._run(self._exchange(self.client.send, message, repeat))
        executed(outcome, message_of(message).NAME)

    async def answer(
        self,
        message: NodeMessage[N],
        reply: NodeMessageClass[N, M],
        repeat: bool = False,
    ) -> M:
        """Send a telecommand (on a framed link) and return its reply.

        Raise as `get` and `Client.send`.
        """
        outcome = await self._run(
            self._exchange(self.client.send, message, repeat, reply)
        )
        name = message_of(message).NAME
        return class_of(reply).from_bytes(data_of(outcome, name))

    @overload
    def messages(
        self, *, seconds: Optional[float] = None, limit: int = 1000
    ) -> AsyncIterator[Message]: ...

    @overload
    def messages(
        self,
        kind: NodeMessageClass[N, M],
        /,
        *more_kinds: NodeMessageClass[N, M],
        seconds: Optional[float] = None,
        limit: int = 1000,
    ) -> AsyncIterator[M]: ...

    async def messages(
        self,
        *kinds: NodeMessageClass[N, Message],
        seconds: Optional[float] = None,
        limit: int = 1000,
    ) -> AsyncIterator[Message]:
        """Iterate over unsolicited messages, without end or for this number of seconds.

        ``kinds`` selects message classes; without it, all are returned. Other events
        are passed to ``on_event``.

        While the program processes a message, other tasks may receive more messages.
        The session stores the last ``limit`` of them. It drops older messages, and
        passes `Lost` to ``on_event``.
        """
        end = None if seconds is None else self._now() + 1000 * seconds
        with self._box(_MessageBox(kinds, limit)) as box:
            while end is None or self._now() < end:
                events = await self._next(box, end)
                if lost := box.take_lost():
                    self._report(Lost(lost))
                for message in self._messages_in(events, kinds):
                    yield message

    async def start(self, request: Request) -> Outcome:
        """Send any request and return its outcome. Raise as `Client.start`."""
        return await self._run(self._exchange(self.client.start, request))

    async def run(self, procedure: P, progress: Optional[Progress] = None) -> P:
        """Run a procedure to its end, as `Session.run`. Raise `FailedError`."""
        return await self._run(self._procedure(procedure, progress))

    async def wait(self, until: Optional[float] = None) -> list[Event]:
        """Return the next events, until ``until`` (milliseconds of the clock).

        Without ``until``, wait until the deadline of the client, but at most one
        second.
        """
        with self._box(_Box()) as box:
            return await self._next(box, until)

    @contextmanager
    def _box(self, box: B) -> Iterator[B]:
        """Let any reading task add events for this task to the box."""
        key = object()
        self._boxes[key] = box
        try:
            yield box
        finally:
            del self._boxes[key]

    async def _next(self, box: _Box, until: Optional[float]) -> list[Event]:
        """Return the events of a task, or wait for the next. One task reads for all."""
        await self._flush()
        async with self._lock.read:
            # While this task waited for the lock, another task may have received its
            # events.
            if not box:
                await self._receive(until)
        return box.take()

    async def _receive(self, until: Optional[float]) -> None:
        # Another task may send a request meanwhile, whose deadline is earlier.
        longest = self.client.settings.reply_timeout
        data = await self._read(min(self._seconds(until), longest / 1000))
        if data is None:
            events = self.client.tick(self._now())
        elif data:
            events = self.client.received(self._now(), data)
        else:
            raise ConnectionResetError("the other side closed the connection")
        for box in self._boxes.values():
            for event in events:
                box.add(event)
        self._report_unsolicited(events)
        await self._flush()

    @property
    def _lock(self) -> _Locks:
        if self._locks is None:  # before Python 3.10, a new lock needs the event loop
            self._locks = _Locks(asyncio.Lock(), asyncio.Lock())
        return self._locks

    async def _run(self, exchange: Exchange[T]) -> T:
        with self._box(_Box()) as box:
            try:
                step = next(exchange)
                while True:
                    if step == "send":
                        await self._flush()
                        step = exchange.send([])
                    else:
                        step = exchange.send(await self._next(box, step))
            except StopIteration as end:
                result: T = end.value
                return result
            finally:
                exchange.close()

    async def _read(self, seconds: float) -> Optional[bytes]:
        """Return received bytes, or None after ``seconds``.

        `asyncio.wait_for` could lose a cancellation at the moment at which bytes
        arrive, before Python 3.12. Here these bytes are stored for the next read.
        """
        reading = self._read_before or asyncio.ensure_future(self._reader.read(_PIECE))
        self._read_before = None
        try:
            await asyncio.wait((reading,), timeout=seconds)
        except asyncio.CancelledError:
            if not reading.cancel():
                self._read_before = reading
            raise
        if reading.cancel():
            # The stream can be read again only when the cancelled read has ended.
            await asyncio.wait((reading,))
            return None
        return reading.result()

    async def _flush(self) -> None:
        async with self._lock.write:
            while data := self.client.output():
                self._writer.write(data)
                await self._writer.drain()
