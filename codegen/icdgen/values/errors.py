"""What can be wrong with a request to decode or encode."""

from __future__ import annotations

from icdgen.errors import UserError


class NotFound(UserError):
    """There is no node, message or field of that name."""


class Ambiguous(UserError):
    """The name fits several; the message lists them."""


class BadHex(UserError):
    """The text is not bytes in hexadecimal; the message says where it stops being so."""


class BadLength(UserError):
    """Not the message's number of bytes. ``expected`` and ``actual`` count bytes."""

    def __init__(self, message: str, expected: int, actual: int, help: str = "") -> None:
        super().__init__(message, help)
        self.expected, self.actual = expected, actual


class BadValue(UserError):
    """Assignments that cannot be encoded; the message lists everything wrong with them, a line each."""
