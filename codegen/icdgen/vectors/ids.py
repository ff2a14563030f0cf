"""Which ids a dispatcher is asked for."""

from __future__ import annotations

from collections.abc import Iterable

BYTE = 256


def worth_asking(known: Iterable[int], bits: int = 32) -> list[int]:
    """Every byte, every known id, its neighbours, and what is left of it where a part is lost; none wider than ``bits``."""
    found = set(range(BYTE))
    for id in known:
        found |= {id - 1, id, id + 1, id & 0xFF, id >> 8, id & 0xFFFF, id | 1 << 8, id | 1 << 16}
    return sorted(id for id in found if 0 <= id < 1 << bits)
