"""A client over any port, for programs that may wait."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Optional, TypeVar

from .._base import Message
from .client import Client, Request
from .events import Done, Event, Outcome, Refused, Timeout
from .failures import FailedError, RefusedError, ReplyTimeoutError
from .link import Link, Settings
from .procedures import Procedure

M = TypeVar("M", bound=Message)
P = TypeVar("P", bound=Procedure)

_LONGEST_WAIT = 1000.0  # ms in one go


class BusSession:
    """Asks, and waits for the outcome, over whatever ``_flush`` and ``_receive`` reach."""

    def __init__(
        self,
        client: Client,
        on_event: Optional[Callable[[Event], object]] = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.client = client
        self._clock, self._on_event = clock, on_event

    def get(self, message: type[M]) -> M:
        """Requests telemetry, or reads a setting.

        Raises `RefusedError`, `ReplyTimeoutError` and what `Client.request` does.
        """
        events = self.client.request(self._now(), message)
        return message.from_bytes(_done(self._outcome(events)).data)

    def send(self, message: Message, repeat: bool = False) -> None:
        """Sends a telecommand or a setting; raises like `get` and `Client.send`."""
        _done(self._outcome(self.client.send(self._now(), message, repeat)))

    def start(self, request: Request) -> Outcome:
        """Any request; its outcome. Raises what `Client.start` does."""
        return self._outcome(self.client.start(self._now(), request))

    def run(
        self,
        procedure: P,
        progress: Optional[Callable[[int, Optional[int]], object]] = None,
    ) -> P:
        """Runs a procedure to its end; ``progress`` is told of bytes, and of how many.

        A request that is refused with a code that the ICD does not have is sent again, if
        it may be, as the acknowledge may be damaged, and else taken for a time-out. Raises
        `FailedError`.
        """
        try:
            return self._driven(procedure, progress)
        finally:
            self.client.cancel()  # else a port that fails leaves it busy

    def _driven(
        self, procedure: P, progress: Optional[Callable[[int, Optional[int]], object]]
    ) -> P:
        events: list[Event] = []
        shown: Optional[tuple[int, Optional[int]]] = None
        asked: Optional[Request] = None
        refused: Optional[Refused] = None
        left = 0
        while True:
            is_again = False
            for event in events:
                if isinstance(event, Refused):
                    refused = event
                    if _may_be_damaged(event):
                        self._tell(event)
                        is_again = bool(asked and asked.repeat) and left > 0
                        if is_again:
                            continue
                        event = Timeout(event.id, event.attempts)
                procedure.event(self._now(), event)
            events = []
            if is_again:
                left -= 1
            elif not self.client.busy:
                asked = procedure.next(self._now())
                left = self.client.settings.retries
            if asked and not self.client.busy:
                events = self.client.start(self._now(), asked)
            self._flush()
            if progress and procedure.progress != shown:
                shown = procedure.progress
                progress(*shown)
            if procedure.result == "done":
                return procedure
            if procedure.result:
                why = refused if procedure.result == "refused" else None
                raise FailedError(procedure.result, why)
            if not events:
                events = self.wait(procedure.deadline)

    def wait(self, until: Optional[float] = None) -> list[Event]:
        """What happens next, by ``until`` at the latest (milliseconds of the clock).

        Without ``until`` it waits as long as the client wants to, and a second at most.
        """
        self._flush()
        now = self._now()
        times = [time for time in (until, self.client.deadline) if time is not None]
        wait = min([_LONGEST_WAIT, *(time - now for time in times)])
        events = self._receive(max(0.0, wait) / 1000)
        self._flush()
        for event in events:
            if not isinstance(event, (Done, Refused, Timeout)):
                self._tell(event)
        return events

    def _tell(self, event: Event) -> None:
        if self._on_event:
            self._on_event(event)

    def _outcome(self, events: list[Event]) -> Outcome:
        try:
            while True:
                for event in events:
                    if isinstance(event, (Done, Refused, Timeout)):
                        self._flush()
                        return event
                events = self.wait()
        finally:
            self.client.cancel()  # else a port that fails leaves it busy

    def _flush(self) -> None:
        """Sends what the client wants to be sent."""
        raise NotImplementedError

    def _receive(self, seconds: float) -> list[Event]:
        """Gives the client what comes, or lets it know after so long that nothing does."""
        raise NotImplementedError

    def _now(self) -> float:
        return self._clock() * 1000


class Session(BusSession):
    """Asks, and waits for the outcome, over a UART or whatever carries its bytes.

    The port is yours: ``write(data)`` sends, ``read(seconds)`` returns what has come,
    after so many seconds at the latest, if need be nothing; `serial_port` makes them of
    a serial port. What they raise ends the request. ``clock`` gives seconds.
    ``on_event`` is told of what comes unasked, such as logs, and by `run` of refusals
    with a code that the ICD does not have.
    """

    def __init__(
        self,
        link: Link,
        write: Callable[[bytes], object],
        read: Callable[[float], bytes],
        crc: bool = False,
        settings: Optional[Settings] = None,
        on_event: Optional[Callable[[Event], object]] = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(Client(link, "uart", crc, settings=settings), on_event, clock)
        self._write, self._read = write, read

    def _flush(self) -> None:
        data = self.client.output()
        if data:
            self._write(data)

    def _receive(self, seconds: float) -> list[Event]:
        data = self._read(seconds)
        if data:
            return self.client.received(self._now(), data)
        return self.client.tick(self._now())


def _done(outcome: Outcome) -> Done:
    if isinstance(outcome, Refused):
        raise RefusedError(outcome)
    if isinstance(outcome, Timeout):
        raise ReplyTimeoutError(outcome)
    return outcome


def _may_be_damaged(event: Refused) -> bool:
    """Whether the code is one that the ICD does not have."""
    return event.code is not None and event.reason is None
