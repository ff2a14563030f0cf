"""Comments and strings of C: no text of an ICD ends them or is a command in them."""

from __future__ import annotations

import pytest

from icdgen.backends.c.text import (
    FILE,
    comment,
    described,
    literal,
    noted,
    plain,
    prose,
)
from icdgen.describe.comments import Comment
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("text", "safe"),
    [
        ("a */ b", "a * / b"),
        ("/* a", "/ * a"),
        ("/*/", "/ * /"),
        ("**//", "** //"),
        ("what???", "what? ? ?"),
        ("one? two?", "one? two?"),
        ("a\tb\x00", "a bU+0000"),
    ],
)
def test_delimiters_and_trigraphs_are_separated(text, safe):
    assert plain(text) == safe


@pytest.mark.parametrize(
    ("text", "escaped"),
    [
        ("@brief \\b", "\\@brief \\\\b"),
        ("a <b> <1 < 2", "a \\<b> <1 < 2"),
        ("</p> <!-- <?", "\\</p> \\<!-- \\<?"),
        ("&amp; & #1 # %x % 5", "\\&amp; & \\#1 # \\%x % 5"),
        ("*bold* a*b 2 * 3", "\\*bold* a*b 2 * 3"),
        ("_it_ snake_case", "\\_it_ snake_case"),
        ("~x~ a~b", "\\~x~ a~b"),
        ("[a](b) [a] [a]: b", "\\[a](b) [a] \\[a]: b"),
        ("::x", "::x"),
    ],
)
def test_commands_and_markup_of_doxygen_are_escaped(text, escaped):
    assert prose(text) == escaped


def test_a_comment_is_one_line_if_it_has_at_most_120_columns():
    def is_one_line(columns: int) -> bool:
        text = comment(["x" * (columns - 11)], "    ")
        assert text.startswith("    /**") and text.endswith("*/")
        return "\n" not in text

    assert_limits(is_one_line, most=120)
    assert comment(["A.", "", "B."], "  ") == "  /**\n   * A.\n   * B.\n   */"
    assert comment(["- a"]) == "/** \\- a */"


def test_only_the_generator_writes_commands():
    assert (
        comment([FILE, "@file is text."]) == "/**\n * @file\n * \\@file is text.\n */"
    )


def test_errata_are_notes_behind_the_details():
    about = Comment(
        "Rate: bits 0 to 7.", ("In *Hz*.",), ("Note E1: @wrong.", "Note E2.")
    )
    assert noted(about) == ["@note E1: @wrong.", "@note E2."]
    assert described(about, "    ") == "\n".join(
        (
            "    /**",
            "     * Rate: bits 0 to 7. In \\*Hz*.",
            "     * @note E1: \\@wrong.",
            "     * @note E2.",
            "     */",
        )
    )


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ('a "b" \\', '"a \\"b\\" \\\\"'),
        ("???", '"?\\?\\?"'),
        ("?a?", '"?a?"'),
        ("\n\x7f", '"\\012\\177"'),
        ("\xb51", '"\\302\\2651"'),
        ("~ ", '"~ "'),
    ],
)
def test_a_string_has_octal_escapes_of_its_bytes(text, source):
    assert literal(text) == source
