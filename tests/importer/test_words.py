"""Normalised texts, integers, numbers of tables, and lines of a wrapped cell."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.importer.words import (
    CONTINUED,
    depends_on_count,
    folded,
    join,
    plain,
    printed_integer,
    squeezed,
    table_name,
    table_number,
    tidy_unit,
    without_blanks_in_counts,
)
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("  a \n\t b ", "a b"),
        ("ﬁeld ﬂow oﬀset eﬃcient baﬄe ﬅ ﬆ", "field flow offset efficient baffle st st"),
        ("a\u00a0b\u2007c\u202fd\u2009e", "a b c d e"), ("a\u200bb\ufeffc", "abc"),
        ("a\u2010b\u2011c\u2212d", "a-b-c-d"),
        # Dashes and superscripts have meanings of their own.
        ("a–b—c m²", "a–b—c m²"),
    ],
)  # fmt: skip
def test_a_plain_text_has_ordinary_letters_blanks_and_hyphens(text, result):
    assert plain(text) == result


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("[ V ]", "V"), ("A.m ²", "A.m²"), ("m s ⁻¹", "m s⁻¹"), ("kg m", "kg m"),
        (" [°C] ", "°C"),
    ],
)  # fmt: skip
def test_a_unit_has_no_brackets_and_no_blank_before_a_raised_figure(text, unit):
    assert tidy_unit(text) == unit


def test_folded_words_have_no_case_and_punctuation():
    assert folded("Length (BYTES) – 50% of_it") == (
        "length",
        "bytes",
        "50%",
        "of",
        "it",
    )
    assert folded(" -() ") == ()
    assert squeezed("Data-Type (1)") == squeezed("data type1") == "datatype1"


@pytest.mark.parametrize(
    ("text", "is_count"),
    [
        ("8 + 6*N", True), ("8+6N", False), ("N + 1", True), ("(N - 1)", True),
        ("2*n+1", True), ("4 × M - 2", True), ("3 · k", True), ("8 + N", True),
        ("N", False), ("6N", False), ("8", False), ("N + x", False), ("a.8 + N", False),
        ("8 + No", False), ("x + 6*N", False),
    ],
)  # fmt: skip
def test_a_number_that_depends_on_a_count_is_recognized(text, is_count):
    assert depends_on_count(text) == is_count


def test_only_numbers_that_depend_on_a_count_lose_their_blanks():
    text = "Length 8 + 6 * N bytes, N + 1 words, 8 + 1 and a - 2"
    shown = "Length 8+6*N bytes, N+1 words, 8 + 1 and a - 2"
    assert without_blanks_in_counts(text) == shown


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("12", 12), (" 0x1F ", 31), ("0XfF", 255), ("-7", -7), ("\u22127", -7),
        ("+7", 7), ("-0x10", -16), ("12²", 12), ("12*", 12), ("12 †", 12), ("12¹²", 12),
        ("0", 0), ("", None), ("1.5", None), ("1 2", None), ("0x", None), ("0xG", None),
        ("12h", None), ("--1", None),
    ],
)  # fmt: skip
def test_an_integer_is_decimal_or_hexadecimal_with_a_footnote_mark(text, number):
    assert printed_integer(text) == number


def test_an_integer_has_at_most_24_characters():
    assert_limits(lambda n: printed_integer("1" * n) is not None, least=1, most=24)


NUMBERS = st.lists(st.integers(0, 999_999), min_size=1, max_size=4)


@given(NUMBERS.filter(lambda n: n[0] or len(n) == 1), NUMBERS)
def test_names_of_tables_are_read_back_and_their_order_is_that_of_the_numbers(a, b):
    printed = "-".join(map(str, a))
    assert table_name(table_number(printed)) == printed
    assert table_number(printed.replace("-", ".")) == table_number(printed)
    if len(a) == len(b):
        other = table_number(".".join(map(str, b)))
        assert (table_number(printed) < other) == (a < b)


def test_numbers_of_tables_have_six_digits_and_a_missing_one_is_a_question_mark():
    assert table_number("12345678") == 123_456
    assert (table_name(None), table_name(0), table_name(4_000_012)) == (
        "?",
        "0",
        "4-12",
    )


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("State (continued)", "State"), ("State - Cont.", "State"),
        ("State [cont'd]", "State"), ("State, CONTD", "State"),
        ("State contd.", "State"),
        ("State continued fraction", "State continued fraction"),
        ("State cont", "State cont"),
    ],
)  # fmt: skip
def test_the_mark_of_a_continued_table_is_at_the_end_of_its_caption(text, left):
    assert CONTINUED.sub("", text) == left


WORDS = frozenset({"information", "temperature", "yaw-only", "degree", "read-only"})


@pytest.mark.parametrize(
    ("lines", "full", "text"),
    [
        ([], None, ""), (["", " a ", "", "b"], None, "a b"),
        # A soft hyphen always joins, and is never left.
        (["tem\u00ad", "pera\u00adture"], None, "temperature"),
        # The document decides whether a hyphen belongs to the word.
        (["infor-", "mation is"], None, "information is"),
        (["of infor-", "mation."], None, "of information."),
        (["yaw-", "only"], None, "yaw-only"), (["un-", "known"], None, "un-known"),
        (["infor-", "Mation"], None, "infor-Mation"),
        # A single hyphen is a dash.
        (["Frame -", "table"], None, "Frame - table"),
        (["-", "table"], None, "- table"), (["PIN-", "7"], None, "PIN-7"),
        (["read/", "write"], None, "read/write"),
        (["READ_", "WRITE"], None, "READ_WRITE"), (["a /", "b"], None, "a / b"),
        (["raw*", "10"], None, "raw*10"), (["raw *", "10"], None, "raw *10"),
        (["raw*", "x"], None, "raw* x"), (["raw", "10"], None, "raw 10"),
        # A word that fills its line continues in the next one if that makes a word.
        (["deg", "ree of"], [True, False], "degree of"),
        (["deg", "ree of"], [False, True], "deg ree of"),
        (["deg", "rees"], [True, True], "deg rees"),
        (["a", "deg", "ree"], [False, True, False], "a degree"),
        (["a", "deg", "ree"], [True, False, True], "a deg ree"),
    ],
)  # fmt: skip
def test_lines_of_a_cell_are_joined_by_the_words_of_the_document(lines, full, text):
    assert join(lines, WORDS, full) == text
