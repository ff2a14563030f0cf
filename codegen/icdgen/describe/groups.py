"""Members that code handles together: flags that share a byte, rows of words, elements
of arrays, and arrays of structs.

A language states the smallest group for which it has code. All languages share the
rules by which members form groups.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from icdgen.describe.arrays import (
    ArrayLoop,
    StructArray,
    loop_from,
    loop_of,
    struct_arrays_in,
)
from icdgen.describe.description import Composite, FieldDescription, Into
from icdgen.frozen import NamedTuple

Fields = tuple[FieldDescription, ...]


class Thresholds(NamedTuple):
    """Sizes of groups for which a language has code."""

    flags: tuple[int, ...]  # flags of one byte, the largest size first
    row: int  # fewest words of separate members; two elements of an array are enough


class Flags(NamedTuple):
    """Flags in neighbouring bits of a byte.

    The first has bit ``shift``; if they are falling, the last has it.
    """

    fields: Fields
    byte: int
    shift: int
    is_falling: bool


class WordRow(NamedTuple):
    """Words of the same size and byte order, one after the other in the frame and in
    memory.
    """

    fields: Fields

    @property
    def byte(self) -> int:
        """First byte of the frame."""
        return self.fields[0].model.at // 8

    @property
    def length(self) -> int:
        """Number of bytes of the frame."""
        return len(self.fields) * self.fields[0].model.bits // 8


class LoopElements(NamedTuple):
    """Elements of an array that a loop reads and writes.

    ``first`` is the first element.
    """

    array: FieldDescription
    first: FieldDescription
    loop: ArrayLoop


Group = Flags | WordRow | LoopElements | StructArray | FieldDescription


def grouped_fields(composite: Composite[Any]) -> Iterator[FieldDescription]:
    """List the scalars that have bits in every frame, except scalars in arrays of
    structs.
    """
    for member in composite.walk(Into.STRUCTS):
        if (
            member.element_struct is None
            and not member.model.is_count
            and not member.model.conditions
        ):
            yield from member.scalars


def group_fields(
    composite: Composite[Any], thresholds: Thresholds, prefix: str = ""
) -> list[Group]:
    """Return the `grouped_fields` in their order, with groups in place of their fields;
    then the arrays of structs, except the last variable part.

    An array of bytes is one field. Names of arrays of structs start with ``prefix``.
    """
    fields = tuple(grouped_fields(composite))
    positions = [_position(field) for field in fields]
    result: list[Group] = []
    index = 0
    while index < len(fields):
        array = fields[index].array
        if array is not None and array.model.is_bytes:
            result.append(array)
            index += array.count
            continue
        in_loop = _loop_elements(fields[index])
        if in_loop is not None:
            result.append(in_loop)
            index += in_loop.loop.elements
            continue
        group = _flags(fields, positions, index, thresholds.flags) or _row(
            fields, index, thresholds.row
        )
        result.append(group or fields[index])
        index += len(group.fields) if group else 1
    last = composite.last_part.field if composite.last_part is not None else None
    arrays = struct_arrays_in(composite, prefix)
    return [*result, *(array for array in arrays if array.field is not last)]


def _loop_elements(first: FieldDescription) -> LoopElements | None:
    array = first.array if first.index == 0 else None
    loop = loop_from(first, array.count) if array is not None else None
    return None if array is None or loop is None else LoopElements(array, first, loop)


def _position(field: FieldDescription) -> tuple[int, int] | None:
    """Return byte and bit of a flag; None for any other field."""
    if field.model.type != "bool":
        return None
    (piece,) = field.pieces
    return piece.byte, piece.shift


def _flags(
    fields: Fields,
    positions: Sequence[tuple[int, int] | None],
    first: int,
    sizes: tuple[int, ...],
) -> Flags | None:
    start = positions[first]
    if start is None:
        return None
    byte, shift = start
    # Flags fall in manuals that number the bits of a byte from the most significant
    # one.
    for count in sizes:
        for step in (1, -1):
            last = shift + step * (count - 1)
            wanted = [(byte, shift + step * i) for i in range(count)]
            if 0 <= last <= 7 and list(positions[first : first + count]) == wanted:
                return Flags(
                    fields[first : first + count], byte, min(shift, last), step < 0
                )
    return None


def _row(fields: Fields, begin: int, long_enough: int) -> WordRow | None:
    # Words of the same size follow each other in memory without padding.
    first, end = fields[begin], begin + 1
    bits, at = first.model.bits, first.model.at
    if not first.is_plain_word:
        return None
    for field in fields[end:]:
        at += bits
        is_next = field.model.bits == bits and field.model.at == at
        is_same_word = field.is_plain_word and field.byte_order == first.byte_order
        # In memory, padding can follow a struct.
        if not (is_next and is_same_word and field.holder == first.holder):
            break
        end += 1
    row = fields[begin:end]
    is_array = len(row) > 1 and all(field.index is not None for field in row)
    return WordRow(row) if len(row) >= long_enough or is_array else None


def bytes_of_flags(composite: Composite[Any], at_least: int) -> set[int]:
    """Return the bytes of a frame with at least so many flags.

    Optional flags and flags that a loop reads do not count.
    """
    counts: Counter[int] = Counter()  # flags by their byte
    for member in composite.walk(Into.STRUCTS):
        is_read_alone = not member.model.conditions and loop_of(member) is None
        if member.model.type == "bool" and is_read_alone:
            counts.update(flag.pieces[0].byte for flag in member.elements)
    return {byte for byte, count in counts.items() if count >= at_least}


class FrameSegment(NamedTuple):
    """Bytes of a frame that one statement writes.

    The statement is either complete, or it combines terms for parts of a byte. With
    neither, no field has bits in the bytes.
    """

    byte: int
    length: int
    statement: str | None
    terms: tuple[str, ...] = ()


class FrameBytes:
    """Frame that is assembled from statements for whole bytes and terms for parts of
    bytes, added in any order.
    """

    def __init__(self, length: int) -> None:
        self._length = length
        # First byte -> number of bytes, statement.
        self._whole: dict[int, tuple[int, str]] = {}
        self._parts: dict[int, list[tuple[int, str]]] = {}  # byte -> bit of it, term

    def add_whole(self, byte: int, length: int, statement: str) -> None:
        """Add a statement that writes so many bytes."""
        self._whole[byte] = length, statement

    def add_part(self, byte: int, shift: int, term: str) -> None:
        """Add a term for some bits of a byte, from bit ``shift`` up."""
        self._parts.setdefault(byte, []).append((shift, term))

    def segments(self) -> Iterator[FrameSegment]:
        """List all bytes of the frame in order, each in one segment."""
        byte = 0
        while byte < self._length:
            if byte in self._whole:
                segment = FrameSegment(byte, *self._whole[byte])
            # Terms stand from the lowest bit up, in whatever order they were added.
            elif byte in self._parts:
                terms = tuple(term for _, term in sorted(self._parts[byte]))
                segment = FrameSegment(byte, 1, None, terms)
            else:
                end = byte
                while end < self._length and not (
                    end in self._whole or end in self._parts
                ):
                    end += 1
                segment = FrameSegment(byte, end - byte, None)
            yield segment
            byte += segment.length
