"""Base class of file transfer and of operations on programs."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from typing import Any, Literal, NamedTuple, Optional, Union

from .._base import Message
from .client import Request
from .errors import need
from .events import AnyDone, Arrived, Done, Event, Outcome, Packet, Refused, Timeout
from .link import Link, Step

Result = Literal[
    "done",
    "refused",
    "timeout",
    "parameter",
    "length",
    "limit",
    "rounds",
    "checksum",
    "error",
]


class Wait(NamedTuple):
    """Wait until this time in milliseconds, or until the next event."""

    until: float


class Ended(Exception):
    """The procedure failed with this result."""

    def __init__(self, result: Result) -> None:
        super().__init__(result)
        self.result: Result = result


Action = Union[Request, Wait]
Values = dict[str, Any]

Steps = Generator[Action, Optional[Outcome], None]


def one_of(numbers: Iterable[int]) -> str:
    """Return the valid numbers as text, such as ``one of 1, 2``."""
    return "one of " + ", ".join(map(str, numbers))


class RoleProcedure:
    """A procedure over a client, independent of clock and bus.

    `next` returns the request to start, `event` processes the events of the client. The
    first call of `next` starts the procedure. Raise `UnsupportedError`.
    """

    def __init__(self, link: Link) -> None:
        self.link = link
        self.result: Optional[Result] = None
        """None while it runs, then ``done`` or the reason of the failure."""
        self._now: float = 0
        self._action: Optional[Action] = None
        self._is_requested = False
        self._repetitions = 0  # of the request, after damaged acknowledges
        self._steps: Optional[Steps] = None

    @property
    def progress(self) -> tuple[int, Optional[int]]:
        """Number of transferred bytes, and their total if known."""
        return 0, None

    @property
    def deadline(self) -> Optional[float]:
        """Time of the next call of `next`, in milliseconds; None while waiting for an
        outcome.
        """
        return self._action.until if isinstance(self._action, Wait) else None

    def next(self, now: float) -> Optional[Request]:
        """Return the next request, once; None if there is nothing to send."""
        self._now = now
        if self._steps is None:
            self._steps = self._run()
            self._advance(None)
        while isinstance(self._action, Wait) and now >= self._action.until:
            self._advance(None)
        if isinstance(self._action, Request) and not self._is_requested:
            self._is_requested = True
            return self._action
        return None

    def event(self, now: float, event: Event) -> None:
        """Process an event of the client. Unrelated events are ignored."""
        self._now = now
        files = self.link.files
        if isinstance(event, Arrived):
            if files and event.id in files.packet_ids.values():
                counter = event.data[: files.counter_bytes]
                number = int.from_bytes(counter, self.link.order)
                self._packet(number, event.data[files.counter_bytes :])
        elif isinstance(event, Packet):
            self._packet(event.number, event.data)
        elif isinstance(event, (Done, Refused, Timeout)) and self._is_requested:
            self._is_requested = False
            if not (isinstance(event, Refused) and event.may_be_damaged):
                self._repetitions = 0
                self._advance(event)
            elif self._is_repeatable:
                self._repetitions += 1
            else:
                self._repetitions = 0
                self._advance(Timeout(event.id, event.attempts))

    @property
    def _is_repeatable(self) -> bool:
        """Whether the request can be sent again after a damaged acknowledge."""
        return (
            isinstance(self._action, Request)
            and self._action.repeat
            and self._repetitions < self.link.settings.retries
        )

    def _run(self) -> Steps:
        raise NotImplementedError

    def _packet(self, number: int, data: bytes) -> None:
        """Process a download packet."""

    def _advance(self, outcome: Optional[Outcome]) -> None:
        if self._steps is None:
            return
        self._action = None
        try:
            self._action = self._steps.send(outcome)
        except StopIteration:
            self.result = "done"
        except Ended as end:
            self.result = end.result

    def _telecommand(
        self, step: Step, values: Optional[Values] = None, repeat: bool = True
    ) -> Request:
        """Return the telecommand of a step: a default message with values by role."""
        id = need(step.telecommand, "telecommand")
        message = self.link.TELECOMMANDS[id]()
        for role, value in (values or {}).items():
            setattr(message, step.fields[role], value)
        return Request("telecommand", id, message.to_bytes(), repeat)

    def _outcome_of(
        self, request: Request
    ) -> Generator[Action, Optional[Outcome], Outcome]:
        """Send a request and return its outcome."""
        outcome = yield request
        if outcome is None:
            raise Ended("timeout")
        return outcome

    def _require(
        self, request: Request
    ) -> Generator[Action, Optional[Outcome], AnyDone]:
        """Send a request and return its outcome.

        The procedure fails unless it was executed.
        """
        outcome = yield from self._outcome_of(request)
        if isinstance(outcome, Done):
            return outcome
        raise Ended("refused" if isinstance(outcome, Refused) else "timeout")

    def _execute(
        self, step: Step, values: Optional[Values] = None, repeat: bool = True
    ) -> Generator[Action, Optional[Outcome], None]:
        """Send the telecommand of a step.

        The procedure fails unless it was executed.
        """
        yield from self._require(self._telecommand(step, values, repeat))

    def _frame(
        self, step: Step
    ) -> Generator[Action, Optional[Outcome], tuple[Values, bytes]]:
        """Request the frame of a step. Return its values by role, and its bytes."""
        id = need(step.telemetry, "telemetry")
        done = yield from self._require(Request("telemetry", id, repeat=True))
        frame: Message = self.link.TELEMETRY[id].from_bytes(done.data)
        values = {role: getattr(frame, at) for role, at in step.fields.items()}
        return values, done.data

    def _poll(
        self,
        step: Step,
        role: str,
        wanted: bool,
        interval: float,
        timeout: float,
        program: Optional[int] = None,
    ) -> Generator[Action, Optional[Outcome], tuple[Values, bytes]]:
        """Request the frame of a step until its flag has the value ``wanted``, or an
        error.

        If the frame identifies a program, it must be ``program``.
        """
        end = self._now + timeout
        while True:
            values, frame = yield from self._frame(step)
            is_meant = program is None or values.get("program", program) == program
            if (bool(values[role]) == wanted and is_meant) or values.get("error"):
                return values, frame
            if self._now >= end:
                raise Ended("timeout")
            yield Wait(self._now + interval)
