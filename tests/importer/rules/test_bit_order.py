"""Bits of printed positions, compared with bits counted one by one in a frame."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.importer.rules.bit_order import (
    ORDERS,
    Order,
    bits_of,
    bits_of_register,
    run_of,
)
from icdgen.importer.rules.positions import (
    MONOTONIC,
    bits_between,
    is_list,
    is_separator,
    runs_of,
)

LITTLE_LSB, BIG_MSB, BIG_LSB, LITTLE_MSB = ORDERS
STARTS, SIZES = st.integers(0, 30), st.integers(1, 40)
ORDER = st.sampled_from(ORDERS)


@pytest.mark.parametrize(
    ("order", "bits"),
    [
        (LITTLE_LSB, [(0, 6), (0, 7), (1, 0), (1, 1), (1, 2)]),
        (BIG_MSB, [(1, 5), (1, 6), (1, 7), (0, 0), (0, 1)]),
        (BIG_LSB, [(1, 0), (1, 1), (1, 2), (0, 6), (0, 7)]),
        (LITTLE_MSB, [(0, 0), (0, 1), (1, 5), (1, 6), (1, 7)]),
    ],
)
def test_bits_are_listed_from_the_least_significant_one(order, bits):
    assert bits_of(6, 5, order) == bits


def test_bits_of_a_register_are_counted_from_its_last_or_first_byte():
    assert bits_of_register(6, 4, 3, "big") == [(2, 6), (2, 7), (1, 0), (1, 1)]
    assert bits_of_register(6, 4, 3, "little") == [(0, 6), (0, 7), (1, 0), (1, 1)]


@given(STARTS, SIZES, ORDER, ORDER)
def test_a_run_has_the_bits_from_which_it_comes(at, size, order, preferred):
    run = run_of(bits_of(at, size, order), preferred)
    assert run is not None
    first, chosen = run
    assert bits_of(first, size, chosen) == bits_of(at, size, order)
    # The preferred order is taken if it can be.
    if any(
        bits_of(start, size, preferred) == bits_of(at, size, order)
        for start in range(at - 8 if at > 8 else 0, at + 8)
    ):
        assert chosen == preferred


def test_bits_with_a_gap_or_in_another_sequence_are_no_run():
    assert run_of([(0, 0), (0, 2)], LITTLE_LSB) is None
    assert run_of([(0, 1), (0, 0)], LITTLE_LSB) is None
    assert run_of([(0, 0), (0, 0)], LITTLE_LSB) is None
    assert run_of([(3, 5)], BIG_MSB) == (26, BIG_MSB)
    assert run_of([(0, 7), (1, 0)], BIG_MSB) == (7, LITTLE_LSB)
    # Without the preferred order, the order of `ORDERS` decides.
    whole = bits_of(0, 16, BIG_MSB)
    assert run_of(whole, LITTLE_MSB) == (0, BIG_MSB)


@pytest.mark.parametrize(
    ("text", "runs"),
    [
        ("0, 2", [(0, 0), (2, 2)]),
        ("3 and 5-7", [(3, 3), (5, 7)]),
        ("7-5; 3", [(3, 3), (5, 7)]),
        ("0 to 3 & 4..6", [(0, 6)]),
        ("9+8/7", [(7, 9)]),
        ("1, 1, 2", [(1, 2)]),
        ("10 – 12,14", [(10, 12), (14, 14)]),
        ("1 AND 3", [(1, 1), (3, 3)]),
    ],
)
def test_a_list_gives_ascending_runs(text, runs):
    assert is_list(text) and is_list(f" {text} ")
    assert runs_of(text) == runs


@pytest.mark.parametrize("text", ["3", "3-5", "", "a, b", "1,", "1 2", "1 sand 2"])
def test_another_text_is_no_list(text):
    assert not is_list(text)


def test_a_dash_makes_a_range_and_separates_nothing():
    for text in (", ", ";", " & ", "+", "/", " and ", " AND "):
        assert is_separator(text)
    for text in ("-", " to ", "", " ", "..", ", and ,"):
        assert not is_separator(text)


def readings(first, last, order):
    """Return the sets of bits that a printed range can mean, and count them."""
    (low, start), (high, end) = first, last
    inner = {(byte, n) for byte in range(low + 1, high) for n in range(8)}
    up = {(low, n) for n in range(8) if n >= start}
    up |= {(high, n) for n in range(8) if n <= end}
    down = {(low, n) for n in range(8) if n <= start}
    down |= {(high, n) for n in range(8) if n >= end}
    for numbers in (up | inner, down | inner):
        lsb = order.bit_order == "lsb0"
        yield {(byte, n if lsb else 7 - n) for byte, n in numbers}


@pytest.mark.parametrize("order", ORDERS)
def test_the_size_decides_how_a_range_over_bytes_is_counted(order):
    for start, end, high, size in product(
        range(8), range(8), (1, 3), (2, 5, 9, 16, 24, 25, 32)
    ):
        first, last = (0, start), (high, end)
        fitting = [bits for bits in readings(first, last, order) if len(bits) == size]
        bits = bits_between(first, last, size, order)
        if len(fitting) != 1:
            assert bits is None
            continue
        assert bits is not None and set(bits) == fitting[0] and len(bits) == size
        weights = [
            8 * (byte if order.byte_order == "little" else -byte) + weight
            for byte, weight in bits
        ]
        assert weights == sorted(weights)


def test_bit_numbers_ascend_through_bytes_in_the_first_two_orders():
    expected = [Order("little", "lsb0"), Order("big", "msb0")]
    assert list(MONOTONIC) == expected
    for order in ORDERS:
        bits = bits_of(0, 16, order)
        numbers = [
            8 * byte + (weight if order.bit_order == "lsb0" else 7 - weight)
            for byte, weight in bits
        ]
        ascends = numbers in (sorted(numbers), sorted(numbers, reverse=True))
        assert ascends == (order in MONOTONIC)
