"""What the reference refuses; the runtimes call it the same."""

from __future__ import annotations


class LengthError(ValueError):
    """A message does not have the length that it must have."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"{expected} bytes are expected, {actual} given")
        self.expected, self.actual = expected, actual


class TooLongError(ValueError):
    """``actual`` bytes are more than the ``expected`` ones for which there is room."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"{actual} bytes, at most {expected} fit")
        self.expected, self.actual = expected, actual


class ChecksumError(ValueError):
    """The checksum of a reply is wrong."""

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(f"the checksum is {actual:#04x}, of the data it is {expected:#04x}")
        self.expected, self.actual = expected, actual


class RangeError(ValueError):
    """Something does not exist, does not fit, or is none of what can be chosen: a packet, a part of a date, a destination."""

    def __init__(self, field: str) -> None:
        super().__init__(f"the {field} does not exist or does not fit")
        self.field = field


class BusyError(RuntimeError):
    """A request is going on: another one would overrun the node's buffer."""


class UnknownIdError(LookupError):
    """The node has no such message."""
