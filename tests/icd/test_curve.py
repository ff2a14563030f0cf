"""Calibrations are computed in doubles like their formula, and inverted to the nearest
raw value.
"""

from __future__ import annotations

import math
import struct
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.icd import curve, formula
from icdgen.icd.curve import (
    Curve,
    curve_of_plain,
    has_inverse,
    is_finite,
    polynomial,
    table,
)
from icdgen.icd.layout import Scalar
from icdgen.loading import load
from tests.limits import assert_limits

COEFFICIENTS = st.lists(
    st.floats(-1e9, 1e9, allow_subnormal=False), min_size=2, max_size=6
).map(curve.polynomial)

_NUMBERS = st.integers(-300, 600) | st.floats(-1e9, 1e9, allow_subnormal=False)
_RAWS = st.lists(_NUMBERS, min_size=2, max_size=8, unique_by=float).map(
    lambda raws: sorted(map(float, raws))
)


@st.composite
def tables(draw: st.DrawFn) -> Curve:
    """Draw lookup tables, monotonic ones among them."""
    raws = draw(_RAWS)
    values = draw(st.lists(_NUMBERS.map(float), min_size=len(raws), max_size=len(raws)))
    values = draw(
        st.sampled_from((values, sorted(values), sorted(values, reverse=True)))
    )
    return curve.table(
        list(zip(raws, values, strict=True)), draw(st.sampled_from(curve.OUTSIDE))
    )


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
    "text",
    [
        "raw^16",
        "raw^8*raw^8",
        "1/raw",
        "raw/raw",
        "raw^-1",
        "raw = value^2",
        "raw^2 - raw^2 + 1",
    ],
)
def test_other_formulas_than_polynomials_are_refused(text):
    with pytest.raises(formula.FormulaError):
        curve.parse(text)


@given(COEFFICIENTS, st.integers(-(2**63), 2**64 - 1))
def test_every_step_is_rounded_by_itself(curve, raw):
    exact = Fraction(curve.coefficients[-1])
    for coefficient in curve.coefficients[-2::-1]:
        product = codec.to_double(exact * Fraction(float(raw)))
        exact = Fraction(codec.to_double(Fraction(product) + Fraction(coefficient)))
    assert curve.double(raw) == float(exact)


def _rounded(exact: Fraction) -> Fraction:
    return Fraction(codec.to_double(exact))


def _between(curve: Curve, raw: float) -> float:
    """Return the value between two points as documented: every step is rounded
    separately.
    """
    points = curve.points
    is_beyond = not points[0][0] <= raw <= points[-1][0]
    if is_beyond and curve.outside == "refuse":
        return math.nan
    if is_beyond and curve.outside == "clamp":
        return points[0][1] if raw < points[0][0] else points[-1][1]
    at = max(
        [index for index, (start, _) in enumerate(points) if start <= raw], default=0
    )
    (x0, y0), (x1, y1) = (
        points[min(at, len(points) - 2)],
        points[min(at, len(points) - 2) + 1],
    )
    slope = _rounded((Fraction(y1) - Fraction(y0)) / (Fraction(x1) - Fraction(x0)))
    start, value = map(Fraction, points[at])
    above = _rounded(Fraction(raw) - start)
    return float(_rounded(_rounded(above * slope) + value))


@given(
    tables(),
    st.integers(-(2**63), 2**64 - 1)
    | st.integers(-400, 700)
    | st.floats(-1e300, 1e300),
)
def test_a_lookup_table_follows_its_definition_to_the_last_bit(curve, raw):
    actual, wanted = curve.double(raw), _between(curve, float(raw))
    assert struct.pack(">d", actual) == struct.pack(">d", wanted)


@given(tables())
def test_at_its_points_a_table_has_their_values(curve):
    assert [curve.double(raw) for raw, _ in curve.points] == [
        value for _, value in curve.points
    ]


@given(tables())
def test_beyond_its_points_a_lookup_table_follows_its_outside_key(curve):
    (first, low), (last, high) = curve.points[0], curve.points[-1]
    for number in (
        math.nextafter(first, -math.inf),
        -math.inf,
        math.nextafter(last, math.inf),
        math.inf,
    ):
        value = curve.double(number)
        if curve.outside == "clamp":
            assert value == (low if number < first else high)
        elif curve.outside == "refuse":
            assert struct.pack(">d", value).hex() == "7ff8000000000000"
    assert math.isnan(curve.double(math.nan))


@pytest.mark.parametrize(
    ("points", "why"),
    [
        ([[0, 1]], "at least two"),
        ([[1, 1], [0, 2]], "0 follows 1"),
        ([[0, 1], [0, 2]], "raw value 0 occurs twice"),
        ([[2**53, 1], [2**53 + 1, 2]], "occurs twice"),
        ([[0, "1e400"], [1, 2]], "too large"),
        ([[10**400, 1], [1, 2]], "too large"),
        ([[0, "-1e308"], [0.5, "1e308"]], "too steep"),
    ],
)
def test_invalid_points_are_refused(points, why):
    with pytest.raises(formula.FormulaError, match=why):
        curve.table(curve.doubles(points), "clamp")


def test_points_are_numbers_however_they_are_written(tmp_path: Path):
    points = '[[-1, "1e-3"], [0.5, 1.0e-3], ["2", 2.5e+2], [1.0e+3, "-3.5E+2"]]'
    (tmp_path / "demo.yaml").write_text(
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\nmessages:\n"
        "  - {name: A, id: 1, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: B, type: uint, "
        f"points: {points}, outside: clamp}}]}}\n"
    )
    loaded = load([tmp_path])
    assert not loaded.findings
    (field,) = loaded.icd.nodes[0].messages[0].fields
    assert field.curve is not None
    assert field.curve.points == (
        (-1.0, 0.001),
        (0.5, 0.001),
        (2.0, 250.0),
        (1000.0, -350.0),
    )


@given(
    COEFFICIENTS | tables(), st.integers(1, 9), st.booleans(), st.floats(-1e12, 1e12)
)
def test_the_inverse_gives_the_nearest_raw_value(curve, bits, is_signed, value):
    field = Scalar(
        name="any", at=0, bits=bits, type="int" if is_signed else "uint", curve=curve
    )
    raws = range(field.settable_raws[0], field.settable_raws[1] + 1)
    values = [curve.double(raw) for raw in raws]
    pairs = list(pairwise(values))
    assert field.is_invertible == (
        bool(pairs) and (all(a < b for a, b in pairs) or all(a > b for a, b in pairs))
    )
    if not field.is_invertible:
        with pytest.raises(codec.CodecError):
            codec.raw_from_physical(field, value)
        return
    for raw, physical in zip(raws, values, strict=True):
        assert codec.raw_from_physical(field, physical) == raw
    if min(values) <= value <= max(values):
        wanted = min(raws, key=lambda raw: (abs(value - curve.double(raw)), raw % 2))
        assert codec.raw_from_physical(field, value) == wanted
    else:
        with pytest.raises(codec.CodecError):
            codec.raw_from_physical(field, value)


def test_a_lookup_table_is_inverted_between_its_points():
    points = ((10.0, 1.0), (20.5, 4.0), (70000.0, 5.0))
    ends = {
        outside: Scalar(
            name="any", at=0, bits=16, type="uint", curve=curve.table(points, outside)
        ).settable_raws
        for outside in curve.OUTSIDE
    }
    assert ends == {
        "clamp": (10, 65535),
        "refuse": (10, 65535),
        "extrapolate": (0, 65535),
    }
    for outside, raw in (("clamp", None), ("refuse", None), ("extrapolate", 9)):
        field = Scalar(
            name="any", at=0, bits=16, type="uint", curve=curve.table(points, outside)
        )
        assert codec.raw_from_physical(field, 1.1) == 10
        if raw is None:
            with pytest.raises(codec.CodecError, match="takes 1 to 4"):
                codec.raw_from_physical(field, 0.8)
        else:
            assert codec.raw_from_physical(field, 0.8) == raw


def test_wider_fields_and_powers_of_floats_are_only_read():
    square = curve.parse("raw^2")
    assert Scalar(name="any", at=0, bits=16, type="uint", curve=square).is_invertible
    assert not Scalar(
        name="any", at=0, bits=17, type="uint", curve=square
    ).is_invertible
    assert not Scalar(
        name="any", at=0, bits=32, type="float", curve=square
    ).is_invertible
    assert Scalar(
        name="any", at=0, bits=32, type="float", curve=curve.parse("raw/3")
    ).is_invertible


def test_a_float_accepts_values_that_are_finite_in_its_width():
    field = Scalar(
        name="any", at=0, bits=32, type="float", curve=curve.parse("raw*0.5")
    )
    largest = struct.unpack("<f", bytes.fromhex("ffff7f7f"))[0]
    assert codec.raw_from_physical(field, largest / 2) == 0x7F7FFFFF
    for value in (largest, math.inf, -math.inf, math.nan):
        with pytest.raises(codec.CodecError):
            codec.raw_from_physical(field, value)


def test_a_nan_result_always_has_the_same_bits():
    field = Scalar(
        name="any", at=0, bits=32, type="float", curve=curve.parse("raw^2 - raw")
    )
    for raw in (0x7FC00001, 0xFFFFFFFF, 0x7F800001, 0xFF800000 - 0x80000000):
        value = codec.physical_double(field, raw)
        assert value is not None
        assert struct.pack(">d", value).hex() in (
            "7ff8000000000000",
            "7ff0000000000000",
        )


def test_limits_of_raw_values_that_are_tried():
    shape = polynomial([0.0, 1.0, 1e-9])
    assert_limits(lambda high: has_inverse(shape, False, 0, high), most=2**16 - 1)
    assert not has_inverse(shape, False, 5, 5)
    assert has_inverse(shape, False, 5, 6)


def test_ties_between_two_raw_values_go_to_the_even_one():
    shape = polynomial([0.0, 2.0])
    assert [shape.nearest(value, 0, 9) for value in (1, 3, 5, 4.9, 5.1)] == [0, 2, 2, 2, 3]  # fmt: skip
    falling = polynomial([0.0, -2.0])
    assert [falling.nearest(value, 0, 9) for value in (-1, -3, -19, 1)] == [0, 2, None, None]  # fmt: skip


@pytest.mark.parametrize("outside", ["", "clamp", "extrapolate", "refuse"])
def test_a_table_is_written_as_plain_values_and_read_back(outside):
    shape = table(((0.5, 1.0), (2.5, 3.0)), outside)
    plain = shape.plain
    expected = {"points": [[0.5, 1.0], [2.5, 3.0]]}
    assert plain == expected | ({"outside": outside} if outside else {})
    assert curve_of_plain(plain) == shape
    inner = (1, 2) if outside in ("clamp", "refuse") else (0, 9)
    assert shape.invertible_raws(0, 9) == inner
    assert curve_of_plain(polynomial([1.0, 2.0]).plain) == polynomial([1.0, 2.0])
    assert curve_of_plain({}) is None


def test_points_cover_raw_values_up_to_their_ends():
    shape = table(((0.0, 1.0), (9.0, 3.0)), "")
    assert_limits(lambda low: shape.covers(low, 9), least=0)
    assert_limits(lambda high: shape.covers(0, high), most=9)
    assert polynomial([0.0, 1.0]).covers(-1000, 1000)


def test_results_are_finite_if_they_are_below_2_to_the_1000():
    assert_limits(lambda n: is_finite(polynomial([0.0, 2.0**n]), 0, 1), most=999)
    assert_limits(lambda n: is_finite(polynomial([2.0**n, 1.0]), 0, 0), most=999)
    assert not is_finite(polynomial([0.0, 2.0**990]), -(2**10), 0)
