"""Calculations of the runtime: calibrations, derived values and bits of floats."""

from __future__ import annotations

import math

import numpy
import pytest
from icdgen_runtime._curves import columns_on_curve, on_curve
from icdgen_runtime._derived import column, derived, power, quotient
from icdgen_runtime._errors import LengthError, RangeError, UnknownIdError, span_of
from icdgen_runtime._floats import (
    float32,
    float32_bits,
    float64,
    float64_bits,
    is_special,
)

# A step, a line and a parabola, then a piece without values.
CURVE = ((0.0, (7.0,)), (10.0, (1.0, 0.5)), (20.0, (2.0, 0.0, 3.0)), (30.0, ()))
ON_CURVE = {
    -1: 7.0,  # the first piece also continues below its beginning
    0: 7.0,
    9: 7.0,
    10: 1.0,
    19: 5.5,
    20: 2.0,
    22: 14.0,
    29: 245.0,
    30: math.nan,
    math.nan: math.nan,
}


def test_the_piece_of_a_calibration_begins_at_its_raw_value():
    for raw, expected in ON_CURVE.items():
        assert on_curve(CURVE, raw) == pytest.approx(expected, abs=0, nan_ok=True), raw


def test_columns_on_a_calibration_have_the_values_of_single_fields():
    values = columns_on_curve(numpy, CURVE, numpy.array(list(ON_CURVE)))
    assert [repr(float(value)) for value in values] == [
        repr(value) for value in ON_CURVE.values()
    ]


@pytest.mark.parametrize(
    "dividend, divisor, expected",
    [
        (7.0, 2.0, "3.5"),
        (1.0, 0.0, "inf"),
        (-1.0, 0.0, "-inf"),
        (1.0, -0.0, "-inf"),
        (-1.0, -0.0, "inf"),
        (0.0, 0.0, "nan"),
        (math.nan, 0.0, "nan"),
        (math.inf, 0.0, "inf"),
        (-0.0, 2.0, "-0.0"),
    ],
)
def test_division_by_zero_follows_ieee_754(dividend, divisor, expected):
    assert repr(quotient(dividend, divisor)) == expected


@pytest.mark.parametrize("exponent", range(-9, 10))
def test_powers_of_derived_values_are_exact_for_powers_of_two(exponent):
    assert power(2.0, exponent) == 2.0**exponent
    assert power(-2.0, exponent) == (-2.0) ** exponent


STEPS = {
    "+": [5.0, -1.0, math.inf],
    "-": [-1.0, -1.0, math.inf],
    "*": [6.0, 0.0, math.inf],
    "/": [2 / 3, -math.inf, math.inf],
    "^": [8.0, 1.0, math.inf],
}


@pytest.mark.parametrize("operator", STEPS)
def test_operands_of_a_derived_value_keep_their_order(operator):
    lefts, rights = [2.0, -1.0, math.inf], [3.0, 0.0, 2.0]
    derivation = (("left", "right"), (), ((operator, 0, 1),))
    pairs = zip(lefts, rights, strict=True)
    assert [derived(derivation, list(pair)) for pair in pairs] == STEPS[operator]
    columns = [numpy.array(lefts), numpy.array(rights)]
    assert list(column(numpy, derivation, columns)) == STEPS[operator]


def test_steps_of_a_derived_value_use_numbers_and_earlier_results():
    # (left + 10) * left
    derivation = (("left",), (10.0, 4.0), (("+", 0, 1), ("*", 3, 0), ("-", 4, 2)))
    assert derived(derivation, [3]) == 35.0
    assert list(column(numpy, derivation, [numpy.array([3, 0])])) == [35.0, -4.0]


@pytest.mark.parametrize(
    "bits, wide",
    [
        (0x00000000, 0x0000000000000000),
        (0x3F800000, 0x3FF0000000000000),
        (0x7F800000, 0x7FF0000000000000),
        (0xFF800000, 0xFFF0000000000000),
        (0x7F800001, 0x7FF0000020000000),
        (0xFF800001, 0xFFF0000020000000),
        (0x7FC00000, 0x7FF8000000000000),
        (0xFFFFFFFF, 0xFFFFFFFFE0000000),
    ],
)
def test_a_nan_has_its_payload_at_the_upper_end_of_64_bits(bits, wide):
    assert float64_bits(float32(bits)) == wide
    assert float32_bits(float64(wide)) == bits


def test_any_nan_is_the_special_value_nan():
    assert is_special(float64(0xFFF0000000000001), math.nan)
    assert is_special(0.0, 0.0)
    assert not is_special(0.0, math.nan)
    assert not is_special(math.nan, 0.0)


@pytest.mark.parametrize(
    "error, text",
    [
        (LengthError("Status", 3, 0), "Status has 3 bytes, 0 given"),
        (RangeError("mode", "0 to 3", 4), "mode takes 0 to 3, not 4"),
        (RangeError("t", "x", "a" * 58), f"t takes x, not '{'a' * 58}'"),
        (RangeError("t", "x", "a" * 59), f"t takes x, not '{'a' * 56}..."),
        (RangeError("t", "x", 10**5000), "t takes x, not a very long number"),
        (UnknownIdError("adcs", "telemetry", 0), "adcs has no telemetry 0"),
        (UnknownIdError("adcs", "t", 0, "it is old"), "adcs has no t 0: it is old"),
    ],
)
def test_errors_name_the_offending_value(error, text):
    assert str(error) == text
    rebuild, arguments = error.__reduce__()
    assert (str(rebuild(*arguments)), type(rebuild(*arguments))) == (text, type(error))


def test_a_range_has_no_trailing_zero_or_space():
    assert span_of(-10.0, 0.5, "K") == "-10 to 0.5 K"
    assert span_of(0, 100) == "0 to 100"
