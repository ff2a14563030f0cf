"""Exceptions with the event that ended a request or a procedure."""

from __future__ import annotations

from typing import Optional, Union

from .._errors import IcdError
from .events import Busy, Refused, Timeout


class RefusedError(IcdError):
    """The node rejected a request.

    ``event`` has the reason, ``name`` is the message.
    """

    def __init__(self, event: Refused, name: str = "") -> None:
        super().__init__(f"{_request(event, name)} was refused: {_reason(event)}")
        self.event, self.name = event, name

    def __reduce__(self) -> tuple[type[RefusedError], tuple[Refused, str]]:
        return RefusedError, (self.event, self.name)


class DeviceBusyError(IcdError):
    """The device was busy at the last attempt. ``name`` is the message."""

    def __init__(self, event: Busy, name: str = "") -> None:
        often = "1 attempt" if event.attempts == 1 else f"{event.attempts} attempts"
        super().__init__(
            f"{_request(event, name)}: the device was still busy after {often}"
        )
        self.event, self.name = event, name

    def __reduce__(self) -> tuple[type[DeviceBusyError], tuple[Busy, str]]:
        return DeviceBusyError, (self.event, self.name)


class ReplyTimeoutError(IcdError):
    """A request had no reply. ``name`` is the message."""

    def __init__(self, event: Timeout, name: str = "") -> None:
        often = "1 attempt" if event.attempts == 1 else f"{event.attempts} attempts"
        super().__init__(f"{_request(event, name)} had no reply after {often}")
        self.event, self.name = event, name

    def __reduce__(self) -> tuple[type[ReplyTimeoutError], tuple[Timeout, str]]:
        return ReplyTimeoutError, (self.event, self.name)


class FailedError(IcdError):
    """A procedure failed. ``result`` is its `Procedure.result`.

    ``event`` is the rejection that ended it, or None.
    """

    def __init__(self, result: str, event: Optional[Refused] = None) -> None:
        why = "" if event is None else f": {RefusedError(event)}"
        super().__init__(f"the procedure ended with: {result}{why}")
        self.result, self.event = result, event

    def __reduce__(self) -> tuple[type[FailedError], tuple[str, Optional[Refused]]]:
        return FailedError, (self.result, self.event)


def _request(event: Union[Refused, Busy, Timeout], name: str) -> str:
    return f"{name} (id {event.id})" if name else f"the request of id {event.id}"


def _reason(event: Refused) -> str:
    return event.reason or ("no reason" if event.code is None else str(event.code))
