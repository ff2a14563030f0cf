"""Formulas of fields and derived values have one grammar, with exact and with
floating-point results.
"""

from __future__ import annotations

import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.icd import derived, formula
from icdgen.icd.expression import MAX_DEPTH, MAX_DIGITS, FormulaError
from tests.limits import assert_limits

TEXTS = st.recursive(
    st.sampled_from(["raw", "raw", "2", "0.5", "3e2"]),
    lambda inner: st.one_of(
        st.builds("{}{}{}".format, inner, st.sampled_from([" + ", "-", "*"]), inner),
        st.builds("({})".format, inner),
        st.builds("(0 - {})".format, inner),
        st.builds("{}/2.5".format, inner),
        st.builds("({})^{}".format, inner, st.integers(0, 4)),
    ),
    max_leaves=8,
)


@given(TEXTS, st.integers(-20, 20))
def test_a_derived_value_of_one_field_is_the_value_of_the_same_formula_of_the_field(
    text, raw
):
    try:
        terms = formula.coefficients(text)
    except FormulaError:
        return
    exact = sum((term * raw**power for power, term in enumerate(terms)), Fraction(0))
    result = derived.parse(text, ["raw"]).double([float(raw)])
    # No intermediate value is larger than with all signs positive, so this bounds the
    # errors of rounding.
    largest = derived.parse(text.replace("-", "+"), ["raw"]).double([float(abs(raw))])
    assert abs(Fraction(result) - exact) <= Fraction(max(largest, 1.0)) / 10**12


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("raw*(2 + 1", "it ends too early"),
        ("raw*", "it ends too early"),
        ("raw*2)", "`)` is not expected there"),
        ("raw 2", "`2` is not expected there"),
        ("raw + *2", "`*` is not expected there"),
        ("raw*2^3^2", "`^` follows `^`; use parentheses"),
        ("raw/(1 - 1)", "it divides by zero"),
        ("raw*0^-1", "it divides by zero"),
        ("raw*(1e99^999)^999", "a power is too large to be meant"),
        (
            "raw*" + "1" * (MAX_DIGITS + 1),
            f"a number has more than {MAX_DIGITS} digits",
        ),
        (
            "(" * MAX_DEPTH + "raw" + ")" * MAX_DEPTH,
            f"more than {MAX_DEPTH} parentheses or signs are open at once",
        ),
        ("raw & 1", "`&` is not part of a formula"),
    ],
)
def test_formulas_of_fields_and_derived_values_have_the_same_errors(text, why):
    for parse in (formula.coefficients, lambda text: derived.parse(text, ["raw"])):
        with pytest.raises(FormulaError, match=re.escape(why)):
            parse(text)


def is_formula(text: str) -> bool:
    try:
        formula.coefficients(text)
    except FormulaError:
        return False
    return True


def test_limits_of_the_text_of_a_formula():
    assert_limits(lambda n: is_formula("raw + 1".ljust(n)), most=1000)
    assert_limits(lambda n: is_formula("raw*" + "1" * n), least=1, most=40)
    assert_limits(lambda n: is_formula("(" * n + "raw" + ")" * n), most=49)
    assert_limits(lambda n: is_formula("-" * n + "raw"), most=49)
    assert_limits(lambda n: is_formula(f"raw^{n}"), least=1, most=15)
    assert_limits(lambda n: is_formula(f"raw*raw^{n}"), least=0, most=14)
    assert_limits(lambda n: is_formula(f"raw*1^{n}"), most=999)
    assert_limits(lambda n: is_formula(f"raw + {2**39}^{n}"), most=100)
    assert is_formula("raw" + "+(raw)" * 60), "closed parentheses do not count"
    assert is_formula("raw*1e99") and not is_formula("raw*1e100")
    assert is_formula("raw*0^1") is False and not is_formula("raw*0^-1")
    assert is_formula("raw + 0^2")


@pytest.mark.parametrize(
    ("text", "is_inverse"),
    [("raw = value*2", True), (" raw=value", True), ("value = raw*2", False), ("raw*2", False)],
)  # fmt: skip
def test_a_formula_for_the_raw_value_begins_with_raw(text, is_inverse):
    assert formula.is_inverse(text) == is_inverse


def test_the_longer_of_a_number_and_a_name_is_used():
    assert derived.parse("1 + 1A", ["1A", "1"]).fields == ("1A",)
    assert derived.parse("10 + 1B", ["1", "1B"]).numbers == (10.0,)
    assert derived.parse(")x*2", [")x"]).fields == (")x",)
