"""Bits and shortest decimals of floats."""

from __future__ import annotations

import math
import random
import struct
from fractions import Fraction

import pytest

from icdgen.icd import floats


@pytest.mark.parametrize(
    ("value", "single", "double"),
    [
        (0.0, 0, 0),
        (-0.0, 1 << 31, 1 << 63),
        (1.0, 0x3F800000, 0x3FF0000000000000),
        (-1.5, 0xBFC00000, 0xBFF8000000000000),
        (math.inf, 0x7F800000, 0x7FF0000000000000),
        (-math.inf, 0xFF800000, 0xFFF0000000000000),
    ],
)
def test_a_number_has_these_bits(value, single, double):
    assert (floats.bits_of(value, 32), floats.bits_of(value, 64)) == (single, double)
    for raw, bits in ((single, 32), (double, 64)):
        back = floats.value_of(raw, bits)
        assert (back, math.copysign(1, back)) == (value, math.copysign(1, value))


def test_the_nearest_float_is_that_of_the_processor_or_its_neighbour_to_even():
    source = random.Random(1)
    for _ in range(300):
        raw = source.getrandbits(64)
        value = floats.value_of(raw, 64)
        if math.isfinite(value):
            assert floats.nearest(Fraction(value), 64) == (raw if value else 0)
    for raw in (0, 1, 2, 0x7FFFFF, 0x800000, 0x800001, 0x3F800000, 0x7F7FFFFE):
        low, high = (Fraction(floats.value_of(raw + n, 32)) for n in (0, 1))
        third = (high - low) / 3
        for sign, bit in ((1, 0), (-1, 1 << 31)):
            for exact, expected in (
                (low + third, raw),
                ((low + high) / 2, raw + raw % 2),
                (high - third, raw + 1),
            ):
                # A number that rounds to 0 keeps its sign.
                assert floats.nearest(sign * exact, 32) == expected | bit


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        (0x3DCCCCCD, "0.1"),
        (0x00000001, "1e-45"),
        (0x00800000, "1.1754944e-38"),
        (0x7F7FFFFF, "3.4028235e+38"),
        (0x80000000, "-0.0"),
        (0xC2F6E979, "-123.456"),
        (0x4B800000, "16777216.0"),
        (0x3F800001, "1.0000001"),
        (0x7FC00000, "nan"),
        (0xFF800000, "-inf"),
    ],
)
def test_a_single_has_its_shortest_decimal(raw, text):
    assert floats.text_of(floats.value_of(raw, 32), 32) == text


def test_no_shorter_decimal_means_the_same_single():
    source = random.Random(2)
    for _ in range(60):
        raw = source.getrandbits(31)
        (value,) = struct.unpack("<f", struct.pack("<I", raw))
        if not math.isfinite(value) or not value:
            continue
        text = floats.text_of(value, 32)
        assert floats.nearest(Fraction(text), 32) == raw
        digits = len(text.partition("e")[0].replace(".", "").strip("0"))
        if digits > 1:
            assert Fraction(f"{value:.{digits - 1}g}") != Fraction(text)
            shorter = Fraction(f"{value:.{digits - 1}g}")
            assert shorter >= 2**128 or floats.nearest(shorter, 32) != raw


def test_a_double_is_written_as_python_writes_it():
    assert floats.text_of(0.1, 64) == "0.1"
    assert floats.text_of(floats.value_of(0x3DCCCCCD, 32), 64) == "0.10000000149011612"
