"""Words of requests and of answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, Optional

Words = Iterator[str]


class Refusal(Exception):
    """An answer that is not ``ok``: the error and its keys."""


def counted(name: str, error: Any) -> str:
    """A refusal that says how many there must be and how many there are."""
    return f"{name} expected={error.expected} actual={error.actual}"


def number(words: Words) -> int:
    return int(next(words))


def numbers(words: Words) -> list[int]:
    """All that are left."""
    return [int(word) for word in words]


def maybe(words: Words) -> Optional[int]:
    """None for an empty word."""
    word = next(words)
    return int(word) if word else None


def octets(words: Words) -> bytes:
    return bytes.fromhex(next(words))


def listed(items: Iterable[object]) -> str:
    return ",".join(map(str, items))


def row(name: str, **facts: object) -> str:
    """A row of an answer; what is None is left out."""
    said = [f" {name}"]
    for key, value in facts.items():
        if value is not None:
            shown = value.hex() if isinstance(value, bytes) else value
            said.append(f" {key}={shown}")
    return "".join(said)
