"""What the reference refuses; the runtimes call it the same."""

from __future__ import annotations

from typing import ClassVar


class Refused(Exception):
    """A "no". ``error`` is what answers call it, ``told`` all that they say of it, ``answer`` a whole one."""

    error: str

    def __init__(self, text: object = "", **more: object) -> None:
        super().__init__(text)
        self.told = {"error": self.error, **more}
        self.answer = {"ok": False, **self.told}


class Mismatch(Refused, ValueError):
    """Something is not as it must be."""

    text: ClassVar[str]

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(self.text.format(expected=expected, actual=actual), expected=expected, actual=actual)
        self.expected, self.actual = expected, actual


class LengthError(Mismatch):
    """A message does not have the length that it must have."""

    error = "length"
    text = "{expected} bytes are expected, {actual} given"


class TooLongError(Mismatch):
    """``actual`` bytes are more than the ``expected`` ones for which there is room."""

    error = "too-long"
    text = "{actual} bytes, at most {expected} fit"


class ChecksumError(Mismatch):
    """The checksum of a reply is wrong."""

    error = "checksum"
    text = "the checksum is {actual:#04x}, of the data it is {expected:#04x}"


class RangeError(ValueError):
    """Something does not exist, does not fit, or is none of what can be chosen: a packet, a part of a date, a destination."""

    def __init__(self, field: str) -> None:
        super().__init__(f"the {field} does not exist or does not fit")
        self.field = field


class BusyError(Refused, RuntimeError):
    """A request is going on: another one would overrun the node's buffer."""

    error = "busy"


class UnknownIdError(Refused, LookupError):
    """The node has no such message."""

    error = "unknown-id"
