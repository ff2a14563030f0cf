"""Phrases that the messages of several rules share."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.diagnostics import Place, Remedy

LONGEST = 60
VERBATIM = "names are the manual's, to the letter"


def quote(text: object) -> str:
    """Return a text in backticks, shortened to `LONGEST` characters."""
    words = str(text)
    return f"`{words if len(words) <= LONGEST else words[: LONGEST - 3] + '...'}`"


def line_of(other: Place, here: Place) -> str:
    """Return the line of a place: ``line 12``, or ``common.yaml:12`` if it is in another file than ``here``."""
    return f"line {other.line}" if other.file == here.file else f"{other.file}:{other.line}"


def count(number: int, noun: str) -> str:
    """Return a number with its noun: ``1 bit``, ``2 bits``."""
    return f"{number:,} {noun}" + ("" if number == 1 else "s")


def of_wide_value(key: str, value: int, width: int) -> Remedy:
    """Return the help for a value of a checksum that has more bits than its ``width``."""
    # Some catalogues write a polynomial with its highest term, as 0x104C11DB7.
    if key != "polynomial" or value >> width != 1:
        return Remedy(f"correct `{key}` or `width`")
    polynomial = f"0x{value & (1 << width) - 1:0{-(-width // 4)}X}"
    return Remedy(f"write it without its highest term: {polynomial}", polynomial)


def listing(items: Iterable[str]) -> str:
    """Return items as a list in words: ``a``, ``a and b``, ``a, b and c``."""
    *most, last = items
    return f"{', '.join(most)} and {last}" if most else last
