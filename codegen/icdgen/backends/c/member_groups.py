"""Groups of members that are read and written together: flags that share a byte, and rows of words of one size."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.describe import FieldDescription
from icdgen.describe.arrays import ElementRounds, Repeated, rounds_of
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
        return f"ROW_{self.members[0].order.upper()}"


@dataclass(frozen=True, slots=True)
class Structs:
    """An array of structs, which a loop reads and writes."""

    array: Repeated
    reading: str  # the function for an element
    writing: str

    @property
    def length(self) -> int:
        """Bytes of the frame."""
        return self.array.part.count * self.array.step


@dataclass(frozen=True, slots=True)
class Array:
    """An array of numbers that are no words, which a loop reads and writes; ``members`` are those of a round, at ``element``."""

    members: Members
    rounds: ElementRounds


Groups = list[Flags | Row | Array | FieldDescription | Structs]


def in_groups(fields: Members) -> Groups:
    """The fields of a message in order, those of a group as one."""
    positions = [_position(field) for field in fields]
    found: Groups = []
    index = 0
    while index < len(fields):
        array = fields[index].array
        if array is not None and array.model.is_bytes:  # lies in memory as in the frame
            found.append(array)
            index += array.count
            continue
        group = _array(fields[index]) or _flags(fields, positions, index) or _row(fields, index)
        found.append(group or fields[index])
        index += group.rounds.elements if isinstance(group, Array) else len(group.members) if group else 1
    return found


def _array(first: FieldDescription) -> Array | None:
    array = first.array if first.index == 0 and not first.is_plain_word else None
    rounds = rounds_of(first, array.count) if array is not None else None
    if array is None or rounds is None:
        return None
    name = array.member
    members = rounds.members(first, lambda element: f"{name}[element{f' + {element}u' if element else ''}]")
    return Array(members, rounds)


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


def _row(fields: Members, begin: int) -> Row | None:
    first, end = fields[begin], begin + 1
    bits, at = first.model.bits, first.model.at
    if not first.is_plain_word:
        return None
    for field in fields[end:]:
        at += bits
        is_next = field.model.bits == bits and field.model.at == at
        is_next = is_next and field.holder == first.holder  # a struct may end with padding
        if not (is_next and field.is_plain_word and field.byte_order == first.byte_order):
            break
        end += 1
    row = fields[begin:end]
    is_array = len(row) > 1 and all(field.index is not None for field in row)
    return Row(row) if len(row) >= LONG_ENOUGH or is_array else None
