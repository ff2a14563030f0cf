"""Formulas and lookup tables: limits of ranges, the direction of formulas, and which
messages are sent.
"""

from __future__ import annotations

import pytest

from icdgen.icd.rules import formulas
from tests.icd.files import status
from tests.icd.rules.rows import messages, rows
from tests.limits import assert_limits


def points(first: int, last: int, more: str = "", type: str = "uint") -> str:
    table = f"points: [[{first}, 1], [{last}, 2]]"
    return status(f"at: 0, bits: 8, name: Level, type: {type}, {table}{more}", length=1)


@pytest.mark.parametrize(
    ("type", "least", "most"), [("uint", 0, 255), ("int", -128, 127)]
)
def test_outside_is_needed_if_a_raw_value_lies_beyond_the_points(
    tmp_path, type, least, most
):
    def covers(first: int, last: int) -> bool:
        return messages(tmp_path, points(first, last, type=type), "ICD068") == []

    assert_limits(lambda first: covers(first, most), most=least)
    assert_limits(lambda last: covers(least, last), least=most)
    assert messages(tmp_path, points(2, 1000, type=type), "ICD068") == [
        f"raw values of `Level` are {least} to {most}, its points go from 2 to 1000, "
        "and `outside` is missing"
    ]


@pytest.mark.parametrize(
    ("outside", "what"),
    [("clamp", "the same physical value"), ("refuse", "no physical value")],
)
def test_a_table_and_the_raw_values_have_one_value_in_common(tmp_path, outside, what):
    def is_accepted(first: int, last: int) -> bool:
        text = points(first, last, f", outside: {outside}", "int")
        expected = (
            f"the points of `Level` go from {first} to {last}, its raw values from "
            f"-128 to 127: each of them has {what}"
        )
        reported = messages(tmp_path, text, "ICD069")
        assert reported in ([], [expected])
        return not reported

    assert_limits(lambda first: is_accepted(first, 500), most=127)
    assert_limits(lambda last: is_accepted(-500, last), least=-128)


def test_tables_that_extrapolate_need_no_raw_values_in_common(tmp_path):
    text = points(300, 400, ", outside: extrapolate")
    assert messages(tmp_path, text, "ICD069") == []
    assert messages(tmp_path, text, "ICD068") == []


def field(name: str, formula: str, more: str = "") -> str:
    return f"at: 0, bits: 8, name: {name}, type: uint, formula: {formula}{more}"


RAW, PHYSICAL = "raw = value*2", "raw*2"


@pytest.mark.parametrize(
    ("stated", "fields", "expected"),
    [
        ("raw", [RAW, RAW], ""),
        ("physical", [PHYSICAL, PHYSICAL], ""),
        ("raw", [PHYSICAL, RAW, PHYSICAL], "`F0` gives the other one, as in 2 fields"),
        ("physical", [PHYSICAL, RAW], "`F1` gives the other one, as in 1 field"),
        ("raw", [PHYSICAL + ", formula_for: raw", RAW], ""),
    ],
)
def test_the_formulas_of_a_kind_are_counted_that_give_the_other_value(
    tmp_path, stated, fields, expected
):
    """Fields that state it themselves are not counted, nor those of other kinds."""
    text = f"formula_for: {{telemetry: {stated}}}\nmessages:\n"
    for n, formula in enumerate(fields):
        text += f"  - {{name: M{n}, id: {n + 10}, kind: telemetry, length: 1, fields: [{{{field(f'F{n}', formula)}}}]}}\n"
    other = PHYSICAL if stated == "raw" else RAW
    for kind in "telecommand", "configuration":
        ids = "id: 1" if kind == "telecommand" else "set_id: 2, get_id: 30"
        text += f"  - {{name: {kind}, {ids}, kind: {kind}, length: 1, fields: [{{{field('X', other)}}}]}}\n"
    reported = [row for row in rows(tmp_path, text, "ICD062") if row.startswith("3:")]
    if expected:
        wanted = (
            f"the formulas of telemetry messages should give the {stated} value "
            f"according to the manual, but that of {expected} altogether"
        )
    else:
        wanted = (
            f"no formula of a telemetry message gives anything but the {stated} value, "
            "so the key is not needed"
        )
    assert reported == [f"3:26 {wanted}"]


@pytest.mark.parametrize(
    ("number", "shown"),
    [
        (2**64 - 1, "18,446,744,073,709,551,615"),
        (2**64, "1.84e+19"),
        (-(2**64), "-1.84e+19"),
        (2**1000 - 1, "1.07e+301"),
        (2**1000, "(a number of 1,001 bits)"),
        (-(2**1000), "(a number of 1,001 bits)"),
    ],
)
def test_large_numbers_are_shown_in_few_words(number, shown):
    assert formulas._shown(number) == shown


def test_each_field_with_a_formula_that_is_too_large_is_reported(tmp_path):
    """Also a formula that another field has."""
    large = "raw*(2^181) + 7"
    text = status(
        f"at: 0, bits: 8, name: A, type: uint, formula: {large}",
        "at: 8, bits: 8, name: B, type: uint, formula: raw*2",
        f"at: 16, bits: 8, name: C, type: uint, formula: {large}",
        length=3,
    )
    text_of = (
        "the formula of `{}` needs numbers that are too large: (raw*3.06e+54 + 7) / 1"
    )
    assert rows(tmp_path, text, "ICD064") == [
        f"9:56 {text_of.format('A')}",
        f"11:57 {text_of.format('C')}",
    ]


MESSAGE = (
    "  - {{name: {}, {}, length: 2, fields: [{{at: 0, name: Both, struct: Outer}}]}}\n"
)
TELEMETRY, TELECOMMAND, CONFIGURATION = (
    "id: 130, kind: telemetry",
    "id: 3, kind: telecommand",
    "set_id: 4, get_id: 131, kind: configuration",
)
STRUCTS = """\
structs:
  - {name: Inner, length: 1, fields: [{at: 0, bits: 8, name: Curve, type: int, formula: raw^2}]}
  - name: Outer
    length: 2
    fields: [{at: 0, name: In, struct: Inner}, {at: 8, bits: 8, name: Own, type: int, formula: raw^4}]
messages:
"""


@pytest.mark.parametrize(
    ("kinds", "sender"),
    [
        ([TELEMETRY], ""),
        ([TELEMETRY, TELECOMMAND, CONFIGURATION], "M1"),
        ([TELEMETRY, CONFIGURATION, TELECOMMAND], "M1"),
    ],
)
def test_formulas_of_structs_in_sent_messages_are_inverted(tmp_path, kinds, sender):
    """The first message that is sent is named, also for nested structs."""
    text = STRUCTS + "".join(
        MESSAGE.format(f"M{n}", kind) for n, kind in enumerate(kinds)
    )
    why = "is sent: its values are not strictly increasing or decreasing"
    assert rows(tmp_path, text, "ICD066") == (
        [
            f"4:89 the formula of `Curve` cannot be inverted, but `{sender}` {why}",
            f"7:96 the formula of `Own` cannot be inverted, but `{sender}` {why}",
        ]
        if sender
        else []
    )


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ("bits: 16, type: uint, formula: raw^2", ""),
        (
            "bits: 17, type: uint, formula: raw^2",
            "formula of `X` cannot be inverted, but `Set` is sent: for a polynomial, this "
            "is only computed for fields of up to 16 bits",
        ),
        (
            "bits: 16, type: int, view: true, formula: raw^2",
            "",
        ),
        (
            "bits: 8, type: uint, points: [[254, 0], [255, 1]], outside: clamp",
            "",
        ),
        (
            "bits: 8, type: uint, points: [[255, 0], [256, 1]], outside: clamp",
            "table of `X` cannot be inverted, but `Set` is sent: no two raw values lie "
            "between its points",
        ),
    ],
)
def test_two_raw_values_and_16_bits_can_be_inverted(tmp_path, fields, why):
    text = f"messages:\n  - {{name: Set, id: 3, kind: telecommand, length: 4, fields: [{{at: 0, name: X, {fields}}}]}}\n"
    assert messages(tmp_path, text, "ICD066") == ([f"the {why}"] if why else [])


def test_a_number_is_the_only_type_with_a_formula_a_table_or_a_unit(tmp_path):
    text = "enums:\n  - {name: Mode, members: [{value: 0, name: Idle}]}\n" + status(
        "at: 0, bits: 8, name: A, type: uint, unit: V, formula: raw*2",
        "at: 8, bits: 8, name: B, type: int, unit: V, formula: raw*2",
        "at: 16, bits: 32, name: C, type: float, unit: V, formula: raw*2",
        "at: 48, bits: 1, name: D, type: bool, formula: raw*2, unit: V",
        "at: 56, bits: 8, name: E, type: enum, enum: Mode, formula: raw*2, unit: V",
        "at: 64, bits: 8, name: F, type: text, points: [[0, 1], [1, 2]], unit: V",
        "at: 72, bits: 8, name: G, type: bytes, formula: raw*2, unit: V",
        length=10,
    )
    assert messages(tmp_path, text, "ICD061") == [
        "`D` is `bool`, which takes no formula",
        "`E` is `enum`, which takes no formula",
        "`F` is `text`, which takes no lookup table",
        "`G` is `bytes`, which takes no formula",
    ]
    assert messages(tmp_path, text, "ICD063") == [
        "`D` is `bool`, which has no unit",
        "`E` is `enum`, which has no unit",
        "`F` is `text`, which has no unit",
        "`G` is `bytes`, which has no unit",
    ]
