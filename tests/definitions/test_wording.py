"""Names, texts, numbers and limits of definitions in the spelling of an ICD."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.definitions import wording
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Power Unit-2.dbc", "power_unit_2"),
        ("some/folder/Bus.kcd", "bus"),
        ("Größe", "grosse"),
        ("__a__b__", "a_b"),
        ("9axis", "node_9axis"),
        ("", "node"),
        ("---", "node"),
        ("con", "node_con"),
        ("COM1", "node_com1"),
        ("com0", "com0"),
        ("a" * 40, "a" * 40),
        ("a" * 41, "a" * 40),
        ("a" * 39 + " b", "a" * 39),
    ],
)
def test_a_node_name_is_an_identifier_of_at_most_40_characters(text, name):
    assert wording.node_name(text) == name


def test_a_line_is_cut_after_the_longest_length_at_a_word():
    assert_limits(lambda size: wording.line("a" * size, 10) == "a" * size, most=10)
    assert wording.line("a" * 11, 10) == "aaaaaa ..."
    assert wording.line("aaa bb cccc", 10) == "aaa bb ..."
    assert wording.line("aaaaa bbbbb", 10) == "aaaaa ..."
    assert_limits(lambda size: wording.line("a" * size) == "a" * size, most=4000)


def test_a_line_has_no_unprintable_characters():
    assert wording.line(" a\t\nb\x00\x1b[0m c ") == "a b [0m c"
    assert wording.line("a\x7fb\x85c\x9fd") == "a b c d"
    assert (
        wording.line("µ \u4e2d \U0001f600 \ufffd ~") == "µ \u4e2d \U0001f600 \ufffd ~"
    )
    assert wording.line("a\ud800b\ufffec") == "a b c"
    assert wording.line(None) == ""


def test_a_summary_is_a_line_if_there_is_text():
    assert wording.summary(" a\nb ") == {"summary": "a b"}
    assert wording.summary(" \n") == wording.summary(None) == {}


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("V", "V"),
        (" km/h ", "km/h"),
        ("degrees", "deg"),
        ("percent", "%"),
        ("Nm", "N.m"),
        ("a" * 60, "a" * 60),
        ("a" * 61, "a" * 56 + " ..."),
        ("SED", None),
        ("None", None),
        ("N/A", None),
        ("[-]", None),
        ("yes/no", None),
        ("", None),
        (None, None),
    ],
)
def test_a_unit_has_the_spelling_of_icdgen_and_placeholders_are_none(text, unit):
    assert wording.unit(text) == ({} if unit is None else {"unit": unit})


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (0, "0"),
        (0.0, "0"),
        (5.0, "5"),
        (100.0, "100"),
        (-0.25, "-0.25"),
        (0.1, "0.1"),
        (1e-6, "0.000001"),
        (9.5e-7, "9.5e-7"),
        (-9.5e-7, "-9.5e-7"),
        (1e23, "100000000000000000000000"),
        (1e24, "1e+24"),
        (Decimal("1.500"), "1.5"),
        (Decimal("1E+2"), "100"),
        (Decimal("1.0E-7"), "1.0e-7"),
    ],
)
def test_a_printed_number_has_an_exponent_below_a_millionth_and_from_1e24_on(
    number, text
):
    assert wording.printed(number) == text


@pytest.mark.parametrize(
    ("factor", "offset", "formula"),
    [
        ("1", "0", None),
        ("1.0", "0.0", None),
        ("1", "-40", "raw - 40"),
        ("0.5", "0", "raw*0.5"),
        ("-0.5", "2", "-raw*0.5 + 2"),
        ("-1", "0", "-raw*1"),
    ],
)
def test_a_formula_has_the_digits_of_factor_and_offset(factor, offset, formula):
    expected = {} if formula is None else {"formula": formula}
    assert wording.formula(factor, offset) == expected


def limits(low, high):
    exact = [None if end is None else Fraction(end) for end in (low, high)]
    return wording.limits(*exact, Fraction(0), Fraction(255))


@pytest.mark.parametrize(
    ("low", "high", "keys"),
    [
        (None, None, {}),
        (0, 255, {}),
        (-1, 256, {}),
        (1, 254, {"min": 1, "max": 254}),
        (None, 254, {"max": 254}),
        (1, None, {"min": 1}),
        (7, 7, {"min": 7, "max": 7}),
        (0, 0, {"max": 0}),
        (255, 255, {"min": 255}),
        ("1/2", "3/2", {"min": 0.5, "max": 1.5}),
        ("1/100000", 9, {"max": 9}),  # 1e-05
        ("1/10000", 9, {"min": 0.0001, "max": 9}),
        (8, 7, {}),
        (256, 300, {}),
        (-5, -1, {}),
        (None, -1, {}),
    ],
)
def test_limits_are_keys_if_they_exclude_values(low, high, keys):
    result = limits(low, high)
    assert result == keys
    assert [type(value) for value in result.values()] == list(map(type, keys.values()))


def test_limits_have_fewer_than_39_digits():
    far = Fraction(10**50)

    def has_limit(number):
        end = Fraction(number)
        lower = wording.limits(-end, None, -far, far) == {"min": -number}
        assert lower == (wording.limits(None, end, -far, far) == {"max": number})
        return lower

    assert_limits(has_limit, most=10**38 - 1)


@pytest.mark.parametrize(
    ("name", "result"),
    [
        ("Voltage_Type", "Voltage"),
        ("VoltageType", "Voltage"),
        ("voltage type", "voltage"),
        ("voltage_t", "voltage"),
        ("Type", "Type"),
        ("_t", "_t"),
        ("prototype_a", "prototype_a"),
        ("Mode TYPE", "Mode TYPE"),
        ("set", "set"),
    ],
)
def test_a_type_name_loses_its_suffix(name, result):
    assert wording.without_type(name) == result


def test_the_shortest_unique_suffix_of_a_path_is_its_name():
    paths = [("a", "b", "x"), ("c", "b", "x"), ("y",), ("b", "z"), ("z",)]
    assert wording.shortest(paths) == ["a b x", "c b x", "y", "b z", "z"]
    assert wording.shortest([]) == []
    assert wording.shortest([("a", "x"), ("a", "x")]) == ["a x", "a x"]


WORDS = st.sampled_from("ab")
PATHS = st.lists(st.lists(WORDS, min_size=1, max_size=4).map(tuple), max_size=8)


@given(PATHS)
def test_suffixes_of_different_paths_differ_unless_one_contains_the_other(paths):
    names = wording.shortest(paths)
    for path, name in zip(paths, names, strict=True):
        words = tuple(name.split())
        assert path[-len(words) :] == words
        shorter = " ".join(words[1:])
        # No shorter suffix would do: another path has it, too.
        assert len(words) == 1 or any(
            other is not path and " ".join(other).endswith(shorter) for other in paths
        )
    for first, one in zip(paths, names, strict=True):
        for second, other in zip(paths, names, strict=True):
            assert first == second or one != other
