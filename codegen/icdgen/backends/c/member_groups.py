"""Groups of members that are read and written together: flags that share a byte, and rows of words of one size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from icdgen.backends.c.bits import is_word, order
from icdgen.describe import FieldDescription

LONG_ENOUGH = 8
"""From this many words on, a row is moved as one."""


@dataclass(frozen=True, slots=True)
class Flags:
    """``count`` members of the struct from ``first`` on are bits of ``byte``, from bit ``shift`` up (falling: down to it)."""

    first: int
    count: int
    byte: int
    shift: int
    falling: bool

    @property
    def macro(self) -> str:
        """The end of the macro's name."""
        return f"{self.count}_FLAGS{'_FALLING' if self.falling else ''}"


@dataclass(frozen=True, slots=True)
class Row:
    """``count`` members of the struct from ``first`` on are words of ``bits`` bits, in the frame from ``byte`` on."""

    first: int
    count: int
    byte: int
    bits: int

    @property
    def length(self) -> int:
        """Bytes of the frame."""
        return self.count * self.bits // 8


def member_groups(fields: Sequence[FieldDescription]) -> dict[int, Flags | Row]:
    """The groups of a message by the index of their first member; none overlap."""
    found: dict[int, Flags | Row] = {}
    positions = [_position(field) for field in fields]
    index = 0
    while index < len(fields):
        group = _flags(positions, index) or _row(fields, index)
        if group is not None:
            found[index] = group
        index += group.count if group else 1
    return found


def _position(field: FieldDescription) -> tuple[int, int] | None:
    if field.model.type != "bool":
        return None
    (piece,) = field.pieces
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


def _row(fields: Sequence[FieldDescription], first: int) -> Row | None:
    bits, start = fields[first].model.bits, fields[first].model.at
    count = 0
    for field in fields[first:]:
        one = field.model
        if not is_word(field) or one.bits != bits or one.at != start + count * bits or field.storage.bits != bits:
            break
        if field.byte_order != fields[first].byte_order:
            break
        count += 1
    return Row(first, count, start // 8, bits) if count >= LONG_ENOUGH else None


def row_macro(first: FieldDescription) -> str:
    """The end of the macro's name."""
    return f"ROW_{order(first).upper()}"
