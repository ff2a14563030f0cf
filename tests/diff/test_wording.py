"""Phrases in messages of changes have exact numbers, signs and units."""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.diff import wording
from icdgen.icd.curve import Curve, CurvePiece
from icdgen.icd.formula import Scale
from icdgen.icd.lines import lines
from tests.icd.files import loaded, status


@pytest.mark.parametrize(
    ("number", "expected"),
    [
        (0, ""),
        (1, "`N0`"),
        (2, "`N0` and `N1`"),
        (4, "`N0`, `N1`, `N2` and `N3`"),
        (5, "`N0`, `N1`, `N2`, `N3` and 1 more (5 fields)"),
        (7, "`N0`, `N1`, `N2`, `N3` and 3 more (7 fields)"),
    ],
)
def test_at_most_four_names_are_listed_and_the_others_counted(number, expected):
    names = [f"N{index}" for index in range(number)]
    assert wording.some(names, "field") == expected
    assert wording.some(names) == expected.removesuffix(f" ({number} fields)")


@pytest.mark.parametrize(
    ("bits", "expected"),
    [
        (0, "0 bits"),
        (1, "1 bit"),
        (7, "7 bits"),
        (8, "1 byte"),
        (9, "9 bits"),
        (16, "2 bytes"),
    ],
)
def test_sizes_of_whole_bytes_are_in_bytes(bits, expected):
    assert wording.bits(bits) == expected


def test_numbers_are_exact_and_a_missing_number_is_empty():
    assert wording.number(None) == ""
    assert wording.number(0) == "0"
    assert wording.number(Fraction(1, 100)) == "0.01"
    assert wording.number(Fraction(1, 3)) == "1/3"


@pytest.mark.parametrize(
    ("scale", "expected"),
    [
        (None, "raw"),
        (Scale(Fraction(1)), "raw"),
        (Scale(Fraction(1), Fraction(5)), "raw + 5"),
        (Scale(Fraction(1, 2), Fraction(-40)), "raw*0.5 - 40"),
        (Scale(Fraction(1), Fraction(1, 4)), "raw + 0.25"),
        (Scale(Fraction(-1)), "raw*-1"),
        (Scale(Fraction(5, 9), Fraction(-160, 9)), "raw*5/9 - 160/9"),
    ],
)
def test_linear_formulas_have_one_notation(scale, expected):
    assert wording.formula(scale) == expected


@pytest.mark.parametrize(
    ("coefficients", "expected"),
    [
        ((-40.0, 0.02, 3e-06), "3e-06*raw^2 + 0.02*raw - 40"),
        ((0.0, 0.0, 1.0), "raw^2"),
        ((0.0, 1.0, -1.0), "-raw^2 + raw"),
        ((1.0, 0.0, 0.0, -2.0), "-2*raw^3 + 1"),
        ((-2.5,), "-2.5"),
        ((0.0, 0.0), "0"),
        ((0.0, 0.12345678, 1.0), "raw^2 + 0.12345678*raw"),
    ],
)
def test_polynomials_begin_with_the_highest_power(coefficients, expected):
    curve = Curve((CurvePiece(0.0, coefficients),))
    assert wording.formula(curve) == expected


def test_a_lookup_table_shows_at_most_six_points():
    def text(number: int) -> str:
        points = tuple((float(10 * n), float(n)) for n in range(number))
        return wording.formula(Curve((), points))

    assert text(3) == "a table (0: 0, 10: 1, 20: 2)"
    assert text(6) == "a table (0: 0, 10: 1, 20: 2, 30: 3, 40: 4, 50: 5)"
    assert (
        text(7) == "a table (0: 0, 10: 1, 20: 2, 30: 3, 40: 4, ... (7 points), 60: 6)"
    )


ENUM = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}]}
  - {name: Sense, members: [{value: -1, name: Back}, {value: 1, name: Forth}]}
"""


def test_types_have_size_sign_and_enumeration(tmp_path):
    text = ENUM + status(
        "at: 0, bits: 1, name: Flag, type: bool",
        "at: 1, bits: 4, name: Mode, type: enum, enum: Mode",
        "at: 5, bits: 3, name: Sense, type: enum, enum: Sense",
        "at: 16, bits: 16, name: Rate, type: int, count: 3",
        "at: 64, bits: 32, name: Level, type: float",
        length=12,
    )
    result = loaded(tmp_path, text)
    assert result.findings == []
    (message,) = result.icd.nodes[0].messages
    fields = {field.name: field for field in lines(message.layout)}
    assert {name: wording.type_of(field) for name, field in fields.items()} == {
        "Flag": "bool",
        "Mode": "4-bit enum Mode",
        "Sense": "3-bit signed enum Sense",
        "Rate": "3 elements, 16-bit int",
        "Level": "32-bit float",
    }
    assert [wording.read_as(field) for field in fields.values()] == [
        "bool",
        "enum",
        "signed enum",
        "int",
        "float",
    ]
    assert [wording.span(fields[name]) for name in ("Flag", "Mode", "Level")] == [
        "bit 0",
        "bits 1 to 4",
        "bits 64 to 95",
    ]


def test_ids_are_separated_by_a_slash():
    assert wording.ids([120, None, 247]) == "120 / 247"
    assert wording.ids([0]) == "0"
    assert wording.ids([None]) == ""
