"""Integer form of scales, and the limits of the arithmetic of all languages."""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.icd.exact import Terms, is_too_large, terms
from icdgen.icd.formula import Scale
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("factor", "offset", "expected"),
    [
        ("1/10", "0", Terms(1, 0, 10)),
        ("1/4", "-1/6", Terms(3, -2, 12)),
        ("-5/9", "160/9", Terms(-5, 160, 9)),
        ("3", "1/2", Terms(6, 1, 2)),
    ],
)
def test_terms_have_the_lowest_common_denominator(factor, offset, expected):
    assert terms(Scale(Fraction(factor), Fraction(offset))) == expected


@pytest.mark.parametrize("sign", [1, -1])
def test_terms_up_to_these_limits_need_128_bits(sign):
    factor, offset = 2**32, 2**63
    assert_limits(lambda p: Terms(sign * p, 0, 1).are_usual, most=factor)
    assert_limits(lambda c: Terms(1, sign * c, 1).are_usual, most=offset)
    assert_limits(lambda q: Terms(sign, 0, q).are_usual, most=factor)
    assert Terms(sign * factor, sign * offset, factor).are_usual


@pytest.mark.parametrize("sign", [1, -1])
def test_terms_up_to_these_limits_need_256_bits(sign):
    def is_accepted(factor: Fraction, offset: Fraction = Fraction(0)) -> bool:
        return not is_too_large(Scale(factor, offset))

    assert_limits(lambda p: is_accepted(Fraction(sign * p)), most=2**180)
    assert_limits(lambda q: is_accepted(Fraction(sign, q)), most=2**180)
    assert_limits(lambda c: is_accepted(Fraction(1), Fraction(sign * c)), most=2**240)
