"""Positions of XTCE have exactly the bits that the ICD gives to a field."""

from __future__ import annotations

from itertools import product

import pytest

from icdgen.backends.xtce.places import BitRun, gaps, run_of, run_of_all
from icdgen.icd.layout import Orders, Scalar
from icdgen.icd.pieces import pieces_at
from icdgen.icd.places import NodePlace
from tests.icd.files import loaded


def node_with(folder, byte_order, bit_order):
    text = (
        f"icdgen: 1\nnode: {{name: demo, title: Demo, byte_order: {byte_order}, "
        f"bit_order: {bit_order}}}\n"
    )
    return loaded(folder, text).icd.nodes[0]


def place(at, bits):
    scalar = Scalar(name="A", type="uint", bits=bits)
    return NodePlace((), scalar, None, at, bits, Orders())


def bits_of_run(run: BitRun) -> list[tuple[int, int]]:
    """Return byte and bit of each bit of a value, the most significant first."""
    numbers = range(run.at, run.at + run.bits)
    if run.is_little:
        return [(n // 8, n % 8) for n in reversed(numbers)]
    return [(n // 8, 7 - n % 8) for n in numbers]


def bits_of_pieces(at, bits, byte_order, bit_order) -> list[tuple[int, int]]:
    places = {}
    for piece in pieces_at(at, bits, byte_order, bit_order):
        for n in range(piece.bits):
            places[piece.at + n] = (piece.byte, piece.shift + n)
    return [places[n] for n in reversed(range(bits))]


def test_a_run_has_the_bits_of_its_field_in_the_order_of_the_value(tmp_path):
    without_run = 0
    for byte_order, bit_order in product(("little", "big"), ("lsb0", "msb0")):
        node = node_with(tmp_path, byte_order, bit_order)
        for at, bits in product(range(17), range(1, 26)):
            run = run_of(place(at, bits), node)
            expected = bits_of_pieces(at, bits, byte_order, bit_order)
            if run is not None:
                assert bits_of_run(run) == expected, (byte_order, bit_order, at)
                assert run.is_little == (expected[0][0] > expected[-1][0]), (
                    "a single byte or the first byte first is not little"
                )
                continue
            without_run += 1
            # No run of either direction has these bits.
            starts = range(48)
            assert expected not in [
                bits_of_run(BitRun(start, bits, is_little))
                for start, is_little in product(starts, (False, True))
            ]
    assert without_run > 0


@pytest.mark.parametrize(
    ("run", "is_usual"),
    [
        (BitRun(3, 5), True),
        (BitRun(8, 16, True), True),
        (BitRun(8, 12, True), False),
        (BitRun(4, 16, True), False),
    ],
)
def test_only_whole_bytes_in_little_endian_order_are_usual(run, is_usual):
    assert run.is_usual == is_usual


def elements(bits, *positions):
    return [place(at, bits) for at in positions]


def test_adjacent_elements_are_one_run(tmp_path):
    node = node_with(tmp_path, "little", "lsb0")
    assert run_of_all(elements(16, 8, 24), node) == BitRun(8, 32, True)
    assert run_of_all(elements(8, 8, 16), node) == BitRun(8, 16)
    big = node_with(tmp_path, "big", "msb0")
    assert run_of_all(elements(4, 4, 8, 12), big) == BitRun(4, 12)


def test_elements_with_gaps_or_of_part_bytes_are_no_run(tmp_path):
    node = node_with(tmp_path, "little", "lsb0")
    assert run_of_all(elements(16, 8, 32), node) is None
    assert run_of_all(elements(12, 0, 12), node) is None  # not usual
    assert run_of_all(elements(4, 0, 4), node) is None  # the high half is first


@pytest.mark.parametrize(
    ("taken", "end", "unused"),
    [
        ([], 64, [(0, 64)]),
        ([], 65, [(0, 64), (64, 1)]),
        ([(0, 3)], 67, [(3, 64)]),
        ([(0, 3)], 68, [(3, 5), (8, 56), (64, 4)]),
        ([(0, 3)], 72, [(3, 5), (8, 64)]),
        ([(0, 8)], 80, [(8, 72)]),
        ([(8, 8), (0, 4)], 24, [(4, 4), (16, 8)]),
        ([(0, 16), (4, 4)], 24, [(16, 8)]),
        ([(0, 24)], 24, []),
    ],
)
def test_gaps_of_more_than_64_bits_are_split_at_byte_boundaries(taken, end, unused):
    runs = [BitRun(*place) for place in taken]
    assert [(run.at, run.bits) for run in gaps(runs, 0, end)] == unused
