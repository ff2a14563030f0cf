"""What the wire layer refuses, beside the errors of the messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from .._errors import IcdError

if TYPE_CHECKING:
    from .events import Refused, Timeout

T = TypeVar("T")


class UnsupportedError(IcdError):
    """The ICD does not describe this part of the protocol."""


class TooLongError(IcdError):
    """``actual`` bytes are more than the ``expected`` ones that fit the packets."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"{actual} bytes, at most {expected} fit")
        self.expected, self.actual = expected, actual

    def __reduce__(self) -> tuple[type[TooLongError], tuple[int, int]]:
        return TooLongError, (self.expected, self.actual)


class ChecksumError(IcdError):
    """The checksum of a frame is ``actual``, and should be ``expected``."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(
            f"the checksum is {actual:#x}, of the data it is {expected:#x}"
        )
        self.expected, self.actual = expected, actual

    def __reduce__(self) -> tuple[type[ChecksumError], tuple[int, int]]:
        return ChecksumError, (self.expected, self.actual)


class BusyError(IcdError):
    """A request is going on: another one would overrun the node's buffer."""


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

    def __init__(self, result: str, event: Refused | None = None) -> None:
        why = "" if event is None else f": {RefusedError(event)}"
        super().__init__(f"the procedure ended with: {result}{why}")
        self.result, self.event = result, event

    def __reduce__(self) -> tuple[type[FailedError], tuple[str, Refused | None]]:
        return FailedError, (self.result, self.event)


def need(part: T | None, name: str) -> T:
    """The part of a link. Raises `UnsupportedError` if the ICD does not have it."""
    if part is None:
        raise UnsupportedError(f"the ICD says nothing about `{name}`")
    return part
