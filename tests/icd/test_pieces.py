"""Runs of bits within bytes, against each bit by itself."""

from __future__ import annotations

import random

import pytest

from icdgen.icd.pieces import Piece, bits_of, pieces_at


@pytest.mark.parametrize(
    ("at", "bits", "orders", "pieces"),
    [
        (0, 8, ("little", "lsb0"), [(0, 0, 8, 0)]),
        (0, 16, ("little", "lsb0"), [(0, 0, 8, 0), (1, 0, 8, 8)]),
        (0, 16, ("big", "lsb0"), [(0, 0, 8, 8), (1, 0, 8, 0)]),
        (12, 12, ("big", "msb0"), [(1, 0, 4, 8), (2, 0, 8, 0)]),
        (12, 12, ("little", "lsb0"), [(1, 4, 4, 0), (2, 0, 8, 4)]),
        (5, 2, ("little", "msb0"), [(0, 1, 2, 0)]),
        (6, 11, ("big", "lsb0"), [(0, 6, 2, 9), (1, 0, 8, 1), (2, 0, 1, 0)]),
    ],
)
def test_a_value_is_in_these_runs_of_bits(at, bits, orders, pieces):
    assert pieces_at(at, bits, *orders) == tuple(Piece(*piece) for piece in pieces)


@pytest.mark.parametrize("byte_order", ["little", "big"])
@pytest.mark.parametrize("bit_order", ["lsb0", "msb0"])
def test_the_runs_have_the_bits_of_the_value(byte_order, bit_order):
    source = random.Random(3)
    for at in range(9):
        for bits in (1, 2, 7, 8, 9, 15, 16, 17, 31, 64):
            frame = source.randbytes(10)
            pieces = pieces_at(at, bits, byte_order, bit_order)
            value = sum(
                ((frame[piece.byte] & piece.mask) >> piece.shift) << piece.at
                for piece in pieces
            )
            taken = [
                frame[bit // 8] >> (bit % 8 if bit_order == "lsb0" else 7 - bit % 8) & 1
                for bit in bits_of(at, bits, byte_order, bit_order)
            ]
            assert value == sum(bit << n for n, bit in enumerate(taken))
            # Consecutive numbers of bits, whichever is the least significant.
            assert sorted(bits_of(at, bits, byte_order, bit_order)) == list(
                range(at, at + bits)
            )
            assert sorted(piece.at for piece in pieces)[0] == 0
            assert [piece.byte for piece in pieces] == list(
                range(at // 8, (at + bits - 1) // 8 + 1)
            )


def test_masks_of_a_run():
    run = Piece(2, 3, 4, 0)
    assert (run.mask, run.low_mask, run.is_byte, run.reaches_top) == (0x78, 0xF, False, False)  # fmt: skip
    assert not Piece(0, 0, 7, 0).is_byte
    assert Piece(0, 4, 4, 0).reaches_top and not Piece(0, 4, 4, 0).is_byte
    assert Piece(0, 0, 8, 0).is_byte and Piece(0, 0, 8, 0).reaches_top
