"""Ranges of electronic data sheets contain the same values as the limits that they
become.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from icdgen.definitions.eds_ranges import ALL, Range, limited

ENDS = [None, *(Fraction(half, 2) for half in range(-3, 4))]
RANGES = [Range(*parts) for parts in product(ENDS, ENDS, (False, True), (False, True))]
VALUES = [Fraction(quarter, 4) for quarter in range(-10, 11)]


def contains(range_, value):
    low, high, is_low_in, is_high_in = range_
    return (low is None or low < value or (is_low_in and low == value)) and (
        high is None or value < high or (is_high_in and value == high)
    )


def test_the_integers_of_a_range_are_those_between_its_integer_ends():
    for range_ in RANGES:
        low, high = range_.of_integers()
        assert (low is None, high is None) == (range_.low is None, range_.high is None)
        assert all(end is None or end.denominator == 1 for end in (low, high))
        for value in range(-5, 6):
            is_between = (low is None or low <= value) and (
                high is None or value <= high
            )
            assert is_between == contains(range_, value), (range_, value)


def test_a_range_within_another_has_the_values_of_both():
    for first, second in product(RANGES[::3], RANGES[::5]):
        both = first.within(second)
        for value in VALUES:
            expected = contains(first, value) and contains(second, value)
            assert contains(both, value) == expected, (first, second, value)


@pytest.mark.parametrize(
    ("type_", "range_", "limits"),
    [
        ("uint", Range(Fraction(0), Fraction(255)), {}),  # all values
        ("uint", Range(Fraction(1), Fraction(254)), {"min": 1, "max": 254}),
        ("int", Range(Fraction(-128), Fraction(126)), {"max": 126}),
        ("int", ALL, {}),
        ("float", Range(Fraction(1, 2), Fraction(2), False, True), {"above": 0.5, "max": 2}),
        ("float", Range(Fraction(2), Fraction(2)), {"min": 2, "max": 2}),
        ("float", Range(Fraction(2), Fraction(1)), {}),  # no value at all
        ("float", Range(None, Fraction(10) ** 400), {}),  # larger than all floats
        ("enum", Range(Fraction(1), Fraction(2)), {}),
    ],
)  # fmt: skip
def test_limits_are_those_that_exclude_values_of_the_type(type_, range_, limits):
    assert limited({"type": type_}, 8, range_) == limits
