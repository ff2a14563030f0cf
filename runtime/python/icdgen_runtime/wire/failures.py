"""Errors that carry the event that a request, or a procedure, ended with."""

from __future__ import annotations

from typing import Optional

from .._errors import IcdError
from .events import Refused, Timeout


class RefusedError(IcdError):
    """The node refused a request; ``event`` says why."""

    def __init__(self, event: Refused) -> None:
        why = event.reason or ("no reason" if event.code is None else str(event.code))
        super().__init__(f"{event.id} was refused: {why}")
        self.event = event

    def __reduce__(self) -> tuple[type[RefusedError], tuple[Refused]]:
        return RefusedError, (self.event,)


class ReplyTimeoutError(IcdError):
    """A request had no reply."""

    def __init__(self, event: Timeout) -> None:
        super().__init__(f"{event.id} had no reply after {event.attempts} attempts")
        self.event = event

    def __reduce__(self) -> tuple[type[ReplyTimeoutError], tuple[Timeout]]:
        return ReplyTimeoutError, (self.event,)


class FailedError(IcdError):
    """A procedure did not end well: ``result`` is its `Procedure.result`.

    ``event`` is the refusal that ended it, if one did.
    """

    def __init__(self, result: str, event: Optional[Refused] = None) -> None:
        why = "" if event is None else f": {RefusedError(event)}"
        super().__init__(f"the procedure ended with: {result}{why}")
        self.result, self.event = result, event

    def __reduce__(self) -> tuple[type[FailedError], tuple[str, Optional[Refused]]]:
        return FailedError, (self.result, self.event)
