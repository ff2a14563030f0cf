"""The importer reads formulas, labels, masks and wrapped cells of descriptions."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.icd import formula as formulas
from icdgen.importer import descriptions, labels, profile
from icdgen.importer.rules import lists
from icdgen.importer.words import join

WORDS = profile.load()


@pytest.mark.parametrize(
    ("text", "formula", "unit", "words"),
    [
        ("(formatted value) [deg] = RAWVAL*0.01", "raw*0.01", "deg", ""),
        (
            "Formatted value is obtained using the formula: (formatted value) = RAWVAL/ 10000.0",
            "raw/10000.0",
            "",
            "",
        ),
        (
            "Raw parameter value is obtained using the formula: (formatted value) [m] = RAWVAL*0.1",
            "raw*0.1",
            "m",
            "raw",
        ),
        (
            "(raw parameter) = (formatted value)*10.0 (formatted value is in [m] units)",
            "raw = value*10.0",
            "m",
            "",
        ),
        ("physical value [°C] = raw value × 0.1 – 40", "raw*0.1 - 40", "°C", ""),
        ("Formatted value = 0.5 * (RAWVAL − 32)", "0.5*(raw - 32)", "", ""),
        ("(formatted value) [kg.m²] = RAWVAL*.5.", "raw*0.5", "kg.m²", ""),
        ("(formatted value) [V] = RAWVAL:10", "raw/10", "V", ""),
        ("(formatted value) [V] = RAWVAL ÷ 10", "raw/10", "V", ""),
        ("(formatted value) [V] = RAWVAL : 10 + 1", "raw/10 + 1", "V", ""),
        ("(formatted value) [V] = RAWVAL*0.1: the voltage", "raw*0.1", "V", ""),
        ("Torque. (Unit of measure is [A.m ² ])", "", "A.m²", ""),
        ("Speed of the wheel", "", "", ""),
    ],
)
def test_formulas_and_units_are_read_in_both_directions(text, formula, unit, words):
    read = descriptions.read_description(text, WORDS)
    assert (read.formula, read.unit, read.formula_for, read.problems) == (
        formula,
        unit,
        words,
        [],
    )


@pytest.mark.parametrize(
    "text", ["(formatted value) = RAWVAL^2", "(formatted value) [V] = RAWVAL*1,5", "(formatted value) = RAWVAL*RAWVAL",
             "(formatted value) = RAWVAL/1,000", "(formatted value) = sqrt(RAWVAL)", "(formatted value) = RAWVAL*0",
             "(formatted value) = RAWVAL: 10 means off", "(formatted value) = RAWVAL*2: 10 off"],
)  # fmt: skip
def test_a_formula_that_cannot_be_read_is_a_problem_and_not_a_shorter_one(text):
    read = descriptions.read_description(text, WORDS)
    assert read.formula == ""
    assert read.problems


@given(
    st.fractions(min_value=Fraction(1, 1000), max_value=1000, max_denominator=1000),
    st.integers(-500, 500),
)
def test_a_printed_formula_computes_the_same(factor, offset):
    shift = f"{'+' if offset >= 0 else '-'} {abs(offset)}"
    printed = f"(formatted value) [V] = RAWVAL * {factor.numerator}/{factor.denominator} {shift}"
    read = descriptions.read_description(printed, WORDS)
    assert formulas.parse(read.formula) == formulas.Scale(factor, Fraction(offset))


@pytest.mark.parametrize(
    ("text", "const"),
    [
        ("Magic number. Should equal 0x5A", "0x5A"),
        ("Has to be set to 90 (0x5A)", "0x5A"),
        ("This field should have a value of 1", "1"),
        ("Set to 0x5A to overwrite the segment", ""),
        ("Must be 0 or 1", ""),
        ("0xFFFF for infinite timeout", ""),
    ],
)
def test_a_magic_number_is_one_only_without_an_alternative(text, const):
    assert descriptions.read_description(text, WORDS).const == const


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("ID 132 Frame Length (bytes) 6", {"id": "132", "telemetry_length": "6"}),
        ("ID: 0x84 Length: 6 bytes", {"id": "0x84", "length": "6"}),
        (
            "ID 132 (0x84) Frame Length (bytes) 6",
            {"id": "132", "telemetry_length": "6"},
        ),
        (
            "Set ID/Get ID 3 / 131 Parameters Length (bytes) 1",
            {"both_ids": "3/131", "telecommand_length": "1"},
        ),
        ("ID 7 Parameters (bytes) Length 1", {"id": "7", "telecommand_length": "1"}),
    ],
)
def test_labels_are_read_in_whatever_cells_they_stand(text, values):
    assert {
        part.what: part.value for part in labels.parse_labels(text, WORDS)
    } == values
    assert labels.begins_message_table(text, WORDS)


@pytest.mark.parametrize(
    "text", ["ID 5 is used by the loader", "Description ID 5", "5 ID", "0 8 ID UINT ID"]
)
def test_prose_and_fields_do_not_begin_a_message(text):
    assert not labels.begins_message_table(text, WORDS)


@pytest.mark.parametrize(
    ("parts", "vocabulary", "joined"),
    [
        (["RAWVAL/", "10000.0"], (), "RAWVAL/10000.0"),
        (["format/", "erase"], (), "format/erase"),
        (["yaw-", "only"], ("yaw-only",), "yaw-only"),
        (["yaw-", "only"], (), "yaw-only"),
        (["infor-", "mation"], ("information",), "information"),
        (["Frame -", "Table 3"], (), "Frame - Table 3"),
        (["deg", "ree"], (), "deg ree"),
    ],
)
def test_wrapped_cells_are_joined(parts, vocabulary, joined):
    assert join(parts, frozenset(vocabulary)) == joined


@given(st.integers(0, 79))
def test_a_mask_with_one_bit_is_that_bit(bit):
    assert lists.bit_of_mask((1 << bit).to_bytes(10, "little").hex(" ")) == bit


@pytest.mark.parametrize("mask", ["00 00", "03 00", "zz", "1"])
def test_a_mask_with_no_or_several_bits_has_no_position(mask):
    assert lists.bit_of_mask(mask) is None
