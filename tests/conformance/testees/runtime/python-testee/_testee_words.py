"""Words of requests and of answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, Optional

Words = Iterator[str]


class Refusal(Exception):
    """An answer that is not ``ok``: the error and its keys."""


def counted(name: str, error: Any) -> str:
    """Return a refusal with the expected and the actual number."""
    return f"{name} expected={error.expected} actual={error.actual}"


def number(words: Words) -> int:
    return int(next(words))


def numbers(words: Words) -> list[int]:
    """Return all remaining words as numbers."""
    return [int(word) for word in words]


def maybe(words: Words) -> Optional[int]:
    """Return the next number, or ``None`` for an empty word."""
    word = next(words)
    return int(word) if word else None


def octets(words: Words) -> bytes:
    return bytes.fromhex(next(words))


def listed(items: Iterable[object]) -> str:
    return ",".join(map(str, items))


def row(name: str, **facts: object) -> str:
    """Return a row of an answer without the keys whose value is ``None``."""
    words = [f" {name}"]
    for key, value in facts.items():
        if value is not None:
            shown = value.hex() if isinstance(value, bytes) else value
            words.append(f" {key}={shown}")
    return "".join(words)
