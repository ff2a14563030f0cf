"""A type of XTCE has the encoding, calibration and range of its field."""

from __future__ import annotations

import pytest

from icdgen.backends.xtce.types import GeneratedType, TypeBuilder, type_of, unique
from icdgen.describe import describe
from tests.icd.files import loaded, status

MSB, LSB = "mostSignificantByteFirst", "leastSignificantByteFirst"


def fields_of(folder, *fields, length):
    result = loaded(folder, status(*fields, length=length))
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0].messages[0].members


def type_with(folder, keys, is_little=False):
    length = -(-int(keys.removeprefix("bits: ").split(",")[0]) // 8)
    (field,) = fields_of(folder, f"at: 0, name: Value, {keys}", length=length)
    return type_of(field.model, is_little)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ("bits: 8, type: uint", GeneratedType("Integer", 8, "unsigned")),
        ("bits: 9, type: uint", GeneratedType("Integer", 9, "unsigned", MSB)),
        ("bits: 16, type: int", GeneratedType("Integer", 16, "twosComplement", MSB)),
        ("bits: 1, type: bool", GeneratedType("Boolean", 1, "unsigned")),
        ("bits: 32, type: float", GeneratedType("Float", 32, "", MSB)),
        ("bits: 24, type: bytes", GeneratedType("Binary", 24)),
        ("bits: 24, type: text", GeneratedType("String", 24)),
        (
            "bits: 8, type: uint, unit: s",
            GeneratedType("Integer", 8, "unsigned", unit="s"),
        ),
    ],
)
def test_a_type_has_kind_encoding_byte_order_and_unit(tmp_path, keys, expected):
    assert type_with(tmp_path, keys) == expected


def test_a_number_with_the_least_significant_byte_first_has_this_order(tmp_path):
    assert type_with(tmp_path, "bits: 16, type: uint", True).byte_order == LSB


@pytest.mark.parametrize(
    ("keys", "limits"),
    [
        ("type: uint, min: 3, max: 9", {"minInclusive": "3", "maxInclusive": "9"}),
        ("type: uint, above: 3, below: 9", {"minInclusive": "4", "maxInclusive": "8"}),
        (
            "type: uint, formula: raw*0.5, min: 3, below: 9",
            {"minInclusive": "3", "maxExclusive": "9"},
        ),
        ("type: uint, formula: raw*0.5, above: 0.5", {"minExclusive": "0.5"}),
        ("type: uint", {}),
    ],
)
def test_limits_of_integers_are_inclusive(tmp_path, keys, limits):
    assert dict(type_with(tmp_path, f"bits: 8, {keys}").limits) == limits


def test_limits_beyond_a_signed_number_of_64_bits_are_omitted(tmp_path):
    def limits(value):
        text = f"bits: 64, type: uint, min: 1, max: {value}"
        return dict(type_with(tmp_path, text).limits)

    most = (1 << 63) - 1
    assert limits(most) == {"minInclusive": "1", "maxInclusive": str(most)}
    assert limits(most + 1) == {"minInclusive": "1"}


@pytest.mark.parametrize(
    ("formula", "terms"),
    [
        ("raw*0.5 - 40", ((0, "-40"), (1, "0.5"))),
        ("raw*0.5", ((1, "0.5"),)),
        ("raw + 1", ((0, "1"), (1, "1"))),
        ("1 + 2*raw^3", ((0, "1"), (1, "0"), (3, "2"))),
    ],
)
def test_a_formula_becomes_a_polynomial_that_has_a_linear_term(
    tmp_path, formula, terms
):
    result = type_with(tmp_path, f"bits: 8, type: uint, formula: {formula}")
    assert (result.kind, result.terms, result.size) == ("Float", terms, 64)


@pytest.mark.parametrize(
    ("bits", "outside", "points", "extrapolates"),
    [
        (8, "clamp", (("0", "10"), ("5", "10"), ("9", "2"), ("255", "2")), False),
        (8, "extrapolate", (("5", "10"), ("9", "2")), True),
    ],
)
def test_a_clamped_table_gets_points_at_the_ends_of_the_raw_range(
    tmp_path, bits, outside, points, extrapolates
):
    text = f"bits: {bits}, type: uint, points: [[5, 10], [9, 2]], outside: {outside}"
    result = type_with(tmp_path, text)
    assert result.points == points
    assert result.extrapolates == extrapolates


def test_a_table_of_the_complete_raw_range_gets_no_further_points(tmp_path):
    text = "bits: 8, type: uint, points: [[0, 10], [255, 2]], outside: clamp"
    result = type_with(tmp_path, text)
    assert result.points == (("0", "10"), ("255", "2"))


@pytest.mark.parametrize(("bits", "size"), [(8, 32), (32, 32), (33, 64), (64, 64)])
def test_programs_store_values_of_more_than_32_bits_in_64(bits, size):
    assert GeneratedType("Integer", bits, "unsigned").size == size


def test_equal_types_have_one_name_and_different_types_never_the_same(tmp_path):
    fields = fields_of(
        tmp_path,
        "at: 0, bits: 16, name: A, type: uint",
        "at: 16, bits: 16, name: B, type: uint",
        "at: 32, bits: 16, name: C, type: uint, unit: s",
        "at: 48, bits: 1, name: D, type: bool",
        "at: 56, bits: 8, name: E, type: uint, count: 2",
        "at: 72, bits: 8, name: F, type: text",
        "at: 80, bits: 24, name: G, type: bytes",
        length=13,
    )
    builder = TypeBuilder()
    names = [builder.type_of_field(field, "X", True) for field in fields[:3]]
    assert names == ["uint16_le", "uint16_le", "X"]
    names = [builder.type_of_field(field, "X", False) for field in fields]
    assert names == ["uint16", "uint16", "X_2", "flag", "X_Array", "text1", "bytes3"]


def test_a_used_name_gets_the_next_free_number():
    taken = {"A", "A_2"}
    assert [unique(name, taken) for name in "AAB"] == ["A_3", "A_4", "B"]
    assert taken == {"A", "A_2", "A_3", "A_4", "B"}
