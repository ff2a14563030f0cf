"""Formulas are computed exactly, without rounding, and non-linear formulas are refused."""

from __future__ import annotations

import re
from fractions import Fraction
from math import gcd

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.icd import exact, formula
from icdgen.icd.formula import FormulaError, Scale, parse

DECIMALS = st.builds(
    lambda digits_before, digits: (
        f"{digits_before}.{digits}" if digits else str(digits_before)
    ),
    st.integers(0, 10**6),
    st.text("0123456789", max_size=8),
)


def terms(depth: int) -> st.SearchStrategy[tuple[str, Fraction, Fraction]]:
    """Draw linear expressions as text, with their slope and constant."""
    number = DECIMALS.map(lambda text: (text, Fraction(0), Fraction(text)))
    variable = st.just(("raw", Fraction(1), Fraction(0)))
    if depth == 0:
        return number | variable
    inner = terms(depth - 1)
    return st.one_of(
        inner,
        st.builds(
            lambda a, b: (f"({a[0]} + {b[0]})", a[1] + b[1], a[2] + b[2]), inner, inner
        ),
        st.builds(
            lambda a, b: (f"({a[0]}-{b[0]})", a[1] - b[1], a[2] - b[2]), inner, inner
        ),
        st.builds(lambda a: (f"-{a[0]}", -a[1], -a[2]), inner),
        st.builds(
            lambda a, n: (f"{a[0]}*{n}", a[1] * Fraction(n), a[2] * Fraction(n)),
            inner,
            DECIMALS,
        ),
        st.builds(
            lambda n, a: (f"{n} * {a[0]}", a[1] * Fraction(n), a[2] * Fraction(n)),
            DECIMALS,
            inner,
        ),
        st.builds(
            lambda a, n: (f"{a[0]}/{n}", a[1] / Fraction(n), a[2] / Fraction(n)),
            inner,
            DECIMALS.filter(Fraction),
        ),
    )


LINEAR = terms(3).filter(
    lambda term: term[1] != 0 and len(term[0]) <= formula.MAX_LENGTH
)
SCALES = st.builds(
    Scale,
    st.fractions(max_denominator=10**12).filter(bool),
    st.fractions(max_denominator=10**12),
)


@given(LINEAR, st.integers(-(2**63), 2**64 - 1))
def test_the_value_is_that_of_the_text(term, raw):
    text, slope, constant = term
    assert parse(text).physical(raw) == slope * raw + constant


@given(LINEAR, st.integers(-(2**63), 2**64 - 1))
def test_a_formula_for_the_raw_value_is_solved_for_the_physical_one(term, raw):
    text, slope, constant = term
    scale = parse("raw = " + text.replace("raw", "value"))
    assert slope * scale.physical(raw) + constant == raw


@given(SCALES, st.integers(-(2**63), 2**64 - 1))
def test_raw_to_physical_and_back_is_the_identity(scale, raw):
    assert scale.raw(scale.physical(raw)) == raw


@given(SCALES, st.integers(-(2**63), 2**64 - 1))
def test_the_integer_form_is_the_same_number_in_lowest_terms(scale, raw):
    p, c, q = exact.terms(scale)
    assert Fraction(raw * p + c, q) == scale.physical(raw)
    assert q > 0
    assert gcd(p, c, q) == 1


@pytest.mark.parametrize(
    ("text", "factor", "offset"),
    [
        ("raw", 1, 0),
        ("raw*0.01", Fraction(1, 100), 0),
        ("raw/10000.0", Fraction(1, 10000), 0),
        ("raw*0.48828125", Fraction(125, 256), 0),
        ("(raw - 32)*5/9", Fraction(5, 9), Fraction(-160, 9)),
        ("raw = value*1000.0", Fraction(1, 1000), 0),
        ("raw = (value + 40)*2", Fraction(1, 2), -40),
        ("value = raw*2", 2, 0),
        ("1e-3*raw + 2.5E1", Fraction(1, 1000), 25),
        ("--raw", 1, 0),
        ("raw*2^-19", Fraction(1, 2**19), 0),
        ("raw*4.656612873077393e-10", Fraction(4656612873077393, 10**25), 0),
        ("-2^2*raw + (1/2)^3", -4, Fraction(1, 8)),
        ("raw/10^9 - 2^0", Fraction(1, 10**9), -1),
        ("raw = value*2^24", Fraction(1, 2**24), 0),
        ("10-raw", -1, 10),
    ],
)
def test_formulas_may_be_spelt_in_several_ways(text, factor, offset):
    assert parse(text) == Scale(Fraction(factor), Fraction(offset))


@given(st.text("raw vlue=+-*/^().0159e ", max_size=30))
def test_any_other_text_is_refused_with_a_reason(text):
    try:
        scale = parse(text)
    except FormulaError as error:
        assert str(error)
    else:
        assert scale.factor != 0


@pytest.mark.parametrize(
    ("factor", "offset", "large"),
    [
        (2**180, 2**240, False),
        (2**180 + 1, 0, True),
        (-(2**180), -(2**240), False),
        (-(2**180) - 1, 0, True),
        (Fraction(1, 2**180), 0, False),
        (Fraction(1, 2**180 + 1), 0, True),
        (1, 2**240 + 1, True),
        (Fraction(1, 2**100), Fraction(1, 3**80), True),
    ],
)
def test_numbers_too_large_for_a_language_are_refused(factor, offset, large):
    assert exact.is_too_large(Scale(Fraction(factor), Fraction(offset))) is large


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("raw^2", "it is not linear in `raw`"),
        ("2^raw", "the exponent after `^` is not a whole number up to 999"),
        ("raw*2^0.5", "the exponent after `^` is not a whole number up to 999"),
        ("raw*2^1000", "the exponent after `^` is not a whole number up to 999"),
        ("raw*2^", "it ends too early"),
        ("raw*2^-", "it ends too early"),
        ("raw*2^(3)", "the exponent after `^` is not a whole number up to 999"),
        ("raw*2^3^2", "`^` follows `^`; use parentheses"),
        ("raw*0^-1", "it divides by zero"),
        ("raw*(1e99^999)^999", "a power is too large to be meant"),
    ],
)
def test_powers_that_are_refused(text, why):
    with pytest.raises(FormulaError, match=re.escape(why)):
        parse(text)
