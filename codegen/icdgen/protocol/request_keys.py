"""Reading the keys of a request in JSON, and refusing it."""

from __future__ import annotations

import re
from typing import Any

from icdgen.protocol.errors import Refused

Request = dict[str, Any]


class Refusal(Refused):
    """Any refusal, by what answers call it."""

    def __init__(self, error: str, **more: object) -> None:
        self.error = error
        super().__init__(**more)


def number(request: Request, key: str, least: int = 0, most: int = (1 << 32) - 1, default: int | None = None) -> int:
    """An integer; refused if it is missing, unless there is a default, or out of range."""
    value = request.get(key, default)
    if type(value) is not int or not least <= value <= most:
        raise Refusal("request", detail=f"`{key}` is missing or is no number from {least} to {most}")
    return value


def text(request: Request, key: str) -> str:
    value = request.get(key)
    if not isinstance(value, str):
        raise Refusal("request", detail=f"`{key}` is missing or is no text")
    return value


def octets(request: Request, key: str = "bytes") -> bytes:
    return hex_bytes(request.get(key))


def hex_bytes(value: object) -> bytes:
    if not isinstance(value, str) or not re.fullmatch("([0-9A-Fa-f]{2})*", value):
        raise Refusal("request", detail="not hex digits, two a byte")
    return bytes.fromhex(value)


def flag(request: Request, key: str) -> bool:
    """A truth value, false if it is missing."""
    value = request.get(key, False)
    if type(value) is not bool:
        raise Refusal("request", detail=f"`{key}` is neither true nor false")
    return value


def rows(request: Request, key: str) -> list[Any]:
    value = request.get(key)
    if not isinstance(value, list):
        raise Refusal("request", detail=f"`{key}` is missing or is no list")
    return value


def mappings(request: Request, key: str) -> list[dict[str, Any]]:
    found = rows(request, key)
    if not all(isinstance(row, dict) for row in found):
        raise Refusal("request", detail=f"`{key}` has an entry that is no object")
    return found
