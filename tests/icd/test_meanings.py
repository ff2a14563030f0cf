"""Special values and limits of fields."""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.icd import meanings
from icdgen.icd.located import unread
from icdgen.icd.meanings import Limits, Special


@pytest.mark.parametrize(
    ("kind", "bits", "value", "expected"),
    [
        ("uint", 8, 0, Special(0, "M")),
        ("int", 8, -1, Special(-1, "M")),
        ("enum", 8, 7, Special(7, "M")),
        ("uint", 8, "nan", None),
        ("uint", 8, 1.5, None),
        ("float", 32, 0, Special(0, "M", "0.0")),
        ("float", 32, 0.1, Special(0x3DCCCCCD, "M", "0.1")),
        ("float", 64, 0.1, Special(0x3FB999999999999A, "M", "0.1")),
        ("float", 32, -2.5, Special(0xC0200000, "M", "-2.5")),
        ("float", 32, "nan", Special(0x7FC00000, "M", "nan")),
        ("float", 64, "nan", Special(0x7FF8000000000000, "M", "nan")),
        ("float", 32, "inf", Special(0x7F800000, "M", "inf")),
        ("float", 32, "-inf", Special(0xFF800000, "M", "-inf")),
        ("float", 32, "-nan", None),
        ("float", 32, 3e39, None),
        ("float", 16, 1.5, None),
        ("float", 0, "nan", None),
    ],
)
def test_a_special_value_has_the_bits_and_the_shortest_text_of_its_type(
    kind, bits, value, expected
):
    assert meanings.special(kind, bits, value, "M") == expected


@pytest.mark.parametrize(
    ("number", "exact"),
    [(3, "3"), (0.1, "1/10"), (-1e-3, "-1/1000"), (1e22, "1" + "0" * 22)],
)
def test_numbers_of_a_file_are_the_decimals_that_are_written(number, exact):
    assert meanings.exact(number) == Fraction(exact)


@pytest.mark.parametrize(
    ("keys", "limits"),
    [
        ({}, None),
        ({"name": "A"}, None),
        ({"min": 0}, Limits(min=Fraction(0))),
        ({"max": 0.1, "name": "A"}, Limits(max=Fraction(1, 10))),
        ({"above": -1, "below": 1}, Limits(above=Fraction(-1), below=Fraction(1))),
    ],
)
def test_a_bound_of_zero_is_a_bound(keys, limits):
    item = type(unread())(unread().spot)
    item.update(keys)
    assert meanings.limits(item) == limits
