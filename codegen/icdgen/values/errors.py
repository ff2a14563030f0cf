"""Errors of requests to decode or encode."""

from __future__ import annotations

from icdgen.errors import UserError


class NotFound(UserError):
    """No node, message or field has this name."""


class Ambiguous(UserError):
    """Several messages or fields match the name. The text lists them."""


class BadHex(UserError):
    """A text is not bytes in hexadecimal.

    The text of the error has the place of the first wrong character.
    """


class BadLength(UserError):
    """A frame does not have the length of its message.

    ``expected`` and ``actual`` are in bytes.
    """

    def __init__(
        self, message: str, expected: int, actual: int, help: str = ""
    ) -> None:
        super().__init__(message, help)
        self.expected, self.actual = expected, actual


class BadValue(UserError):
    """Assignments cannot be encoded. The text lists all errors, one per line."""
