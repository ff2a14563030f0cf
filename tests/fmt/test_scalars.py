"""Spelling of scalars: quotes, escapes, block scalars, and where long texts break."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.icd.fmt import scalars
from icdgen.icd.fmt.commented import ScalarText
from tests.limits import assert_limits

WIDTH = 120  # longest line, as the documentation says


def text(value: str) -> ScalarText:
    return ScalarText(value, value)


def number(spelling: str) -> ScalarText:
    return ScalarText(None, spelling)


@pytest.mark.parametrize(
    ("value", "in_block", "in_flow"),
    [
        ("word", True, True),
        ("two words", True, True),
        ("a, b", True, False),
        ("[a]", False, False),
        ("a [V]", True, False),
        ("a {b}", True, False),
        ("who?", True, False),
        ("a:b", True, False),
        ("a: b", False, False),
        ("a:", False, False),
        ("a #b", False, False),
        ("a#b", True, True),
        ("-a", False, False),
        ("-5 to 5", True, True),
        ("+5 V", True, True),
        (".com", True, True),
        ("- a", False, False),
        ("-", False, False),
        (".a", False, False),
        ("..a", False, False),
        ("(a)", True, True),
        ("/a", True, True),
        ("_a", True, True),
        ("$a", True, True),
        ("^a", True, True),
        (";a", True, True),
        ("+a", False, False),
        ("*a", False, False),
        ("&a", False, False),
        ("!a", False, False),
        ("%a", False, False),
        ("@a", False, False),
        ("a ", False, False),
        (" a", False, False),
        ("", False, False),
        ("1", False, False),
        ("1a", True, True),
        ("0b0010 0100", False, False),
        ("0x", False, False),
        ("0Og", False, False),
        ("1.5", False, False),
        ("2020-11-03", False, False),
        ("tab\there", False, False),
        ("é", True, True),
        ("\u2028", False, False),
    ],
)
def test_texts_are_quoted_only_where_they_could_be_read_as_something_else(
    value, in_block, in_flow
):
    assert (scalars.quoted_if_needed(value, False) == value) == in_block
    assert (scalars.flow(text(value)) == value) == in_flow


@pytest.mark.parametrize(
    "word", ["y", "yes", "n", "no", "on", "off", "true", "false", "null"]
)
def test_words_with_a_meaning_in_some_version_of_yaml_are_quoted(word):
    for value in (word, word.upper(), word.capitalize()):
        assert scalars.quoted_if_needed(value, False) == f'"{value}"'
        assert scalars.quoted_if_needed(value + "x", False) == value + "x"


@settings(max_examples=300, deadline=None)
@given(
    st.text(
        st.sampled_from(
            "ab1 0x.-:#,[]{}\"'\\|>%*&!?@`~=<\t\n\r\0\x85\xad\u2028\uffff😀é"
        ),
        max_size=8,
    )
)
def test_another_reader_of_yaml_reads_every_text_as_it_was(value):
    if "\uffff" in value:  # PyYAML accepts it only as an escape
        assert "\uffff" not in scalars.flow(text(value))
    assert yaml.safe_load(f"{{key: {scalars.flow(text(value))}}}") == {"key": value}
    lines = scalars.block(text(value), 5, 2)
    assert yaml.safe_load("key: " + "\n".join(lines) + "\n") == {"key": value}
    assert yaml.safe_load(f"{{{scalars.key(text(value), True)}: 1}}") == {value: 1}


@pytest.mark.parametrize(
    ("value", "spelling"),
    [
        ('@"a"', '"@\\"a\\""'),
        ("\\", '"\\\\"'),
        ("a\tb", '"a\\tb"'),
        ("a\r\nb", '"a\\r\\nb"'),
        ("\0", '"\\0"'),
        ("\x01", '"\\x01"'),
        ("\x7f", '"\\x7F"'),
        ("\xad", '"\\xAD"'),
        ("\u0600", '"\\u0600"'),
        ("\uffff", '"\\uFFFF"'),
        ("\U000110bd", '"\\U000110BD"'),
        ("\U000e0001", '"\\U000E0001"'),
        ('"é\x01', '"\\"é\\x01"'),
    ],
)
def test_characters_that_cannot_be_seen_are_escaped(value, spelling):
    assert scalars.flow(text(value)) == spelling


@pytest.mark.parametrize(
    ("spelling", "expected"),
    [
        ("0xab", "0xAB"),
        ("0x1F", "0x1F"),
        ("~", "null"),
        ("", "null"),
        ("null", "null"),
        ("1.50", "1.50"),
        ("-7", "-7"),
        ("true", "true"),
    ],
)
def test_numbers_and_words_keep_their_spelling(spelling, expected):
    scalar = number(spelling)
    assert scalars.flow(scalar) == scalars.key(scalar, False) == expected
    assert scalars.block(scalar, 0, 2) == [expected]


def words(length: int) -> str:
    """Return a text of this length that consists of short words."""
    result = "word " * (length // 5 + 1)
    return result[: length - 1].replace("  ", " ") + "x"


@pytest.mark.parametrize("column", [0, 7, 40])
def test_a_text_that_ends_in_the_last_column_is_not_folded(column):
    assert_limits(
        lambda length: len(scalars.block(text(words(length)), column, 2)) == 1,
        most=WIDTH - column,
    )


def test_a_quoted_text_that_ends_in_the_last_column_is_not_folded():
    """A quoted text has two more columns."""
    (line,) = scalars.block(text("@ " + words(WIDTH - 4)), 0, 2)
    assert len(line) == WIDTH
    lines = scalars.block(text("@ " + words(WIDTH - 2)), 0, 2)
    assert len(lines) == 2 and max(map(len, lines)) <= WIDTH


def filled(parts: list[str], first: int, width: int) -> list[str]:
    """Break a list of words by trying each number of words for a line."""
    lines = []
    while parts:
        room = width if lines else first
        taken = max(
            (n for n in range(1, len(parts) + 1) if len(" ".join(parts[:n])) <= room),
            default=1,
        )
        lines.append(" ".join(parts[:taken]))
        parts = parts[taken:]
    return lines


WORDS = st.lists(st.integers(1, 50).map("w".__mul__), min_size=20, max_size=40)


@settings(max_examples=60, deadline=None)
@given(WORDS, st.integers(0, 60), st.sampled_from([2, 4, 8]))
def test_folded_lines_are_as_long_as_the_width_permits(parts, column, indent):
    lines = scalars.block(text(" ".join(parts)), column, indent)
    first, *rest = filled(parts, WIDTH - column, WIDTH - indent)
    assert lines == [first, *(" " * indent + line for line in rest)]


@settings(max_examples=60, deadline=None)
@given(WORDS, st.integers(0, 60), st.sampled_from([2, 4, 8]))
def test_folded_lines_of_a_quoted_text_have_room_for_the_first_quote(
    parts, column, indent
):
    parts = ["@", *parts, *["word"] * 30]
    lines = scalars.block(text(" ".join(parts)), column, indent)
    first, *rest = filled(parts, WIDTH - column - 1, WIDTH - indent)
    expected = [f'"{first}', *(" " * indent + line for line in rest)]
    expected[-1] += '"'
    assert lines == expected


def test_a_text_breaks_only_at_single_spaces():
    """A reader of YAML joins lines by one space."""
    value = "a" * 118 + "  b c"
    assert scalars.block(text(value), 0, 2) == ["a" * 118 + "  b", "  c"]


@pytest.mark.parametrize(
    ("value", "lines"),
    [
        ("a\nb", ["|-", "  a", "  b"]),
        ("a\nb\n", ["|", "  a", "  b"]),
        ("a\n\n  b\n", ["|", "  a", "", "    b"]),
        ("a\n", ["|", "  a"]),
        ("a\n\n", ['"a\\n\\n"']),
        (" a\nb", ['" a\\nb"']),
        ("\na", ['"\\na"']),
        ("a \nb", ['"a \\nb"']),
        ("a\n\tb", ['"a\\n\\tb"']),
    ],
)
def test_texts_of_several_lines_are_block_scalars_if_these_can_represent_them(
    value, lines
):
    assert scalars.block(text(value), 0, 2) == lines


@pytest.mark.parametrize("indent", [2, 6])
def test_a_long_line_with_a_break_at_its_end_is_folded(indent):
    assert_limits(
        lambda length: scalars.block(text(words(length) + "\n"), 20, indent)[0] == "|",
        most=WIDTH - indent,
    )
    lines = scalars.block(text(words(200) + "\n"), 20, indent)
    expected = filled(words(200).split(" "), WIDTH - indent, WIDTH - indent)
    assert lines == [">", *(" " * indent + line for line in expected)]
