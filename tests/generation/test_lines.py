"""Lines of generated code and its comments have the width that fits, and no blanks at
their ends.
"""

from __future__ import annotations

import pytest

from icdgen.backends.lines import bracketed, commented, in_rows, plain, tamed, wrapped
from tests.limits import assert_limits


def test_paragraphs_of_a_comment_are_separated_without_blanks_at_the_end_of_a_line():
    paragraphs = ["Speed of the motor.", "", "Zero if it is off."]
    assert commented(paragraphs, 20, "    /// ", is_spaced=True) == [
        "    /// Speed of the",
        "    /// motor.",
        "    ///",
        "    /// Zero if it",
        "    /// is off.",
    ]
    assert commented(paragraphs, 30, " * ") == [
        " * Speed of the motor.",
        " * Zero if it is off.",
    ]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("a bc def", ["a bc def"]),
        ("a bc de fgh", ["a bc de", "fgh"]),
        ("a bc defg hi", ["a bc", "defg hi"]),
        ("abcdefghij kl", ["abcdefghij", "kl"]),
        ("a bcdefghijk", ["a", "bcdefghijk"]),
        ("abcdefgh ij", ["abcdefgh", "ij"]),
        ("", [""]),
    ],
)
def test_words_are_wrapped_at_blanks_and_long_words_have_their_own_line(text, lines):
    assert wrapped(text, 8) == lines


def test_items_are_on_one_line_if_it_fits_with_its_indentation():
    def has_one_line(length: int) -> bool:
        text = bracketed("f(", ["a", "b" * (length - 6)], ")", 40, "    ")
        if text.startswith("f(a"):
            assert len(text) == length
            return True
        assert text == f"f(\n        a,\n        {'b' * (length - 6)},\n    )"
        return False

    assert_limits(has_one_line, most=36)
    assert bracketed("f(", ["a", "b"], ")", 3, last="") == "f(\n    a,\n    b)"
    assert bracketed("f(", [], ")", 1) == "f()"


def test_invisible_and_direction_changing_characters_are_shown_as_code_points():
    assert plain("a\n b\u202ec\u200bd") == "a bU+202EcU+200Bd"
    assert plain("10 \u00b5A") == "10 \u00b5A"


def test_items_in_rows_each_have_a_comma():
    assert in_rows(["1", "2", "3"], 2) == ["1, 2,", "3,"]


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("+ a", "\\+ a"),
        ("* a", "\\* a"),
        ("=== a", "\\=== a"),
        ("## a", "\\## a"),
        ("-", "\\-"),
        ("7) a", "7\\) a"),
        (">a", "\\>a"),
        ("-a", "-a"),
        ("-5 a", "-5 a"),
        ("7.5 a", "7.5 a"),
        ("7 a.", "7 a."),
        ("a. b", "a. b"),
        ("", ""),
    ],
)
def test_only_the_first_word_of_a_line_can_be_the_start_of_a_block(line, text):
    assert tamed(line) == text
