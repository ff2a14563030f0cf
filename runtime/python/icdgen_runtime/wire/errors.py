"""Exceptions of the wire layer, in addition to the exceptions of messages."""

from __future__ import annotations

from typing import Optional, TypeVar

from .._errors import IcdError

T = TypeVar("T")


class UnsupportedError(IcdError):
    """The ICD does not describe this part of the protocol."""


class TooLongError(IcdError):
    """The data has ``actual`` bytes, but the packets can contain only ``expected``."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"{actual} bytes, at most {expected} fit")
        self.expected, self.actual = expected, actual

    def __reduce__(self) -> tuple[type[TooLongError], tuple[int, int]]:
        return TooLongError, (self.expected, self.actual)


class ChecksumError(IcdError):
    """The checksum of a frame is ``actual`` instead of ``expected``."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(
            f"the checksum is {actual:#x}, of the data it is {expected:#x}"
        )
        self.expected, self.actual = expected, actual

    def __reduce__(self) -> tuple[type[ChecksumError], tuple[int, int]]:
        return ChecksumError, (self.expected, self.actual)


class BusyError(IcdError):
    """As many requests are in progress or waiting as the client may have."""


def need(part: Optional[T], name: str) -> T:
    """Return a part of a link.

    Raise `UnsupportedError` if the ICD does not describe it.
    """
    if part is None:
        raise UnsupportedError(f"the ICD says nothing about `{name}`")
    return part
