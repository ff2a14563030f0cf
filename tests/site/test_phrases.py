"""Numbers, ranges, types and ids have the notation of the pages."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from icdgen.backends.html import texts
from icdgen.backends.html.units import _widths
from tests.icd.files import loaded, status
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("value", "text"), [(-3, "−3"), (Fraction(-1, 4), "−0.25"), (12, "12")]
)
def test_negative_numbers_have_a_minus_sign(value, text):
    assert texts.number(value) == text


def test_a_factor_without_finite_decimal_is_a_fraction():
    assert texts.factor(Fraction(-5, 9)) == "−5/9"
    assert texts.factor(Fraction(-1, 100)) == "−0.01"


def field_with(folder, keys):
    bits = int(keys.removeprefix("bits: ").split(",")[0])
    field = f"at: 0, name: Value, {keys}"
    result = loaded(folder, status(field, length=bits // 8))
    assert result.ok, [finding.message for finding in result.findings]
    return result.icd.nodes[0].messages[0].fields[0]


@pytest.mark.parametrize(
    ("keys", "name", "raw", "physical"),
    [
        ("bits: 8, type: uint", "uint8", "0 … 255", ""),
        ("bits: 8, type: int", "int8", "−128 … 127", ""),
        ("bits: 8, type: uint, unit: s", "uint8", "0 … 255", "0 … 255"),
        ("bits: 8, type: uint, max: 9", "uint8", "0 … 255", "0 … 9"),
        (
            "bits: 8, type: int, formula: raw*0.5",
            "int8",
            "−128 … 127",
            "−64 … 63.5",
        ),
        ("bits: 32, type: float, min: -2", "float32", "", "−2 … "),
        ("bits: 32, type: float", "float32", "", ""),
        ("bits: 16, type: bytes", "bytes", "", ""),
    ],
)
def test_a_physical_range_is_shown_if_it_says_more_than_the_raw_one(
    tmp_path, keys, name, raw, physical
):
    field = field_with(tmp_path, keys)
    assert texts.type_name(field) == name
    assert texts.raw_range(field) == raw
    assert texts.physical_range(field) == physical


def test_ids_of_a_configuration_message_have_their_purpose(tmp_path):
    text = """\
messages:
  - {name: Mode, set_id: 10, get_id: 200, kind: configuration, length: 0}
  - {name: Reset, id: 3, kind: telecommand, length: 0}
"""
    mode, reset = loaded(tmp_path, text).icd.nodes[0].messages
    assert texts.ids(mode, None) == [
        ("set", 10, "10", "0A"),
        ("get", 200, "200", "C8"),
    ]
    assert texts.ids(reset, None) == [("id", 3, "3", "03")]


def test_a_text_is_clipped_only_if_it_is_too_long():
    assert_limits(lambda length: texts.clip("a" * length, 9) == "a" * length, most=9)
    assert texts.clip("abcd fghij", 6) == "abcd…"
    assert texts.clip("abcdefghij", 6) == "abcde…"


@pytest.mark.parametrize("value", ["</script>", "<!-- & -->", {"a<b": [1, None]}])
def test_json_in_a_script_element_has_no_markup_and_keeps_its_value(value):
    text = texts.script_json(value)
    assert not set("<>&") & set(text)
    assert json.loads(text) == value


def test_an_initial_capital_leaves_other_letters():
    assert [texts.capitalized(text) for text in ("aBC d", "", "1a")] == [
        "ABC d",
        "",
        "1a",
    ]


@pytest.mark.parametrize(
    ("kind", "widths", "text"),
    [
        ("uint", set(), ""),
        ("uint", {32, 8, 16}, "8, 16, 32"),
        ("uint", set(range(1, 9)), "1, 2, 3, 4, 5, 6, 7, 8"),
        ("bytes", {8, 16, 24, 32, 40, 48}, "8, 16, 24, 32, 40, 48"),
        ("bytes", {8, 16, 24, 32, 40, 48, 56}, "8 … 56"),
        ("text", {8, 16, 24, 32, 40, 48, 800}, "8 … 800"),
    ],
)
def test_more_than_six_widths_of_bytes_are_a_range(kind, widths, text):
    assert _widths(kind, widths) == text
