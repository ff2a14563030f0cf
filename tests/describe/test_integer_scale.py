"""Scales of whole numbers agree with exact arithmetic and never overflow."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from icdgen.describe.integer_scale import (
    IntegerScale,
    fits_bits,
    integer_bits,
    integer_scale,
    is_computable,
)
from icdgen.describe.steps import Steps
from icdgen.describe.storage import Storage, storage_bits, storage_of
from tests.limits import assert_limits


def accepted_values(steps: Steps, per: int) -> list[int]:
    """Return the values whose nearest raw value, ties to even, is in the range."""
    factor = Fraction(steps.p * per, steps.q)
    offset = Fraction(steps.c * per, steps.q)
    ends = [raw * factor + offset for raw in (steps.raw_min - 1, steps.raw_max + 1)]
    # `round` of a fraction rounds ties to even.
    return [
        value
        for value in range(int(min(ends)), int(max(ends)) + 1)
        if steps.raw_min <= round((value - offset) / factor) <= steps.raw_max
    ]


def test_setters_accept_all_values_whose_nearest_raw_value_is_in_range():
    for p, c, ends in product(
        (-3, -2, 1, 2, 3, 5), (-7, 0, 4), ((0, 3), (0, 4), (-3, 3), (-4, 5))
    ):
        steps = Steps(p, c, 1000, *ends)
        scale = integer_scale(steps)
        values = accepted_values(steps, 1000)
        exact = sorted(raw * p + c for raw in ends)
        assert (scale.least, scale.most) == (values[0], values[-1]), steps
        assert [scale.low, scale.high] == exact
        assert (scale.per, scale.factor, scale.offset) == (1000, p, c)


@pytest.mark.parametrize(
    ("p", "c", "q", "per"),
    [
        (1, 0, 1, 1000),
        (1, 0, 1000, 1000),
        (1, 0, 1001, None),
        (1, 0, 2000, 1_000_000),
        (2, 1, 2000, 1_000_000),  # the offset is not in thousandths
        (1, 0, 1_000_000, 1_000_000),
        (1, 0, 2_000_000, None),
        (2_000_000, 1, 2_000_000, None),
    ],
)
def test_thousandths_are_preferred_to_millionths(p, c, q, per):
    scale = integer_scale(Steps(p, c, q, 0, 9))
    assert (scale and scale.per) == per


@pytest.mark.parametrize("bits", [8, 32, 64])
def test_an_integer_fits_if_its_negative_does(bits):
    most = (1 << bits - 1) - 1
    assert_limits(lambda value: fits_bits(bits, 0, value), least=-most, most=most)


def test_no_value_of_the_storage_overflows():
    for storage in (Storage(3), Storage(3, True)):
        for factor, offset in product(range(-20, 21), range(-130, 131, 5)):
            raws = range(storage.min, storage.max + 1)
            values = [raw * factor for raw in raws]
            values += [raw * factor + offset for raw in raws] + [factor, offset]
            expected = all(-128 < value < 128 for value in values)
            assert is_computable(storage, factor, offset, 8) == expected


def test_an_integer_of_32_bits_is_used_if_it_stores_all_values():
    def bits(factor, offset=0, width=16):
        scale = IntegerScale(1000, factor, offset, 0, 9, 0, 9)
        return integer_bits(scale, Storage(width))

    largest = 0x7FFF_FFFF // 0xFFFF
    assert_limits(lambda factor: bits(factor) == 32, least=-largest, most=largest)
    assert_limits(lambda n: bits(1, n) == 32, most=0x7FFF_FFFF - 0xFFFF)
    assert bits(1, 0x7FFF_FFFF - 0xFFFE) == 64
    largest = ((1 << 63) - 1) // 0xFFFF_FFFF
    assert_limits(lambda factor: bits(factor, 0, 32) == 64, most=largest)
    assert bits(largest + 1, 0, 32) is None


def test_values_beyond_the_integer_do_not_count():
    far = 1 << 70
    low = IntegerScale(1000, 1, -5, 0, 9, -far, 9)
    high = IntegerScale(1000, 1, 5, 0, 9, 0, far)
    assert [integer_bits(scale, Storage(16)) for scale in (low, high)] == [32, 32]


def test_storage_is_the_smallest_integer_of_a_machine():
    widths = [storage_bits(bits) for bits in range(1, 65)]
    assert widths == [8] * 8 + [16] * 8 + [32] * 16 + [64] * 32
    assert storage_of(12, True) == Storage(16, True)
    ends = [(Storage(8, signed).min, Storage(8, signed).max) for signed in (0, 1)]
    assert ends == [(0, 255), (-128, 127)]
