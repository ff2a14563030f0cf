"""What is suggested to somebody who wrote a name that there is not."""

from __future__ import annotations

import pytest

from icdgen.suggest import close_to, close_words


def test_the_nearest_is_suggested_in_any_case():
    assert close_to("ROL", ["Pitch", "Roll", "Yaw"]) == "Roll"
    assert close_words("roll angle", ["Roll Angles", "Roll Angle", "Yaw"]) == [
        "Roll Angle",
        "Roll Angles",
    ]


def test_nothing_is_suggested_where_nothing_comes_near():
    assert (
        close_to("xyz", ["Pitch", "Roll"]) == ""
        and close_words("", ["Roll"]) == []
        and close_to("a", []) == ""
    )


def test_of_a_long_text_only_the_beginning_is_compared():
    assert close_to("Roll" + "x" * 1_000_000, ["Roll"]) == ""


@pytest.mark.parametrize(
    ("wanted", "known"),
    [
        ("yellow", ["min", "max", "above", "below"]),
        ("limits", ["bits", "unit", "min"]),
        ("colour", ["count", "const"]),
        ("ad", ["at"]),
        ("red", ["name", "bits", "reserved"]),
    ],
)
def test_another_word_that_merely_looks_alike_is_not_suggested(wanted, known):
    assert close_words(wanted, known) == []


@pytest.mark.parametrize(
    ("wanted", "meant"),
    [
        ("lenght", "length"), ("bit", "bits"), ("naem", "name"), ("formular", "formula"), ("acknowlege", "acknowledge"),
        ("bitorder", "bit_order"), ("Estimted Atitude Angles", "Estimated Attitude Angles"),
    ],
)  # fmt: skip
def test_a_slip_is_recognised(wanted, meant):
    others = ["at", "identifier", "summary", "Magnetometer Data"]
    assert close_words(wanted, [*others, meant]) == [meant]


def test_a_name_without_one_of_its_words_is_recognised():
    assert close_to("Processed", ["Magic", "Processed Flag"]) == "Processed Flag"
    assert close_to("Levels[2]", ["Level", "Levels"]) == "Levels"
    assert close_words("Modes", ["Mode of Operation", "Mode"]) == ["Mode"]


def test_the_nearest_comes_first_and_each_once():
    assert close_words("roll", ["Rolls", "Roll Angle", "roll", "Rolls"]) == [
        "roll",
        "Rolls",
        "Roll Angle",
    ]
