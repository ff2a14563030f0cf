"""Derived values: the meaning of formulas, and that each step is computed in doubles."""

from __future__ import annotations

import math
from fractions import Fraction
from importlib import import_module

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.icd import derived
from icdgen.icd.derived import parse
from icdgen.icd.formula import FormulaError
from icdgen.shipped import provide_runtime

NAMES = ("Lon", "Lon HP", "C", "N0", "C/N0", "2D", "W_SF", "x", "-")
NUMBERS = st.floats() | st.sampled_from(
    (0.0, -0.0, 1.0, math.inf, -math.inf, math.nan, 5e-324, 1.7e308)
)


provide_runtime()
_derived = import_module("icdgen_runtime._derived")


def result(text: str, **values: float) -> float:
    expression = parse(text, values)
    return expression.double([values[name] for name in expression.fields])


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("Lon + Lon HP", ("Lon", "Lon HP")),
        ("Lon HP-Lon", ("Lon HP", "Lon")),
        ("C/N0", ("C/N0",)),
        ("C / N0", ("C", "N0")),
        ("C*N0", ("C", "N0")),
        ("2D*2", ("2D",)),
        ("x*10^W_SF", ("x", "W_SF")),
        ("(x)", ("x",)),
        ("x - C", ("x", "C")),
    ],
)
def test_the_longest_matching_name_is_used(text, fields):
    assert set(parse(text, NAMES).fields) == set(fields)


@pytest.mark.parametrize("text", ["Long + Lon", "Lonx", "x1", "x_y + Lon", "HP"])
def test_a_name_does_not_end_within_a_word(text):
    with pytest.raises(FormulaError, match="there is no field"):
        parse(text, NAMES)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 + x*3", 17.0),
        ("2 - x - 3", -6.0),
        ("60/x/2", 6.0),
        ("(2 + x)*3", 21.0),
        ("-x^2", -25.0),
        ("(-x)^2", 25.0),
        ("x^0", 1.0),
        ("x^-2", 0.04),
        ("2^x", 32.0),
        ("x*2/3", 10 / 3),
        ("2/3*x", 2 / 3 * 5),
        ("x + 1/3 + 1/3", 5 + 1 / 3 + 1 / 3),
        ("x + (1/3 + 1/3)", 5 + 2 / 3),
        ("--x", 5.0),
        ("x - x*2^-1", 2.5),
    ],
)
def test_operations_are_done_in_the_usual_order(text, value):
    assert result(text, x=5.0) == value


def test_numbers_without_a_field_are_exact_and_rounded_once():
    (number,) = parse("x + (0.1 + 0.2)", ["x"]).numbers
    assert number == 0.3 != 0.1 + 0.2
    (number,) = parse("x*(10^40 + 1 - 10^40)", ["x"]).numbers
    assert number == 1.0


def test_division_by_zero_follows_ieee_754():
    assert result("x/(y - y)", x=1.0, y=2.0) == math.inf
    assert result("x/(y*0)", x=-1.0, y=2.0) == -math.inf
    assert result("1/(y*0)", y=-2.0) == -math.inf
    assert math.isnan(result("x/x", x=0.0))
    assert result("x^-3", x=0.0) == math.inf


def test_a_minus_gives_no_negative_zero():
    assert math.copysign(1.0, result("-x", x=0.0)) == 1.0


@given(NUMBERS, NUMBERS)
def test_the_runtime_divides_as_the_reference(dividend, other):
    assert _same(derived.quotient(dividend, other), _derived.quotient(dividend, other))
    if math.isfinite(dividend) and math.isfinite(other) and other:
        try:
            exact = Fraction(dividend) / Fraction(other)
            assert (
                derived.quotient(dividend, other) == exact.numerator / exact.denominator
            )
        except OverflowError:
            assert math.isinf(derived.quotient(dividend, other))


@given(NUMBERS, st.integers(-65535, 65535) | st.integers(-20, 20))
def test_the_runtime_has_the_powers_of_the_reference(base, exponent):
    assert _same(
        derived.power(base, float(exponent)), _derived.power(base, float(exponent))
    )


@pytest.mark.parametrize("exponent", range(23))
def test_powers_of_ten_are_exact_as_long_as_they_can_be(exponent):
    assert derived.power(10.0, float(exponent)) == 10**exponent
    assert derived.power(10.0, float(-exponent)) == 1 / 10**exponent


@given(NUMBERS)
def test_powers_are_found_by_squaring(x):
    square = x * x
    assert _same(derived.power(x, 5.0), 1.0 * x * (square * square))
    assert _same(derived.power(x, 3.0), 1.0 * x * square)


def test_sums_and_products_are_commutative():
    assert parse("x*2 + C", NAMES).sense({}) == parse("C + 2*x", NAMES).sense({})
    assert parse("x - C", NAMES).sense({}) != parse("C - x", NAMES).sense({})
    assert parse("x - C", NAMES).sense({"C": "N0"}) == parse("x - N0", NAMES).sense({})


@given(st.text("x+-*/^() 0123456789.eE\u00e9_[]", max_size=40))
def test_any_text_is_a_formula_or_refused_with_a_reason(text):
    try:
        expression = parse(text, ["x", "0e", "+"])
    except FormulaError as error:
        assert str(error)
    else:
        assert isinstance(expression.double([1.5] * len(expression.fields)), float)


def test_a_long_formula_is_read():
    assert result("+".join(["x"] * 500), x=1.0) == 500.0


def _same(first: float, other: float) -> bool:
    return first == other or (math.isnan(first) and math.isnan(other))


@pytest.mark.parametrize(
    ("text", "is_accepted"),
    [
        ("x^15", True),
        ("x^16", False),
        ("x*1^999", True),
        ("x*1^1000", False),
        ("V[0]", False),
        ("V*2", True),
        ("V_2", False),
        ("x^-V", False),
    ],
)
def test_exponents_are_limited_and_names_end_with_their_word(text, is_accepted):
    try:
        derived.parse(text, ["x", "V"])
    except FormulaError:
        assert not is_accepted
    else:
        assert is_accepted


def test_the_sense_of_a_formula_ignores_the_order_of_terms_and_factors():
    names = ["A", "B", "C"]

    def sense(text: str, **renamed: str) -> str:
        return derived.parse(text, names).sense(renamed)

    assert sense("A + B*C") == sense("C*B + A") == "((`B`*`C`)+`A`)"
    assert sense("A - B") != sense("B - A") and sense("A/B") != sense("B/A")
    assert sense("A*2", A="New") == "(2.0*`New`)"
    assert sense("A*2", B="New") == "(2.0*`A`)"
