"""Requests and procedures, independent of blocking and asyncio sessions.

`Exchanges` joins a client with a clock; `session` and `async_session` add the
transport.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Generic, Literal, Optional, TypeVar, Union, cast

from .._base import Message
from .._errors import IcdError
from .._hints import N
from .client import Client
from .events import (
    OUTCOMES,
    AnyDone,
    Arrived,
    Busy,
    Done,
    Event,
    LineError,
    Outcome,
    OutcomeOf,
    R_co,
    Refused,
    Reply,
    Sent,
    Timeout,
)
from .failures import DeviceBusyError, FailedError, RefusedError, ReplyTimeoutError
from .link import Bus, Link, Settings
from .message_ids import NodeMessageClass
from .procedures import Procedure

P = TypeVar("P", bound=Procedure)
T = TypeVar("T")
Step = Union[Literal["send"], float, None]
Exchange = Generator[Step, list[Event], T]
"""A request or procedure in progress.

It yields ``"send"`` to send the output of the client. Otherwise it yields the latest
time in milliseconds, or None, and receives the next events. It returns the outcome.
"""
Progress = Callable[[int, Optional[int]], object]

_LONGEST_WAIT = 1000.0  # ms


def client_of(
    link: Link[N],
    bus: Bus,
    crc: bool,
    settings: Optional[Settings],
    values: Optional[Mapping[str, int]],
    address: int = 0,
) -> Client[N]:
    """Return the client for a port of ``bus``. Raise `UnsupportedError`.

    A stream of bytes belongs to the framed link, if the ICD describes one.
    """
    is_framed = bus == "uart" and link.stream is not None
    return Client(
        link,
        None if is_framed else bus,
        crc=crc,
        address=address,
        settings=settings,
        values=values,
    )


class Exchanges(Generic[N]):
    """A client with a clock and a handler of unsolicited events."""

    def __init__(
        self,
        client: Client[N],
        on_event: Optional[Callable[[Event], object]] = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.client = client
        self._clock, self._on_event = clock, on_event

    def _now(self) -> float:
        return self._clock() * 1000

    def _seconds(self, until: Optional[float]) -> float:
        """Return the longest time to wait, in seconds."""
        now = self._now()
        times = [time for time in (until, self.client.deadline) if time is not None]
        return max(0.0, min([_LONGEST_WAIT, *(time - now for time in times)])) / 1000

    def _report(self, event: Event) -> None:
        if self._on_event:
            self._on_event(event)

    def _report_unsolicited(self, events: list[Event]) -> list[Event]:
        for event in events:
            if not isinstance(event, (*OUTCOMES, Reply)):
                self._report(event)
        return events

    def _messages_in(
        self, events: list[Event], kinds: tuple[NodeMessageClass[N, Message], ...]
    ) -> Iterator[Message]:
        """Return the unsolicited messages of these classes; all messages without
        ``kinds``.
        """
        for event in events:
            if not isinstance(event, Arrived) or (kinds and event.type not in kinds):
                continue
            try:
                message = event.message
            except IcdError:  # a counter in the frame does not match its length
                self._report(LineError("length", event.id))
                continue
            if message is not None:
                yield message

    def _exchange(
        self, start: Callable[..., None], *arguments: Any
    ) -> Exchange[Outcome]:
        """Run a request, which the method ``start`` of the client begins."""
        client = self.client
        start(self._now(), *arguments)
        handle = client.begun
        reply: Optional[Reply] = None
        try:
            yield "send"
            if sent := client.sent(handle):
                return sent
            while True:
                for event in (yield None):
                    if isinstance(event, Reply) and event.handle == handle:
                        reply = event
                    elif isinstance(event, OUTCOMES) and event.handle == handle:
                        yield "send"
                        return _with_data(event, reply)
        finally:
            # Otherwise the client stays busy after an exception of the port.
            client.cancel(handle=handle)

    def _concurrently(self, exchanges: Sequence[Exchange[T]]) -> Exchange[list[T]]:
        """Run several exchanges at once. If one fails, the others are closed."""
        ends: dict[int, T] = {}
        events: Optional[list[Event]] = None
        try:
            while True:
                for place, exchange in enumerate(exchanges):
                    if place in ends:
                        continue
                    try:
                        if events is None:
                            step = next(exchange)
                        else:
                            step = exchange.send(events)
                        while step == "send":
                            step = exchange.send((yield "send"))
                    except StopIteration as end:
                        ends[place] = end.value
                if len(ends) == len(exchanges):
                    return [ends[place] for place in range(len(exchanges))]
                events = yield None
        finally:
            for exchange in exchanges:
                exchange.close()

    def _procedure(
        self, procedure: P, progress: Optional[Progress] = None
    ) -> Exchange[P]:
        """Run a procedure to its end. Raise `FailedError`."""
        client, handle = self.client, 0  # of the last request
        if client.bus:
            procedure.bus = client.bus
        events: list[Event] = []
        reported: Optional[tuple[int, Optional[int]]] = None
        refused: Optional[Refused] = None
        try:
            while True:
                for event in events:
                    # Other tasks may have requests of their own.
                    if isinstance(event, (*OUTCOMES, Reply)) and event.handle != handle:
                        continue
                    if isinstance(event, Refused):
                        refused = event
                        if event.may_be_damaged:
                            self._report(event)
                    procedure.event(self._now(), event)
                events = []
                if request := procedure.next(self._now()):
                    client.start(self._now(), request)
                    handle = client.begun
                yield "send"
                if sent := client.sent(handle):
                    events.append(sent)
                if progress and procedure.progress != reported:
                    reported = procedure.progress
                    progress(*reported)
                if procedure.result == "done":
                    return procedure
                if procedure.result:
                    why = refused if procedure.result == "refused" else None
                    raise FailedError(procedure.result, why)
                if not events:
                    events = yield procedure.deadline
        finally:
            client.cancel(handle=handle)


def executed(outcome: Outcome, name: str) -> Union[AnyDone, Sent]:
    """Return the outcome if it is `Done` or `Sent`.

    Otherwise raise `RefusedError`, `DeviceBusyError` or `ReplyTimeoutError`.
    """
    if isinstance(outcome, Refused):
        raise RefusedError(outcome, name)
    if isinstance(outcome, Busy):
        raise DeviceBusyError(outcome, name)
    if isinstance(outcome, Timeout):
        raise ReplyTimeoutError(outcome, name)
    return outcome


def data_of(outcome: Outcome, name: str) -> bytes:
    """Return the data of requested telemetry. Raise as `executed`."""
    done = executed(outcome, name)
    assert isinstance(done, Done), "a request of telemetry ends with its data"
    return done.data


def _with_data(outcome: Outcome, reply: Optional[Reply]) -> Outcome:
    """Return an outcome with the telemetry that arrived before the acknowledge."""
    if reply is None or not isinstance(outcome, Done):
        return outcome
    return replace(outcome, data=reply.data, type=reply.type, reply=reply.reply)


def outcome_of(outcome: Outcome, message: type[R_co]) -> OutcomeOf[R_co]:
    """Return the outcome with the type of the message, which the client has checked."""
    return cast(OutcomeOf[R_co], outcome)
