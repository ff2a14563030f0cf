"""Numbers, names and lists in the sentences of messages and pages."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 60


def quote(text: object) -> str:
    """Return a text in backticks, shortened to `LONGEST` characters."""
    words = str(text)
    return f"`{words if len(words) <= LONGEST else words[: LONGEST - 3] + '...'}`"


def count(number: int, noun: str) -> str:
    """Return a number with its noun: ``1 bit``, ``2 bits``."""
    return f"{number:,} {noun}" + ("" if number == 1 else "s")


def listing(items: Iterable[str]) -> str:
    """Return items as a list in words: ``a``, ``a and b``, ``a, b and c``."""
    *most, last = items
    return f"{', '.join(most)} and {last}" if most else last
