"""Cells of figures."""

from __future__ import annotations

import re

from icdgen.importer import words
from icdgen.importer.document import Spot, Trouble

_RANGE = re.compile(r"\s*([0-9]+)\s*(?:-|–|:|\.\.\.?|to)\s*([0-9]+)\s*\Z")


def whole(text: str, what: str, title: str, spot: Spot, troubles: list[Trouble]) -> int | None:
    """The number of a cell; a finding and None if it is none."""
    value = words.number(text)
    if value is not None and value >= 0:
        return value
    problem = "is empty" if not text.strip() else f"`{text[:60]}` is not a number"
    hint = "an `l` or `O` for a figure?" if re.search("[lIO]", text) else "look at the page"
    troubles.append(Trouble("IMP023", f"{title}: {what} {problem}", spot, f"{hint}; the row was left out", "error"))
    return None


def span(text: str) -> tuple[int, int] | None:
    """First position and width of a range such as ``4-7`` or ``7:4``."""
    match = _RANGE.match(words.plain(text))
    if not match:
        return None
    first, last = sorted((int(match[1]), int(match[2])))
    return first, last - first + 1
