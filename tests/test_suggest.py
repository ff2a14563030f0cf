"""What is suggested to somebody who wrote a name that there is not."""

from __future__ import annotations

from icdgen.suggest import close_to, close_words


def test_the_nearest_is_suggested_in_any_case():
    assert close_to("ROL", ["Pitch", "Roll", "Yaw"]) == "Roll"
    assert close_words("roll angle", ["Roll Angles", "Roll Angle", "Yaw"]) == ["Roll Angle", "Roll Angles"]


def test_nothing_is_suggested_where_nothing_comes_near():
    assert close_to("xyz", ["Pitch", "Roll"]) == "" and close_words("", ["Roll"]) == [] and close_to("a", []) == ""


def test_of_a_long_text_only_the_beginning_is_compared():
    assert close_to("Roll" + "x" * 1_000_000, ["Roll"]) == ""
