"""Requests and procedures, independent of blocking and asyncio sessions."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Generic, Literal, Optional, TypeVar, Union, cast

from .._base import Message
from .._errors import IcdError
from .._hints import N
from .client import Client
from .envelope_client import EnvelopeClient
from .errors import BusyError, UnsupportedError
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
from .link import Link, Settings
from .message_ids import NodeMessage, NodeMessageClass
from .procedures import Procedure

AnyClient = Union[Client[N], EnvelopeClient[N]]
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
    crc: bool,
    settings: Optional[Settings],
    values: Optional[Mapping[str, int]],
) -> AnyClient[N]:
    """Return the client for a byte stream. Raise `UnsupportedError`."""
    if link.stream:
        if crc:
            raise UnsupportedError(
                "the envelope has the checksum, and leaves no choice"
            )
        return EnvelopeClient(link, settings, values)
    if values:
        raise UnsupportedError("only envelopes have values to choose")
    return Client(link, "uart", crc, settings=settings)


class Exchanges(Generic[N]):
    """A client with a clock and a handler of unsolicited events."""

    def __init__(
        self,
        client: AnyClient[N],
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

    def _with_reply(
        self, message: NodeMessage[N], reply: NodeMessageClass[N, Message], repeat: bool
    ) -> Exchange[Outcome]:
        """Send a telecommand and wait for its reply."""
        if isinstance(self.client, Client):
            what = "telecommands are acknowledged, and answered with nothing"
            raise UnsupportedError(what)
        return self._exchange(self.client.send, message, repeat, reply)

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
        self, start: Callable[..., list[Event]], *arguments: Any
    ) -> Exchange[Outcome]:
        """Run a request, which the method ``start`` of the client begins.

        If the client is busy, wait until another request has ended.
        """
        while True:
            try:
                events = start(self._now(), *arguments)
                break
            except BusyError:
                yield None
        client = self.client
        handle = self._last_handle()
        reply: Optional[Reply] = None
        try:
            yield "send"
            if isinstance(client, EnvelopeClient) and (sent := client.sent(handle)):
                return sent
            while True:
                for event in events:
                    if isinstance(event, Reply) and event.handle == handle:
                        reply = event
                    elif isinstance(event, OUTCOMES) and event.handle == handle:
                        yield "send"
                        return _with_data(event, reply)
                events = yield None
        finally:
            self._cancel(handle)

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
        if isinstance(client, Client):
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
                        if event.may_be_damaged and isinstance(client, Client):
                            self._report(event)
                    procedure.event(self._now(), event)
                events = []
                is_free = isinstance(client, EnvelopeClient) or not client.busy
                if is_free and (request := procedure.next(self._now())):
                    events = client.start(self._now(), request)
                    handle = self._last_handle()
                yield "send"
                if isinstance(client, EnvelopeClient) and (sent := client.sent(handle)):
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
            self._cancel(handle)

    def _last_handle(self) -> int:
        """Return the handle of the last request; 0 on a link that has none."""
        client = self.client
        return client.begun if isinstance(client, EnvelopeClient) else 0

    def _cancel(self, handle: int) -> None:
        """Cancel a request. Otherwise the client stays busy after an exception of the
        port.
        """
        if isinstance(self.client, Client):
            self.client.cancel()
        else:
            self.client.cancel(handle=handle)


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
