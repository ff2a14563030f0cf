"""Steps of scales, limits and printed numbers are compared with exact arithmetic."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.describe.bounds import allowed_ends, bounds_of_limits
from icdgen.describe.numbers import (
    MOST_DIGITS,
    array_text,
    bit_range,
    byte_count,
    byte_range,
    count_text,
    exact_text,
    factor_text,
    length_text,
    octets_text,
    points_text,
    special_text,
    value_text,
)
from icdgen.describe.steps import steps_of_scale
from icdgen.describe.storage import Storage, storage_bits
from icdgen.icd.curve import CLAMP, EXTRAPOLATE, REFUSE, Curve
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Scalar
from icdgen.icd.model import Limits, Special
from icdgen.icd.places import NodePlace
from tests.describe.small import message_of
from tests.limits import assert_limits

fractions = st.fractions(min_value=-1000, max_value=1000, max_denominator=1000)
scales = st.builds(Scale, fractions.filter(bool), fractions)


@st.composite
def scaled(draw) -> tuple[NodePlace, int]:
    """Draw a field with a scale, and a raw value of it."""
    kind, bits = draw(st.sampled_from(["uint", "int"])), draw(st.integers(1, 64))
    field = Scalar(name="it", at=0, bits=bits, type=kind, scale=draw(scales))
    return field, draw(st.integers(field.raw_min, field.raw_max))


@given(scaled())
def test_the_steps_give_what_the_reference_codec_gives(case):
    field, raw = case
    scale_steps = steps_of_scale(field)
    assert scale_steps is not None and scale_steps.q > 0
    assert (
        scale_steps.physical(raw)
        == field.scale.physical(raw)
        == codec.physical(field, raw)
    )
    assert scale_steps.double(raw) == codec.physical_double(field, raw)


@given(scaled())
def test_steps_marked_as_exact_give_the_same_in_doubles(case):
    field, raw = case
    scale_steps = steps_of_scale(field)
    if scale_steps.exact_in_doubles:
        assert (float(raw) * float(scale_steps.p) + float(scale_steps.c)) / float(
            scale_steps.q
        ) == scale_steps.double(raw)


@given(scaled())
def test_no_value_lies_outside_the_span(case):
    field, raw = case
    low, high = steps_of_scale(field).span
    assert low <= steps_of_scale(field).physical(raw) <= high
    assert {low, high} == {
        steps_of_scale(field).physical(end) for end in (field.raw_min, field.raw_max)
    }


def test_a_number_without_an_exact_double_is_not_marked_as_exact():
    assert not steps_of_scale(
        Scalar(name="wide", at=0, bits=64, type="uint", scale=Scale(Fraction(3)))
    ).exact_in_doubles
    assert steps_of_scale(
        Scalar(name="small", at=0, bits=16, type="int", scale=Scale(Fraction(1, 100)))
    ).exact_in_doubles


LIMITS = Limits(min=Fraction(1), below=Fraction(3))


@pytest.mark.parametrize(
    ("value", "expected"), [(0.5, [False, True]), (1, [True, True]), (3, [True, False])]
)
def test_each_limit_accepts_the_values_within_it(value, expected):
    limits = bounds_of_limits(LIMITS)
    assert [bound.key for bound in limits] == ["min", "below"]
    assert [bound.holds(value) for bound in limits] == expected
    assert not any(bound.holds(float("nan")) for bound in limits)


def test_the_range_is_that_of_the_type_unless_an_inclusive_limit_is_narrower():
    field = Scalar(
        name="it",
        at=0,
        bits=8,
        type="uint",
        scale=Scale(Fraction(-1, 2)),
        limits=Limits(min=Fraction(-5), above=Fraction(-9)),
    )
    assert allowed_ends(field) == (-5, 0)
    assert allowed_ends(Scalar(name="it", at=0, bits=32, type="float")) == (None, None)


@pytest.mark.parametrize("bits", range(1, 65))
def test_the_storage_is_the_narrowest_type_for_the_values(bits):
    for signed in (False, True):
        storage = Storage(storage_bits(bits), signed)
        field = Scalar(name="it", at=0, bits=bits, type="int" if signed else "uint")
        assert storage.min <= field.raw_min and field.raw_max <= storage.max
        assert storage.bits == 8 or storage.bits // 2 < bits


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("1/3", "0.3333333333333333"),
        ("-1/8", "-0.125"),
        ("7", "7"),
        ("-32768/1000", "-32.768"),
        ("1/1024", "0.0009765625"),
    ],
)
def test_numbers_are_decimals_if_finite(value, text):
    assert exact_text(Fraction(value)) == text


@given(st.fractions(max_denominator=10**6))
def test_factors_are_exact_as_text(value):
    assert Fraction(factor_text(value)) == value


def test_decimal_places_and_values_are_printed_as_expected():
    assert (bit_range(3, 1), bit_range(4, 4), byte_range(0, 1), byte_range(2, 3)) == (
        "bit 3", "bits 4 to 7", "byte 0", "bytes 2 to 4",
    )  # fmt: skip
    assert [value_text(raw) for raw in (-1, 9, 10, 0x5A)] == [
        "-1",
        "9",
        "10 (0xA)",
        "90 (0x5A)",
    ]


def test_a_decimal_is_exact_up_to_24_digits():
    def is_exact(digits: int) -> bool:
        number = 10 ** (digits - 1) + 1
        whole, decimal = exact_text(Fraction(number)), exact_text(Fraction(number, 10))
        return (Fraction(whole), Fraction(decimal)) == (number, Fraction(number, 10))

    assert_limits(is_exact, most=MOST_DIGITS)
    assert exact_text(Fraction(1, 10**24)) == f"0.{'0' * 23}1"
    assert exact_text(Fraction(1, 10**25)) == "1e-25"
    assert exact_text(-(10**24)) == "-1e+24"


@pytest.mark.parametrize(
    ("most", "outside", "text"),
    [
        (4, "", "0: -40, 512: 20.5, 600: 30, 1023: 125"),
        (4, CLAMP, "0: -40, 512: 20.5, 600: 30, 1023: 125, clamped outside"),
        (3, EXTRAPOLATE, "0: -40, 512: 20.5, ... (4 points), 1023: 125, extrapolated outside"),
        (2, REFUSE, "0: -40, ... (4 points), 1023: 125, no number outside"),
    ],
)  # fmt: skip
def test_points_in_the_middle_of_a_long_table_are_left_out(most, outside, text):
    points = ((0.0, -40.0), (512.0, 20.5), (600.0, 30.0), (1023.0, 125.0))
    assert points_text(Curve((), points, outside), most) == text


@pytest.mark.parametrize(
    ("value", "number", "text"),
    [
        (0, "", "0"),
        (65535, "", "65535 (0xFFFF)"),
        (0x7FC00000, "nan", "NaN"),
        (0x7F800000, "inf", "infinity"),
        (0xFF800000, "-inf", "-infinity"),
        (0xC2C7CCCD, "-99.9", "-99.9"),
    ],
)
def test_a_special_value_is_its_raw_value_or_the_number_of_a_float(value, number, text):
    assert special_text(Special(value=value, meaning="idle", number=number)) == text


def test_a_single_element_byte_or_bit_is_singular():
    assert [byte_count(count) for count in (0, 1, 2)] == [
        "0 bytes",
        "1 byte",
        "2 bytes",
    ]
    assert [array_text(*size) for size in ((1, 1), (6, 16))] == [
        "1 element of 1 bit",
        "6 elements of 16 bits",
    ]
    assert [octets_text(*size) for size in ((1, 8), (10, 240))] == [
        "1 element of 1 byte",
        "10 elements of 30 bytes",
    ]


@pytest.mark.parametrize(("plus", "text"), [(0, "N"), (3, "N + 3"), (-4, "N - 4")])
def test_a_counter_is_shown_with_what_is_added_to_it(plus, text):
    assert count_text("N", plus) == text


@pytest.mark.parametrize(
    ("fields", "length", "text"),
    [
        (["at: 0, bits: 8, name: A, type: uint"], 1, "1 byte"),
        (
            [
                "at: 0, bits: 8, name: A, type: uint",
                "at: 8, bits: 16, name: B, type: uint, count: A, up_to: 3",
            ],
            1,
            "1 to 7 bytes",
        ),
    ],
)
def test_a_length_is_a_range_if_frames_differ(tmp_path, fields, length, text):
    assert length_text(message_of(tmp_path, *fields, length=length).model) == text
