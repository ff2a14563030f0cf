"""Runs of members that are read and written together: flags that share a byte, and rows of words of one size."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from icdgen import layout
from icdgen.backends.c.bits import is_word, order
from icdgen.backends.c.storage import Storage
from icdgen.icd.model import Field, Node

LONG_ENOUGH = 8
"""From this many words on, a row is moved as one."""


class Flags(NamedTuple):
    """``count`` members of the struct from ``first`` on are bits of ``byte``, from bit ``shift`` up (falling: down to it)."""

    first: int
    count: int
    byte: int
    shift: int
    falling: bool

    def arguments(self, names: Sequence[str]) -> tuple[str, ...]:
        return tuple(names[self.first : self.first + self.count])

    @property
    def macro(self) -> str:
        """The end of the macro's name."""
        return f"{self.count}_FLAGS{'_FALLING' if self.falling else ''}"


class Row(NamedTuple):
    """``count`` members of the struct from ``first`` on are words of ``bits`` bits, in the frame from ``byte`` on."""

    first: int
    count: int
    byte: int
    bits: int

    @property
    def length(self) -> int:
        """Bytes of the frame."""
        return self.count * self.bits // 8


def runs(fields: Sequence[Field], storages: Sequence[Storage], node: Node) -> dict[int, Flags | Row]:
    """The runs of a message by the index of their first member; none overlap."""
    found: dict[int, Flags | Row] = {}
    positions = [_position(field, node) for field in fields]
    index = 0
    while index < len(fields):
        run = _flags(positions, index) or _row(fields, storages, index)
        if run is not None:
            found[index] = run
        index += run.count if run else 1
    return found


def _position(field: Field, node: Node) -> tuple[int, int] | None:
    if field.type != "bool":
        return None
    (piece,) = layout.pieces(field, node)
    return piece.byte, piece.shift


def _flags(positions: Sequence[tuple[int, int] | None], first: int) -> Flags | None:
    start = positions[first]
    if start is None:
        return None
    byte, shift = start
    for count in (8, 4):
        for step in (1, -1):
            last = shift + step * (count - 1)
            wanted = [(byte, shift + step * i) for i in range(count)]
            if 0 <= last <= 7 and list(positions[first : first + count]) == wanted:
                return Flags(first, count, byte, min(shift, last), step < 0)
    return None


def _row(fields: Sequence[Field], storages: Sequence[Storage], first: int) -> Row | None:
    bits, at = fields[first].bits, fields[first].at
    index = first
    while index < len(fields):
        field = fields[index]
        if not is_word(field) or field.bits != bits or field.at != at or storages[index].bits != bits:
            break
        index, at = index + 1, at + bits
    count = index - first
    return Row(first, count, fields[first].at // 8, bits) if count >= LONG_ENOUGH else None


def row_macro(node: Node) -> str:
    """The end of the macro's name."""
    return f"ROW_{order(node).upper()}"
