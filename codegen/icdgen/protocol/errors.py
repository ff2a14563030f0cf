"""Errors of the reference implementation; the runtimes use the same names."""

from __future__ import annotations

from typing import ClassVar


class Refused(Exception):
    """Refusal of a request.

    ``error`` is the code in JSON responses, ``details`` all members that describe the
    error, ``answer`` the complete response.
    """

    error: str

    def __init__(self, text: object = "", **more: object) -> None:
        super().__init__(text)
        self.details = {"error": self.error, **more}
        self.answer = {"ok": False, **self.details}


class Mismatch(Refused, ValueError):
    """Expected and actual value differ."""

    text: ClassVar[str]

    def __init__(self, expected: int, actual: int) -> None:
        super().__init__(
            self.text.format(expected=expected, actual=actual),
            expected=expected,
            actual=actual,
        )
        self.expected, self.actual = expected, actual


class LengthError(Mismatch):
    """Message has the wrong length."""

    error = "length"
    text = "{expected} bytes are expected, {actual} given"


class TooLongError(Mismatch):
    """Message has ``actual`` bytes; at most ``expected`` bytes fit."""

    error = "too-long"
    text = "{actual} bytes, at most {expected} fit"


class ChecksumError(Mismatch):
    """Checksum of a reply is wrong."""

    error = "checksum"
    text = "the checksum is {actual:#04x}, of the data it is {expected:#04x}"


class RangeError(ValueError):
    """Value that does not exist, does not fit or cannot be selected: a packet, a part
    of a date, a destination.
    """

    def __init__(self, field: str) -> None:
        super().__init__(f"the {field} does not exist or does not fit")
        self.field = field


class BusyError(Refused, RuntimeError):
    """Another request is still running.

    A second one would overrun the buffer of the node.
    """

    error = "busy"


class UnknownIdError(Refused, LookupError):
    """Node has no message of this id."""

    error = "unknown-id"
