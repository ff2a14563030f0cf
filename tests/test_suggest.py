"""Suggestions for a misspelt name are similar to it; without similar names there are
none.
"""

from __future__ import annotations

import pytest

from icdgen.suggest import close_to, close_words


def test_the_closest_name_is_suggested_in_any_case():
    assert close_to("ROL", ["Pitch", "Roll", "Yaw"]) == "Roll"
    assert close_words("roll angle", ["Roll Angles", "Roll Angle", "Yaw"]) == [
        "Roll Angle",
        "Roll Angles",
    ]


def test_without_a_similar_name_there_is_no_suggestion():
    assert (
        close_to("xyz", ["Pitch", "Roll"]) == ""
        and close_words("", ["Roll"]) == []
        and close_to("a", []) == ""
    )


def test_only_the_beginning_of_a_long_text_is_compared():
    assert close_to("Roll" + "x" * 1_000_000, ["Roll"]) == ""


@pytest.mark.parametrize(
    ("wanted", "names"),
    [
        ("yellow", ["min", "max", "above", "below"]),
        ("limits", ["bits", "unit", "min"]),
        ("colour", ["count", "const"]),
        ("ad", ["at"]),
        ("red", ["name", "bits", "reserved"]),
    ],
)
def test_another_word_that_merely_looks_alike_is_not_suggested(wanted, names):
    assert close_words(wanted, names) == []


@pytest.mark.parametrize(
    ("wanted", "meant"),
    [
        ("lenght", "length"), ("bit", "bits"), ("naem", "name"), ("formular", "formula"), ("acknowlege", "acknowledge"),
        ("bitorder", "bit_order"), ("Estimted Atitude Angles", "Estimated Attitude Angles"),
    ],
)  # fmt: skip
def test_a_misspelt_name_is_recognised(wanted, meant):
    names = ["at", "identifier", "summary", "Magnetometer Data"]
    assert close_words(wanted, [*names, meant]) == [meant]


def test_a_name_without_one_of_its_words_is_recognised():
    assert close_to("Processed", ["Magic", "Processed Flag"]) == "Processed Flag"
    assert close_to("Levels[2]", ["Level", "Levels"]) == "Levels"
    assert close_words("Modes", ["Mode of Operation", "Mode"]) == ["Mode"]


def test_suggestions_are_unique_and_start_with_the_closest():
    assert close_words("roll", ["Rolls", "Roll Angle", "roll", "Rolls"]) == [
        "roll",
        "Rolls",
        "Roll Angle",
    ]
