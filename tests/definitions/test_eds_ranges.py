"""Ranges of electronic data sheets contain the same values as the limits that they
become.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.eds_ranges import ALL, Range, limited, stated_range
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.model import Definitions
from tests.limits import assert_limits

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


def test_a_limit_of_a_float_has_fewer_than_30_characters():
    def is_limit(digits):
        end = Fraction(10 ** (digits - 1))
        return limited({"type": "float"}, 32, Range(end)) == {"min": end}

    assert_limits(is_limit, most=29)


ONE, TWO = Fraction(1), Fraction(2)


@pytest.mark.parametrize(
    ("type_", "expected"),
    [
        (None, Range(ONE, TWO)),
        ("inclusiveMinInclusiveMax", Range(ONE, TWO)),
        ("inclusiveMinExclusiveMax", Range(ONE, TWO, True, False)),
        ("exclusiveMinInclusiveMax", Range(ONE, TWO, False, True)),
        ("exclusiveMinExclusiveMax", Range(ONE, TWO, False, False)),
        ("ATLEAST", Range(ONE, None, True, False)),
        ("greaterThan", Range(ONE, None, False, False)),
        ("atMost", Range(None, TWO, False, True)),
        ("lessThan", Range(None, TWO, False, False)),
        ("other", Range(None, None, False, False)),
    ],
)
def test_the_kind_of_a_range_decides_which_ends_count(type_, expected):
    kind = "" if type_ is None else f'rangeType="{type_}"'
    text = f'<Range><MinMaxRange min="1" max="4/2" {kind}/></Range>'
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    sheets = Sheets(root, (), Definitions("a.xml"))
    assert stated_range(sheets, root) == expected
    empty = safe_xml.parse("a.xml", b"<Range/>", account=Account())
    assert stated_range(sheets, empty) == ALL


def test_an_end_that_is_no_number_does_not_limit():
    text = '<Range><MinMaxRange min="x" max="2"/></Range>'
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    sheets = Sheets(root, (), Definitions("a.xml"))
    assert stated_range(sheets, root) == Range(None, TWO)
