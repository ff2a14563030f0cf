"""Facts of the protocol are compared key by key, and rows of lists by their name."""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Place
from icdgen.diff.facts import FactDifference, _compare, _row_names, _Side, shown


def differences(old: object, new: object) -> list[tuple[str, object, object, bool]]:
    return [
        (difference.path, difference.old, difference.new, difference.is_word)
        for difference in _compare("link", _Side(old), _Side(new), is_word=False)
    ]


def test_each_differing_key_is_a_difference_with_its_path():
    old = {"a": 1, "b": {"c": 2, "d": 3}, "gone": 4, "same": [1, 2]}
    new = {"b": {"c": 2, "d": 5}, "a": 1, "same": [1, 2], "fresh": 6}
    assert differences(old, new) == [
        ("link.b.d", 3, 5, False),
        ("link.gone", 4, None, False),
        ("link.fresh", None, 6, False),
    ]


@pytest.mark.parametrize("key", ["source", "summary", "printed_constant"])
def test_keys_about_the_manual_are_words_with_everything_below(key):
    assert differences({key: {"page": 1}}, {key: {"page": 2}}) == [
        (f"link.{key}.page", 1, 2, True)
    ]
    old, new = ({key: [{"name": "A", "page": page}]} for page in (1, 2))
    assert differences(old, new) == [(f"link.{key}.A.page", 1, 2, True)]


def test_a_truth_value_is_not_the_number():
    assert differences(True, 1) == [("link", True, 1, False)]
    assert differences(0, False) == [("link", 0, False, False)]
    assert differences(True, True) == []


def test_rows_are_compared_by_name_so_that_an_insertion_is_one_difference():
    old = {"rows": [{"name": "A", "bits": 1}, {"name": "B", "bits": 2}]}
    new = {"rows": [{"name": "X"}, {"name": "A", "bits": 1}, {"name": "B", "bits": 3}]}
    assert differences(old, new) == [
        ("link.rows.B.bits", 2, 3, False),
        ("link.rows.X", None, {"name": "X"}, False),
    ]


def test_lists_without_mappings_are_compared_as_one_value():
    assert differences({"a": [1, 2]}, {"a": [2, 1]}) == [
        ("link.a", [1, 2], [2, 1], False)
    ]
    assert differences({"a": []}, {"a": [{"name": "A"}]}) == [
        ("link.a.A", None, {"name": "A"}, False)
    ]


def test_rows_are_named_by_name_role_or_value_and_repeated_names_are_numbered():
    rows = [
        {"role": "id", "value": 1},
        {"name": "N", "role": "id"},
        {"role": "constant", "value": 2},
        {"value": 3},
        {"role": "constant"},
        {"bits": 8},
        7,
        {"role": "constant"},
    ]
    assert _row_names(rows) == {
        "id": 0,
        "N": 1,
        "constant": 2,
        "3": 3,
        "constant#2": 4,
        "5": 5,
        "6": 6,
        "constant#3": 7,
    }


def test_a_difference_has_the_places_of_both_sides():
    old, new = Place("old.yaml", 3, 5), Place("new.yaml", 4, 6)
    assert list(_compare("link", _Side(1, None, old), _Side(2, None, new), False)) == [
        FactDifference("link", 1, 2, (old, new), False)
    ]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, ""),
        (True, "true"),
        (False, "false"),
        (9, "9"),
        (10, "10 (0x0A)"),
        (256, "256 (0x100)"),
        (-1, "-1"),
        ("DLE", "DLE"),
        ([1, 31, "a"], "[1, 31 (0x1F), a]"),
        ([], "[]"),
        (
            {"role": "id", "bits": 16, "source": "page 3", "summary": "x"},
            "{role: id, bits: 16 (0x10)}",
        ),
    ],
)
def test_values_are_shown_in_the_notation_of_the_icd(value, expected):
    assert shown(value) == expected
