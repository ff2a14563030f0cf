"""Curves: computed in doubles as the formula says, and back to the nearest raw value."""

from __future__ import annotations

import math
import struct
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.icd import curve, formula
from icdgen.icd.curve import Curve
from icdgen.icd.model import Field

COEFFICIENTS = st.lists(st.floats(-1e9, 1e9, allow_subnormal=False), min_size=2, max_size=6).map(tuple).map(Curve)


@pytest.mark.parametrize(
    ("text", "coefficients"),
    [
        ("-40 + 0.02*raw + 3e-6*raw^2", (-40.0, 0.02, 3e-6)),
        ("(raw/1000)^2 * -0.7072 + 1", (1.0, 0.0, -0.7072e-6)),
        ("raw*raw*raw", (0.0, 0.0, 0.0, 1.0)),
        ("(raw - 1)*(raw + 1)", (-1.0, 0.0, 1.0)),
        ("raw = value*1000", (0.0, 0.001)),
        ("raw/3 + 1/3", (1 / 3, 1 / 3)),
        ("(2*raw + 1)^3", (1.0, 6.0, 12.0, 8.0)),
        ("raw^2 - raw*raw + raw", (0.0, 1.0)),
    ],
)
def test_a_formula_is_multiplied_out_exactly_and_rounded_once(text, coefficients):
    assert curve.parse(text).coefficients == coefficients


@pytest.mark.parametrize(
    "text", ["raw^16", "raw^8*raw^8", "1/raw", "raw/raw", "raw^-1", "raw = value^2", "raw^2 - raw^2 + 1"]
)
def test_what_is_no_polynomial_is_refused(text):
    with pytest.raises(formula.FormulaError):
        curve.parse(text)


@given(COEFFICIENTS, st.integers(-(2**63), 2**64 - 1))
def test_every_step_is_rounded_by_itself(one, raw):
    exact = Fraction(one.coefficients[-1])
    for coefficient in one.coefficients[-2::-1]:
        product = codec.to_double(exact * Fraction(float(raw)))
        exact = Fraction(codec.to_double(Fraction(product) + Fraction(coefficient)))
    assert one.double(raw) == float(exact)


@given(COEFFICIENTS, st.integers(1, 9), st.booleans(), st.floats(-1e12, 1e12))
def test_the_way_back_gives_the_nearest_of_all_raw_values(one, bits, is_signed, value):
    field = Field("any", 0, bits, "int" if is_signed else "uint", curve=one)
    raws = range(field.raw_min, field.raw_max + 1)
    values = [one.double(raw) for raw in raws]
    pairs = list(pairwise(values))
    assert field.leads_back == (all(a < b for a, b in pairs) or all(a > b for a, b in pairs))
    if not field.leads_back:
        with pytest.raises(codec.CodecError):
            codec.raw_from_physical(field, value)
        return
    for raw, physical in zip(raws, values, strict=True):
        assert codec.raw_from_physical(field, physical) == raw
    if min(values) <= value <= max(values):
        wanted = min(raws, key=lambda raw: (abs(value - one.double(raw)), raw % 2))
        assert codec.raw_from_physical(field, value) == wanted
    else:
        with pytest.raises(codec.CodecError):
            codec.raw_from_physical(field, value)


def test_wider_fields_and_powers_of_floats_are_only_read():
    square = curve.parse("raw^2")
    assert Field("any", 0, 16, "uint", curve=square).leads_back
    assert not Field("any", 0, 17, "uint", curve=square).leads_back
    assert not Field("any", 0, 32, "float", curve=square).leads_back
    assert Field("any", 0, 32, "float", curve=curve.parse("raw/3")).leads_back


def test_a_float_takes_what_is_finite_in_its_width():
    field = Field("any", 0, 32, "float", curve=curve.parse("raw*0.5"))
    largest = struct.unpack("<f", bytes.fromhex("ffff7f7f"))[0]
    assert codec.raw_from_physical(field, largest / 2) == 0x7F7FFFFF
    for value in (largest, math.inf, -math.inf, math.nan):
        with pytest.raises(codec.CodecError):
            codec.raw_from_physical(field, value)


def test_a_result_that_is_no_number_has_always_the_same_bits():
    field = Field("any", 0, 32, "float", curve=curve.parse("raw^2 - raw"))
    for raw in (0x7FC00001, 0xFFFFFFFF, 0x7F800001, 0xFF800000 - 0x80000000):
        value = codec.physical_double(field, raw)
        assert value is not None
        assert struct.pack(">d", value).hex() in ("7ff8000000000000", "7ff0000000000000")
