"""Reading of the keys of a JSON request; invalid keys raise `Refusal`.

Each function takes a request and a key, and returns the value with its Python type.
"""

from __future__ import annotations

import re
from typing import Any, TypeVar

from icdgen.runtime_objects.refusals import Refusal

Request = dict[str, Any]
T = TypeVar("T", bound=str)


def number(
    request: Request,
    key: str,
    least: int = 0,
    most: int = (1 << 32) - 1,
    default: int | None = None,
) -> int:
    """Return an integer.

    Raises `Refusal` if it is out of range, or missing without a default.
    """
    value = request.get(key, default)
    # bool is a subclass of int, but JSON distinguishes true from 1.
    if type(value) is not int or not least <= value <= most:
        raise Refusal(
            "request",
            detail=f"`{key}` is missing or is no number from {least} to {most}",
        )
    return value


def text(request: Request, key: str) -> str:
    """Return a text."""
    value = request.get(key)
    if not isinstance(value, str):
        raise Refusal("request", detail=f"`{key}` is missing or is no text")
    return value


def choice(request: Request, key: str, values: tuple[T, ...]) -> T:
    """Return the value that a text names.

    Raises `Refusal` if it names none of them.
    """
    name = text(request, key)
    for value in values:
        if value == name:
            return value
    raise Refusal("request", detail=f"there is no such {key}")


def octets(request: Request, key: str = "bytes") -> bytes:
    """Return bytes, which the request has as hexadecimal digits."""
    return hex_bytes(request.get(key))


def hex_bytes(value: object) -> bytes:
    if not isinstance(value, str) or not re.fullmatch("([0-9A-Fa-f]{2})*", value):
        raise Refusal("request", detail="not hex digits, two a byte")
    return bytes.fromhex(value)


def flag(request: Request, key: str) -> bool:
    """Return a boolean, false if it is missing."""
    value = request.get(key, False)
    if type(value) is not bool:
        raise Refusal("request", detail=f"`{key}` is neither true nor false")
    return value


def rows(request: Request, key: str) -> list[Any]:
    """Return a list of any values."""
    value = request.get(key)
    if not isinstance(value, list):
        raise Refusal("request", detail=f"`{key}` is missing or is no list")
    return value


def mappings(request: Request, key: str) -> list[dict[str, Any]]:
    """Return a list of objects."""
    items = rows(request, key)
    if not all(isinstance(row, dict) for row in items):
        raise Refusal("request", detail=f"`{key}` has an entry that is no object")
    return items
