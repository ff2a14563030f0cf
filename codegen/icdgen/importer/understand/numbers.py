"""Cells of figures."""

from __future__ import annotations

import re
from typing import NamedTuple

from icdgen.importer import words
from icdgen.importer.document import Spot, Trouble

_RANGE = re.compile(
    r"\s*(?:bits?|bytes?|octets?|B|D)?\s*\[?([0-9]+)\s*(?:-|–|:|~|\.\.\.?|to)\s*(?:bits?|bytes?|octets?|B|D)?\s*([0-9]+)\]?\s*\Z",
    re.I,
)
_COUNTED = re.compile(r"([0-9]+)\s*-?\s*(bits?|bytes?|octets?)\Z", re.I)
_PLACED = re.compile(r"(bits?|bytes?|octets?)\s*\[?([0-9]+)\]?\Z", re.I)


class Figure(NamedTuple):
    """A figure, and how many bits its unit has where the cell says one, else 0."""

    value: int
    unit: int = 0


def figure(text: str) -> Figure | None:
    """``16``, ``2 bytes``, ``Byte 3``; None if the cell is none of these."""
    value = words.number(text)
    if value is not None:
        return Figure(value) if value >= 0 else None
    text = words.plain(text)
    if match := _COUNTED.match(text):
        return Figure(int(match[1]), _bits(match[2]))
    if match := _PLACED.match(text):
        return Figure(int(match[2]), _bits(match[1]))
    return None


def _bits(unit: str) -> int:
    return 1 if unit.casefold().startswith("bit") else 8


def whole(text: str, what: str, title: str, spot: Spot, troubles: list[Trouble]) -> int | None:
    """The number of a cell; a finding and None if it is none."""
    value = words.number(text)
    if value is not None and value >= 0:
        return value
    refused(text, what, title, spot, troubles)
    return None


def refused(text: str, what: str, title: str, spot: Spot, troubles: list[Trouble]) -> None:
    """The finding that a cell is no number."""
    problem = "is empty" if not text.strip() else f"`{text[:60]}` is not a number"
    hint = "an `l` or `O` for a figure?" if re.search("[lIO]", text) else "look at the page"
    troubles.append(Trouble("IMP023", f"{title}: {what} {problem}", spot, f"{hint}; the row was left out", "error"))


def span(text: str) -> tuple[int, int] | None:
    """First position and width of a range such as ``4-7``, ``7:4`` or ``Byte0~Byte1``."""
    match = _RANGE.match(words.plain(text))
    if not match:
        return None
    first, last = sorted((int(match[1]), int(match[2])))
    return first, last - first + 1
