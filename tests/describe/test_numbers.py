"""Steps of scales, limits and printed numbers are compared with exact arithmetic."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.describe.bounds import allowed_ends, bounds_of_limits
from icdgen.describe.numbers import (
    bit_range,
    byte_range,
    exact_text,
    factor_text,
    value_text,
)
from icdgen.describe.steps import steps_of_scale
from icdgen.describe.storage import Storage, storage_bits
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Scalar
from icdgen.icd.model import Limits
from icdgen.icd.places import NodePlace

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
