"""The key `display`: its values, and the format in words."""

from __future__ import annotations

import pytest

from icdgen.icd.display import Display, display_of


@pytest.mark.parametrize(
    ("value", "display", "words"),
    [
        ("hex", Display("hex"), "displayed in hexadecimal"),
        ("binary", Display("binary"), "displayed in binary"),
        ({"decimals": 0}, Display("decimals", 0), "displayed with 0 decimals"),
        ({"decimals": 1}, Display("decimals", 1), "displayed with 1 decimal"),
        ({"decimals": 2}, Display("decimals", 2), "displayed with 2 decimals"),
        ({"digits": 1}, Display("digits", 1), "displayed with 1 significant digit"),
        ({"digits": 4}, Display("digits", 4), "displayed with 4 significant digits"),
    ],
)
def test_a_format_is_read_from_its_key_and_written_back(value, display, words):
    assert display_of(value) == display
    assert display.plain == value
    assert display.words == words


@pytest.mark.parametrize(
    "value", [None, "", "octal", "decimals", 2, [], {}, {"hex": 1}, {"digits": "2"}]
)
def test_other_values_are_no_format(value):
    assert display_of(value) is None


def test_an_unknown_key_beside_the_format_is_ignored():
    assert display_of({"width": 9, "digits": 3}) == Display("digits", 3)
