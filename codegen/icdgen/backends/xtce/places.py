"""Positions of fields in the bit numbering of XTCE.

`run_of` returns the bits of a field as one run, or None: XTCE cannot represent a field
in several runs. `gaps` returns the reserved bits between fields.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from icdgen.frozen import NamedTuple
from icdgen.icd.model import Node
from icdgen.icd.pieces import pieces_at
from icdgen.icd.places import NodePlace


class BitRun(NamedTuple):
    """Consecutive bits of a frame.

    ``at`` counts from the most significant bit of each byte. For a number with the
    least significant byte first (``is_little``), it counts from the least significant
    bit, as in Yamcs; at the start of a byte both are equal.
    """

    at: int
    bits: int
    is_little: bool = False

    @property
    def is_usual(self) -> bool:
        """Whether all consumers read the bits correctly, even if they ignore positions
        and only count bits.
        """
        return not self.is_little or (self.at % 8 == 0 and self.bits % 8 == 0)


def run_of(field: NodePlace, node: Node) -> BitRun | None:
    """Return the bits of a field in the frame; None if XTCE cannot represent their
    order.
    """
    if field.is_bytes:
        return BitRun(field.at, field.bits)
    orders = field.orders_in_effect(node.orders)
    pieces = sorted(
        pieces_at(field.at, field.bits, orders.byte, orders.bit),
        key=lambda piece: piece.at,
    )
    # Most significant bit first, from the first byte on.
    falling = _joined(
        [
            (8 * piece.byte + 8 - piece.shift - piece.bits, piece.bits)
            for piece in reversed(pieces)
        ]
    )
    if falling is not None:
        return BitRun(falling, field.bits)
    # Least significant bit first.
    rising = _joined([(8 * piece.byte + piece.shift, piece.bits) for piece in pieces])
    return None if rising is None else BitRun(rising, field.bits, is_little=True)


def run_of_all(fields: Iterable[NodePlace], node: Node) -> BitRun | None:
    """Return the bits of all elements of an array; None if they are not consecutive."""
    runs: list[BitRun] = []
    for field in fields:
        run = run_of(field, node)
        if run is None or not run.is_usual:
            return None
        if runs and run.is_little != runs[0].is_little:
            return None
        runs.append(run)
    start = _joined([(run.at, run.bits) for run in runs])
    if start is None:
        return None
    return BitRun(start, sum(run.bits for run in runs), runs[0].is_little)


def _joined(places: Sequence[tuple[int, int]]) -> int | None:
    """Return the start of consecutive ranges of bits; None if they are not consecutive."""
    return (
        places[0][0]
        if all(at + bits == after for (at, bits), (after, _) in pairwise(places))
        else None
    )


def gaps(taken: Iterable[BitRun], start: int, end: int) -> list[BitRun]:
    """Return the unused bits from ``start`` to ``end``.

    Gaps of more than 64 bits are split at byte boundaries.
    """
    unused, at = [], start
    for run in (*sorted(taken), BitRun(end, 0)):
        for upto in _cuts(at, run.at):
            unused.append(BitRun(at, upto - at))
            at = upto
        at = max(at, run.at + run.bits)
    return unused


def _cuts(start: int, end: int) -> list[int]:
    """Return the positions at which a gap ends or is split."""
    if end - start <= 64:
        return [end] if end > start else []
    return sorted({-(-start // 8) * 8, end // 8 * 8, end} - {start})
