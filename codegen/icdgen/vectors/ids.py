"""Ids that test the dispatchers of generated code: ids of the ICD and ids next to them."""

from __future__ import annotations

from collections.abc import Iterable

BYTE = 256


def test_ids(ids: Iterable[int], bits: int = 32) -> list[int]:
    """Return test ids of at most ``bits`` bits: all bytes, the ids of the ICD, their
    neighbors and their truncated and extended forms.
    """
    # Dispatchers are tested with each byte, known or not.
    candidates = set(range(BYTE))
    for id in ids:
        # Truncated to 8 or 16 bits, shifted down, or with an additional high bit.
        candidates |= {
            id - 1,
            id,
            id + 1,
            id & 0xFF,
            id >> 8,
            id & 0xFFFF,
            id | 1 << 8,
            id | 1 << 16,
        }
    return sorted(id for id in candidates if 0 <= id < 1 << bits)
