"""Constants of a field have unique names, exact values and comments."""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.describe import describe
from icdgen.describe.constants import Constant
from tests.icd.files import loaded, status


def constants(folder, keys, bits=8):
    field = f"at: 0, bits: {bits}, name: Turn Rate, {keys}"
    result = loaded(folder, status(field, length=bits // 8))
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0].messages[0].members[0].constants


def test_the_only_valid_value_is_a_constant(tmp_path):
    assert constants(tmp_path, "type: uint, const: 7") == (
        Constant(
            "const", "turn_rate_const", 7, True, "Turn Rate: the only valid raw value."
        ),
    )


@pytest.mark.parametrize(
    ("value", "meaning", "end"),
    [
        (7, "no rate", "no_rate"),
        (7, "one two three four five", "one_two_three_four_five"),
        (7, "one two three four five six", "special_7"),
        (7, "---", "special_7"),
        (-7, "one two three four five six", "special_minus_7"),
    ],
)
def test_a_meaning_of_at_most_five_words_is_the_name(tmp_path, value, meaning, end):
    special = f"[{{value: {value}, meaning: '{meaning}'}}]"
    (constant,) = constants(tmp_path, f"type: int, special: {special}")
    assert constant.name == f"turn_rate_{end}"
    assert (constant.key, constant.value, constant.is_raw) == ("special", value, True)
    assert constant.comment == f"Turn Rate: {meaning}."


def test_values_with_the_same_meaning_are_named_after_their_numbers(tmp_path):
    rows = ", ".join(f"{{value: {n}, meaning: reserved}}" for n in (3, -4, 5))
    found = constants(tmp_path, f"type: int, special: [{rows}]")
    assert [(each.name, each.value) for each in found] == [
        ("turn_rate_reserved", 3),
        ("turn_rate_special_minus_4", -4),
        ("turn_rate_special_5", 5),
    ]


def test_names_of_numbers_have_neither_sign_nor_point(tmp_path):
    long = "one two three four five six"
    rows = ", ".join(
        f"{{value: {n}, meaning: {long}}}" for n in ("nan", "-1.5", "1.0e+30")
    )
    found = constants(tmp_path, f"type: float, special: [{rows}]", 32)
    assert [each.name for each in found] == [
        "turn_rate_special_nan",
        "turn_rate_special_minus_1_5",
        "turn_rate_special_1e30",
    ]


@pytest.mark.parametrize(
    ("keys", "rows"),
    [
        (
            "min: 3, below: 9, unit: s",
            [("min", "turn_rate_min", 3, True), ("below", "turn_rate_below", 9, True)],
        ),
        (
            "formula: raw*0.5, above: 3, max: 9.5, unit: s",
            [
                ("above", "turn_rate_s_above", 3, False),
                ("max", "turn_rate_s_max", Fraction(19, 2), False),
            ],
        ),
        ("below: 255", [("below", "turn_rate_below", 255, True)]),
        ("min: 2.5", [("min", "turn_rate_min", Fraction(5, 2), False)]),
    ],
)
def test_a_limit_is_raw_if_the_raw_type_can_store_it(tmp_path, keys, rows):
    found = constants(tmp_path, f"type: uint, {keys}")
    assert [(c.key, c.name, c.value, c.is_raw) for c in found] == rows
    assert all(isinstance(c.value, int) == c.is_raw for c in found)
    unit = " in s" if "unit" in keys else ""
    assert all(c.comment.startswith(f"Turn Rate{unit}: ") for c in found)


def test_limits_of_floats_are_not_raw(tmp_path):
    (constant,) = constants(tmp_path, "type: float, max: 5", 32)
    assert (constant.value, constant.is_raw, constant.double) == (5, False, 5.0)
