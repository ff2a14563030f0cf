"""Turns of phrase that findings share."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.diagnostics import Place
from icdgen.icd.remedies import Remedy

LONGEST = 60
VERBATIM = "names are the manual's, to the letter"


def quote(text: object) -> str:
    """The text in back-ticks, cut where it is longer than a line can bear."""
    words = str(text)
    return f"`{words if len(words) <= LONGEST else words[: LONGEST - 3] + '...'}`"


def line_of(other: Place, here: Place) -> str:
    """``line 12``, or ``common.yaml:12`` where that is another file."""
    return f"line {other.line}" if other.file == here.file else f"{other.file}:{other.line}"


def count(number: int, noun: str) -> str:
    """``1 bit``, ``2 bits``"""
    return f"{number:,} {noun}" + ("" if number == 1 else "s")


def of_wide_value(key: str, value: int, width: int) -> Remedy:
    """Return the help for a value of a checksum that has more bits than its ``width``."""
    if key != "polynomial" or value >> width != 1:
        return Remedy(f"correct `{key}` or `width`")
    polynomial = f"0x{value & (1 << width) - 1:0{-(-width // 4)}X}"
    return Remedy(f"write it without its highest term: {polynomial}", polynomial)


def listing(items: Iterable[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``"""
    *most, last = items
    return f"{', '.join(most)} and {last}" if most else last
