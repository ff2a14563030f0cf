"""Where fields stand, as XTCE counts bits."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

from icdgen import layout
from icdgen.icd.model import Node
from icdgen.icd.places import NodePlace


class Run(NamedTuple):
    """Bits that are sent one after the other.

    ``at`` counts from the most significant bit of each byte. Of a number whose least significant byte is sent first
    (``is_little``) it counts from the least significant one, as Yamcs does; at the beginning of a byte both are the same.
    """

    at: int
    bits: int
    is_little: bool = False

    @property
    def is_usual(self) -> bool:
        """Whether every consumer reads it where it stands, even one that knows of no places and only counts bits."""
        return not self.is_little or (self.at % 8 == 0 and self.bits % 8 == 0)


def run_of(field: NodePlace, node: Node) -> Run | None:
    """The bits of a field in the frame of its message; None where XTCE has no word for their order."""
    if field.is_bytes:
        return Run(field.at, field.bits)
    orders = field.orders_in_effect(node.orders)
    pieces = sorted(layout.pieces_at(field.at, field.bits, orders.byte, orders.bit), key=lambda one: one.at)
    falling = _joined([(8 * one.byte + 8 - one.shift - one.bits, one.bits) for one in reversed(pieces)])
    if falling is not None:
        return Run(falling, field.bits)
    rising = _joined([(8 * one.byte + one.shift, one.bits) for one in pieces])
    return None if rising is None else Run(rising, field.bits, is_little=True)


def run_of_all(fields: Iterable[NodePlace], node: Node) -> Run | None:
    """The bits of the elements of an array; None where one does not follow the other."""
    runs = [run_of(one, node) for one in fields]
    found = [one for one in runs if one is not None and one.is_usual and one.is_little == (runs[0] or one).is_little]
    start = _joined([(one.at, one.bits) for one in found]) if len(found) == len(runs) else None
    return None if start is None else Run(start, sum(one.bits for one in found), found[0].is_little)


def _joined(places: Sequence[tuple[int, int]]) -> int | None:
    """Where places that follow each other begin; None if they do not."""
    return places[0][0] if all(at + bits == after for (at, bits), (after, _) in pairwise(places)) else None


def gaps(taken: Iterable[Run], start: int, end: int) -> list[Run]:
    """The bits from ``start`` to ``end`` that nothing has, none of more than 64 that are no whole bytes."""
    found, at = [], start
    for one in (*sorted(taken), Run(end, 0)):
        for upto in _cuts(at, one.at):
            found.append(Run(at, upto - at))
            at = upto
        at = max(at, one.at + one.bits)
    return found


def _cuts(start: int, end: int) -> list[int]:
    """Where to cut a gap."""
    if end - start <= 64:
        return [end] if end > start else []
    return sorted({-(-start // 8) * 8, end // 8 * 8, end} - {start})
