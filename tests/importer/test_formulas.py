"""Formulas of texts and factors of columns become formulas of an ICD, or none."""

from __future__ import annotations

import pytest

from icdgen.importer.formulas import (
    ReadFormula,
    Scaled,
    find_formula,
    formula_of_step,
    mentions_formula,
    value_names,
)

NAMES = value_names(("RAW", "RAW counts"), ("value", "value of sensor"))


def formula_of(text: str) -> str | None:
    result = find_formula(text, NAMES)
    return None if result is None else result.formula


def test_a_formula_is_returned_with_its_unit_and_its_place():
    text = "Speed: ( value ) [ m / s ² ] = RAW counts*0.01. Signed."
    assert find_formula(text, NAMES) == ReadFormula(
        "raw*0.01", "m / s²", "physical", 7, text.index(". Signed")
    )
    text = "Send raw = value of sensor*10 [ms]"
    end = text.index(" [ms]")
    assert find_formula(text, NAMES) == ReadFormula("raw = value*10", "", "raw", 5, end)


def test_the_name_directly_in_front_of_the_sign_decides_about_the_direction():
    text = "the value of RAW = value*2"
    assert find_formula(text, NAMES) == ReadFormula(
        "raw = value*2", "", "raw", text.index("RAW"), len(text)
    )
    assert formula_of("the value here = RAW*2") is None
    assert formula_of("evalue = RAW*2") is None
    assert formula_of("values = RAW*2") is None
    assert formula_of("value = RAWs*2") is None


def test_the_first_equation_that_is_a_formula_counts():
    assert formula_of("value = 5 off, value = RAW*2, value = RAW*3") == "raw*2"
    assert formula_of("value = 5") is None
    # A physical value on both sides is no formula.
    assert formula_of("value = value*2") is None


@pytest.mark.parametrize("sign", ["*", "×", "·", "∙", "⋅", "∗", "x", "X"])
def test_each_sign_of_a_multiplication_is_an_asterisk_in_an_icd(sign):
    assert formula_of(f"value = RAW {sign} 2") == "raw*2"
    assert formula_of(f"value = RAW{sign}(2 + 1)") == (
        # `RAWx` is another name.
        None if sign in "xX" else "raw*(2 + 1)"
    )
    assert formula_of(f"value = RAW {sign}.5") == "raw*0.5"


@pytest.mark.parametrize("sign", ["/", "÷", ":"])
def test_each_sign_of_a_division_is_a_slash_in_an_icd(sign):
    assert formula_of(f"value = RAW {sign} 2") == "raw/2"
    assert formula_of(f"value = RAW{sign}2") == "raw/2"


@pytest.mark.parametrize("sign", ["-", "–", "−"])
def test_each_minus_is_a_hyphen_in_an_icd(sign):
    assert formula_of(f"value = RAW {sign}2") == "raw - 2"
    assert formula_of(f"value = {sign}RAW*2") == "-raw*2"
    assert formula_of(f"value = 2*({sign}RAW + 1)") == "2*(-raw + 1)"
    assert formula_of(f"value = 2*{sign}RAW") is None


@pytest.mark.parametrize(
    "behind",
    ["^3", " ^ 3", "²", "³", "*", " /x", "×k", "·k", "÷k", ":0x", ": 3", ",5", "V",
     "_3", "%", " + offset", "+k"],
)  # fmt: skip
def test_a_formula_that_goes_on_in_an_unknown_way_is_not_read(behind):
    assert formula_of(f"value = RAW*2{behind}") is None


@pytest.mark.parametrize(
    "behind", ["", " V", ".", ", in V", " - in V", ": the speed", "; x", ")", " (5 V)"]
)
def test_text_behind_a_formula_is_no_part_of_it(behind):
    text = f"value = RAW*2{behind}"
    assert find_formula(text, NAMES) == ReadFormula(
        "raw*2", "", "physical", 0, len("value = RAW*2")
    )


def test_a_formula_ends_with_its_last_closed_parenthesis():
    assert formula_of("value = (RAW - 32)*5/9 (in C)") == "(raw - 32)*5/9"
    assert formula_of("value = 2*((RAW + 1)/4 - 1)") == "2*((raw + 1)/4 - 1)"
    assert formula_of("value = ((RAW - 1)*2") is None
    assert formula_of("value = 3 + (RAW") is None


@pytest.mark.parametrize(
    ("text", "formula", "unit"),
    [
        ("0.01", "raw*0.01", ""),
        (".5", "raw*0.5", ""),
        ("1e-7", "raw*1e-7", ""),
        ("5E+3", "raw*5E+3", ""),
        ("1", "", ""),
        ("1.0 V", "", "V"),
        ("2^-20", "raw/1048576", ""),
        ("2 ^ − 3", "raw/8", ""),
        ("2^–1 deg", "raw/2", "deg"),
        ("2^3", "raw*8", ""),
        ("2^1", "raw*2", ""),
        ("2^0", "", ""),
        ("1 / 256", "raw/256", ""),
        ("1/10 V", "raw/10", "V"),
        ("10 mV/LSB", "raw*10", "mV"),
        ("10 mV / bit", "raw*10", "mV"),
        ("10mV/digit", "raw*10", "mV"),
        ("10 mV/count", "raw*10", "mV"),
        ("0.25 °C per bit", "raw*0.25", "°C"),
        ("LSB = 0.1 deg/s", "raw*0.1", "deg/s"),
        ("lsb=0.1 %", "raw*0.1", "%"),
        ("x 2", "raw*2", ""),
        ("× 2 [m/s]", "raw*2", "m/s"),
        ("*2", "raw*2", ""),
        ("RAW*0.1", "raw*0.1", ""),
        ("(RAW - 5)/2", "(raw - 5)/2", ""),
        ("value [V] = RAW*0.1", "raw*0.1", ""),
    ],
)
def test_a_factor_is_read_with_its_unit(text, formula, unit):
    assert formula_of_step(text, NAMES) == Scaled(formula, unit)


@pytest.mark.parametrize(
    "text",
    ["", "0", "linear", "0.1 m s", "0.1 0.2", "2^100", "RAW*0.1 V", "2-3", "1/x"],
)
def test_any_other_text_is_no_factor(text):
    assert formula_of_step(text, NAMES) is None


def test_a_column_of_factors_needs_no_names_of_values():
    assert formula_of_step("0.5 V", None) == Scaled("raw*0.5", "V")
    assert formula_of_step("RAW*0.5", None) is None


@pytest.mark.parametrize(
    ("text", "is_mentioned"),
    [
        ("value = see Table 5", True),
        ("value [V] = ?", True),
        ("RAW = ?", True),
        ("rate = 5, value=", True),
        ("rate = value*RAW", False),
        ("value (V) = RAW", False),
        ("value RAW", False),
    ],
)
def test_a_name_of_a_value_in_front_of_a_sign_mentions_a_formula(text, is_mentioned):
    assert mentions_formula(text, NAMES) == is_mentioned
