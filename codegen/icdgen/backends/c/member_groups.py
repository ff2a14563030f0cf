"""Groups of members that are read and written together: flags that share a byte, and rows of words of one size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from icdgen.backends.c.bits import is_word, order
from icdgen.describe import FieldDescription
from icdgen.frozen import dataclass

LONG_ENOUGH = 8
"""From this many words on, a row is moved as one."""

Members = tuple[FieldDescription, ...]


@dataclass(frozen=True, slots=True)
class Flags:
    """Members that are bits of ``byte``, from bit ``shift`` up (falling: down to it)."""

    members: Members
    byte: int
    shift: int
    falling: bool

    @property
    def macro(self) -> str:
        """The end of the macro's name."""
        return f"{len(self.members)}_FLAGS{'_FALLING' if self.falling else ''}"


@dataclass(frozen=True, slots=True)
class Row:
    """Members that are words of one size, in the frame one after the other."""

    members: Members

    @property
    def byte(self) -> int:
        """The first byte of the frame."""
        return self.members[0].model.at // 8

    @property
    def length(self) -> int:
        """Bytes of the frame."""
        return len(self.members) * self.members[0].model.bits // 8

    @property
    def macro(self) -> str:
        """The end of the macro's name."""
        return f"ROW_{order(self.members[0]).upper()}"


def in_groups(fields: Members) -> Iterator[Flags | Row | FieldDescription]:
    """The fields of a message in order, those of a group as one."""
    positions = [_position(field) for field in fields]
    index = 0
    while index < len(fields):
        group = _flags(fields, positions, index) or _row(fields[index:])
        yield group or fields[index]
        index += len(group.members) if group else 1


def _position(field: FieldDescription) -> tuple[int, int] | None:
    if field.model.type != "bool":
        return None
    (piece,) = field.pieces
    return piece.byte, piece.shift


def _flags(fields: Members, positions: Sequence[tuple[int, int] | None], first: int) -> Flags | None:
    start = positions[first]
    if start is None:
        return None
    byte, shift = start
    for count in (8, 4):
        for step in (1, -1):
            last = shift + step * (count - 1)
            wanted = [(byte, shift + step * i) for i in range(count)]
            if 0 <= last <= 7 and list(positions[first : first + count]) == wanted:
                return Flags(fields[first : first + count], byte, min(shift, last), step < 0)
    return None


def _row(fields: Members) -> Row | None:
    first, count = fields[0], 0
    bits = first.model.bits
    for field in fields:
        is_next = field.model.bits == bits and field.model.at == first.model.at + count * bits
        is_next = is_next and field.holder == first.holder  # a struct may end with padding
        if not (is_next and is_word(field) and field.storage.bits == bits and field.byte_order == first.byte_order):
            break
        count += 1
    elements = sum(field.model.index is not None for field in fields[:count])
    return Row(fields[:count]) if count >= LONG_ENOUGH or elements == count > 1 else None
