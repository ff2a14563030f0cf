"""What the wire layer refuses, beside the errors of the messages."""

from __future__ import annotations

from typing import Optional, TypeVar

from .._errors import IcdError

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


def need(part: Optional[T], name: str) -> T:
    """The part of a link. Raises `UnsupportedError` if the ICD does not have it."""
    if part is None:
        raise UnsupportedError(f"the ICD says nothing about `{name}`")
    return part
