"""Positions of values in bytes. 'Bits' in ``docs/reference/icd-format.md`` describes
the numbering.

`pieces_at` returns the runs of bits within bytes of a value of given position, width
and orders, `bits_of` its single bits.
"""

from __future__ import annotations

from functools import lru_cache

from icdgen.frozen import NamedTuple


class Piece(NamedTuple):
    """A run of bits of a value within one byte."""

    byte: int
    shift: int  # lowest bit of the run in the byte; 0 is the least significant
    bits: int
    at: int  # lowest bit of the run in the value

    @property
    def mask(self) -> int:
        """Mask of the run within its byte."""
        return self.low_mask << self.shift

    @property
    def low_mask(self) -> int:
        """Mask of the run once it is shifted down to bit 0."""
        return (1 << self.bits) - 1

    @property
    def is_byte(self) -> bool:
        """Whether the run is all of its byte."""
        return self.bits == 8

    @property
    def reaches_top(self) -> bool:
        """Whether the run has the most significant bit of its byte, so that shifting it
        down leaves no other bits.
        """
        return self.shift + self.bits == 8


@lru_cache(maxsize=65536)
def pieces_at(at: int, bits: int, byte_order: str, bit_order: str) -> tuple[Piece, ...]:
    """Return the pieces of a value, in the order of their bytes."""
    runs = []
    start, end = at, at + bits
    while start < end:
        byte, first = divmod(start, 8)
        count = min(8 - first, end - start)
        # With msb0, the run begins at the top of the byte.
        shift = first if bit_order == "lsb0" else 8 - first - count
        runs.append((byte, shift, count))
        start += count
    # In big-endian order, the last run has the least significant bits.
    pieces, below = [], 0
    for byte, shift, count in runs if byte_order == "little" else reversed(runs):
        pieces.append(Piece(byte, shift, count, below))
        below += count
    return tuple(pieces if byte_order == "little" else reversed(pieces))


def bits_of(at: int, bits: int, byte_order: str, bit_order: str) -> list[int]:
    """Return the bits of a value in the frame, the least significant first, counted in
    the bit order.
    """
    pieces = sorted(
        pieces_at(at, bits, byte_order, bit_order), key=lambda piece: piece.at
    )
    return [
        8 * piece.byte + (bit if bit_order == "lsb0" else 7 - bit)
        for piece in pieces
        for bit in range(piece.shift, piece.shift + piece.bits)
    ]
