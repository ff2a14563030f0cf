"""Constants of fields and members of enumerations are literals that C99 permits."""

from __future__ import annotations

import pytest

from icdgen.backends.c.constants import (
    constant_value,
    enumerator_literals,
    field_table,
    range_test,
)
from icdgen.describe import describe
from tests.icd.files import loaded, status


def node_of(folder, text):
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0]


def values(folder, keys, bits=8):
    field = f"at: 0, bits: {bits}, name: Value, {keys}"
    (message,) = node_of(folder, status(field, length=bits // 8)).messages
    (member,) = message.members
    return {each.name: constant_value(member, each) for each in member.constants}


@pytest.mark.parametrize(
    ("bits", "keys", "text"),
    [
        (8, "type: uint, min: 3", "3"),
        (8, "type: int, min: -3", "(-3)"),
        (8, "type: int, min: -128", "INT8_MIN"),
        (8, "type: int, min: -127", "(-127)"),
        (64, f"type: int, min: {-(1 << 63)}", "INT64_MIN"),
        (64, f"type: uint, min: {(1 << 63) - 1}", "9223372036854775807"),
        (64, f"type: uint, min: {1 << 63}", "UINT64_C(9223372036854775808)"),
        (8, "type: uint, formula: raw*0.5, min: 3", "3.0"),
        (8, "type: uint, formula: raw*0.5 - 9, min: -3", "(-3.0)"),
        (8, "type: uint, formula: raw*0.5, min: 0.5", "0.5"),
        (32, "type: float, min: 0", "0.0"),
    ],
)
def test_a_limit_is_a_literal_without_warning(tmp_path, bits, keys, text):
    (value,) = values(tmp_path, keys, bits).values()
    assert value == text


@pytest.mark.parametrize(
    ("bits", "keys", "text"),
    [
        (8, "type: uint, const: 7", "0x07u"),
        (64, "type: uint, const: 7", "UINT64_C(0x0000000000000007)"),
        (8, "type: int, const: -7", "-7"),
        (8, "type: int, const: -128", "INT8_MIN"),
        (16, "type: uint, special: [{value: 500, meaning: idle}]", "0x01F4u"),
        (8, "type: int, special: [{value: -7, meaning: idle}]", "-7"),
        (
            32,
            "type: float, special: [{value: nan, meaning: idle}]",
            "icd_f32_of(0x7FC00000u)",
        ),
        (
            64,
            "type: float, special: [{value: -inf, meaning: idle}]",
            "icd_f64_of(UINT64_C(0xFFF0000000000000))",
        ),
        (32, "type: float, special: [{value: -1.5, meaning: idle}]", "(-1.5f)"),
        (64, "type: float, special: [{value: 1.5, meaning: idle}]", "1.5"),
    ],
)
def test_a_raw_value_with_a_meaning_is_a_literal_of_its_type(
    tmp_path, bits, keys, text
):
    (value,) = values(tmp_path, keys, bits).values()
    assert value == text


def enum_with(folder, *numbers, bits=8):
    rows = "".join(
        f"      - {{value: {number}, name: M{index}}}\n"
        for index, number in enumerate(numbers)
    )
    text = f"enums:\n  - name: Mode\n    members:\n{rows}" + status(
        f"at: 0, bits: {bits}, name: Mode, type: enum, enum: Mode", length=bits // 8
    )
    return node_of(folder, text).enums[0]


@pytest.mark.parametrize(
    ("numbers", "bits", "are_macros", "texts"),
    [
        ((1, 32767), 16, False, ["1", "32767"]),
        ((1, 32768), 16, True, ["1u", "32768u"]),
        ((-5, 5), 8, False, ["-5", "5"]),
        ((-32767, 5), 16, False, ["-32767", "5"]),
        ((-32768, 5), 16, True, ["INT16_MIN", "5"]),
        ((-40000, 5), 32, True, ["(-40000)", "5"]),
        ((1, 2), 64, False, ["UINT64_C(1)", "UINT64_C(2)"]),
        ((-40000, 5), 64, True, ["(INT64_C(-40000))", "INT64_C(5)"]),
    ],
)
def test_values_beyond_an_int_of_16_bits_are_macros(
    tmp_path, numbers, bits, are_macros, texts
):
    enum = enum_with(tmp_path, *numbers, bits=bits)
    has_macros, literal = enumerator_literals(enum)
    assert has_macros == are_macros
    assert [literal(number) for number in numbers] == texts


@pytest.mark.parametrize(
    ("first", "bits", "text"),
    [
        (3, 8, "value > 3u && value < 9u"),
        (-128, 8, "value > INT8_MIN && value < 9"),
        (-3, 8, "value > (-3) && value < 9"),
        (3, 64, "value > UINT64_C(3) && value < UINT64_C(9)"),
        (-3, 64, "value > (INT64_C(-3)) && value < INT64_C(9)"),
    ],
)
def test_a_range_is_tested_between_its_ends(tmp_path, first, bits, text):
    enum = enum_with(tmp_path, f"{first}, to: 9", bits=bits)
    (member,) = enum.ranges
    assert range_test(enum, member) == text


def test_rows_of_fields_point_to_the_first_of_their_limits(tmp_path):
    fields = (
        'at: 0, bits: 8, name: "A \\"q\\"", type: uint, unit: s, min: 1, below: 9',
        "at: 8, bits: 8, name: B, type: int, above: -3",
        "at: 16, bits: 4, name: C, type: uint, count: 2",
    )
    (message,) = node_of(tmp_path, status(*fields, length=3)).messages
    table = field_table(message)
    assert table.rows == [
        '{"A \\"q\\"", "s", 0u, 8u, 1u, &limits[0], 2u, NULL}',
        '{"B", "", 8u, 8u, 1u, &limits[2], 1u, NULL}',
        '{"C", "", 16u, 4u, 2u, NULL, 0u, NULL}',
    ]
    assert table.limits == [
        "{ICD_LIMIT_MIN, 1.0}",
        "{ICD_LIMIT_BELOW, 9.0}",
        "{ICD_LIMIT_ABOVE, -3.0}",
    ]
