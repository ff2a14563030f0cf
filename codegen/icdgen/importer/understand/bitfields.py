"""Fields that a cell names within its own: ``bit 0-3: mode; bit 4: heater``."""

from __future__ import annotations

import re
from typing import NamedTuple

_PART = re.compile(
    r"\b(?:bits?\s*|[bD](?=[0-9]))\[?(?P<a>[0-9]{1,2})(?:\s*(?:-|–|:|~|\.\.+|to)\s*(?:bit\s*|[bD])?(?P<b>[0-9]{1,2}))?\]?\s*"
    r"[:=–-]\s*(?P<name>[^;,.:=\n]+?)\s*(?=[;,.]|\Z|\b(?:bits?\s*|[bD])\[?[0-9])",
    re.I,
)  # fmt: skip


class Bits(NamedTuple):
    """Bits of a value, counted from its lowest one."""

    at: int
    bits: int
    name: str


def read(text: str, width: int) -> list[Bits] | None:
    """The bits that a description names; empty if it names none, None if they overlap or do not fit into ``width``."""
    made: list[Bits] = []
    taken = 0
    for match in _PART.finditer(text):
        first, last = sorted((int(match["a"]), int(match["b"] or match["a"])))
        mask = ((1 << (last - first + 1)) - 1) << first
        if last >= width or taken & mask:
            return None
        taken |= mask
        made.append(Bits(first, last - first + 1, match["name"].strip()))
    return sorted(made)
