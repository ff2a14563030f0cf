"""Refusals of JSON requests: codes of errors, and the members that describe them.

``tests/conformance/README.md`` lists the codes.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from icdgen_runtime._errors import IcdError, LengthError, RangeError, UnknownIdError
from icdgen_runtime.wire.errors import (
    BusyError,
    ChecksumError,
    TooLongError,
    UnsupportedError,
)

_CODES: dict[type[IcdError], str] = {
    BusyError: "busy",
    ChecksumError: "checksum",
    LengthError: "length",
    RangeError: "range",
    TooLongError: "too-long",
    UnknownIdError: "unknown-id",
    UnsupportedError: "unsupported",
}


class Refusal(Exception):
    """Refusal of a request.

    ``details``: the code of the error, and the members that describe it.
    """

    def __init__(self, error: str, **more: object) -> None:
        super().__init__(error)
        self.details = {"error": error, **more}


def details_of(error: IcdError) -> dict[str, Any]:
    """Return the code of an error of the runtime, and the members that describe it."""
    details: dict[str, Any] = {"error": _CODES[type(error)]}
    if isinstance(error, (LengthError, TooLongError, ChecksumError)):
        details |= {"expected": error.expected, "actual": error.actual}
    return details


@contextmanager
def naming_the_field() -> Iterator[None]:
    """Name the field of a range error. Otherwise it is a detail of the implementation."""
    try:
        yield
    except RangeError as error:
        raise Refusal("range", field=error.field) from None
