"""Similarity of names: exact scores, and typing errors in words of five letters or more."""

from __future__ import annotations

import pytest

from icdgen.diff.similar import (
    extends,
    letters,
    likeness,
    other_senses,
    overlap,
    same_sense,
)
from icdgen.icd.model import Enum
from tests.icd.files import loaded


def test_likeness_is_the_share_of_common_pairs_of_letters():
    assert letters("Roll") == {" r", "ro", "ol", "ll", "l "}
    assert likeness("Roll", "roll") == 1
    assert likeness("", "") == 1
    assert likeness("", "Roll") == 0
    # Five pairs each, of which "ol", "ll" and "l " are common.
    assert likeness("Roll", "Poll") == 2 * 3 / 10
    assert likeness("Roll", "Rolls") == 2 * 4 / 11


def test_overlap_is_the_share_of_common_elements():
    assert overlap(frozenset((1, 2, 3)), frozenset((2, 3, 4, 5))) == 2 / 5
    assert overlap(frozenset(), frozenset((1,))) == 0
    assert overlap(frozenset((1,)), frozenset((1,))) == 1
    assert overlap(frozenset(), frozenset()) == 0.5


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        # A word of four letters is too short for the recognition of typing errors.
        ("valv", "valve", False),
        ("valve", "valvee", True),
        ("size", "sise", False),
        ("resize", "resise", True),
        ("motor", "motro", True),  # swapped letters
        ("motor", "mrtoo", True),  # also if they are not adjacent
        ("motor", "motar", False),  # another letter
        ("motor", "mutar", False),  # two other letters
        ("motor", "otor", False),  # the first letter
        ("motor", "umotor", False),
        ("motor", "moottor", False),  # two letters more
        ("motor", "motor motor", False),
        ("motor valve", "motro vavle", True),  # one error in each word
        ("motor valve", "motro pump", False),
    ],
)
def test_one_typing_error_in_a_word_is_the_same_meaning(first, second, expected):
    assert same_sense(first, second) is same_sense(second, first) is expected


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ("Control Mode", "Control Target Mode", True),
        ("Mode Control", "Control Target Mode", False),  # in another order
        ("Mode", "mode", True),
        ("", "Mode", False),
        ("Mode", "Mode Off", False),
        ("Mode Off", "Mode Off Time", False),
        ("Mode", "Target", False),
    ],
)
def test_a_longer_name_has_the_words_of_the_other_in_order(first, second, expected):
    assert extends(first, second) is extends(second, first) is expected


def enum_of(folder, members: str) -> Enum:
    folder.mkdir()
    text = f"enums: [{{name: Mode, members: [{members}]}}]\n"
    return loaded(folder, text).icd.nodes[0].enums[0]


def test_values_with_another_meaning_are_listed_in_ascending_order(tmp_path):
    old = "{value: 9, name: Idle}, {value: 1, name: Stop}, {value: 4, name: Boot}"
    new = "{value: 1, name: Start}, {value: 9, name: Sleep}, {value: 4, name: BOOT}"
    senses = other_senses(enum_of(tmp_path / "a", old), enum_of(tmp_path / "b", new))
    assert senses == [1, 9]


def test_a_removed_or_added_value_has_no_other_meaning(tmp_path):
    old = "{value: 0, name: Idle}, {value: 1, name: Stop}"
    new = "{value: 1, name: Stop}, {value: 2, name: Run}"
    senses = other_senses(enum_of(tmp_path / "a", old), enum_of(tmp_path / "b", new))
    assert senses == []


def test_of_a_range_the_first_and_last_value_are_listed(tmp_path):
    old = "{value: 0, name: Idle}, {value: 10, to: 20, name: Spare}"
    new = "{value: 0, name: Idle}, {value: 5, to: 15, name: Vendor}"
    senses = other_senses(enum_of(tmp_path / "a", old), enum_of(tmp_path / "b", new))
    assert senses == [10, 15]
