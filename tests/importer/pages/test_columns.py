"""Columns without vertical rules lie where headings and white space separate them."""

from __future__ import annotations

from bisect import bisect_right

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.importer import profile
from icdgen.importer.pages.columns import (
    Columns,
    boundaries,
    find_headings,
    index_of,
    side_by_side,
)
from icdgen.importer.pages.draft import HeadingRow
from icdgen.importer.pages.lines import TextLine
from tests.importer.pages.words import line, word
from tests.limits import assert_limits

WORDS = profile.load()


@given(
    st.lists(st.integers(0, 50), min_size=2, max_size=6, unique=True).map(sorted),
    st.integers(-5, 55),
)
def test_a_place_is_in_the_column_between_the_nearest_edges(edges, x):
    column = bisect_right(edges, x) - 1
    assert index_of(x, edges) == min(max(column, 0), len(edges) - 2)


def edge(*words, headings=((0, 30), (130, 160))):
    """Return the edge between the columns of two headings, with words as (from, to),
    or as (from, to, number of lines).
    """
    lines = [
        TextLine([word("w", x0, x1, top=20.0 * row)])
        for x0, x1, *count in words
        for row in range(count[0] if count else 1)
    ]
    first, middle, last = boundaries(list(headings), lines, 0, 160)
    assert (first, last) == (-1, 161)
    return middle


def test_outer_edges_are_one_point_outside_of_all_words_and_headings():
    spans = [(10.0, 30.0), (60.0, 90.0)]
    assert boundaries(spans, [], 5, 95)[::2] == [4, 96]
    assert boundaries(spans, [], 15, 85)[::2] == [9, 91]
    wide = TextLine([word("w", 2, 20), word("w", 70, 99)])
    assert boundaries(spans, [wide], 5, 95)[::2] == [1, 100]


def test_an_edge_without_words_is_in_the_middle_between_the_centres():
    assert edge() == 80
    assert boundaries([(0, 20)], [], 0, 20) == [-1, 21]


def test_an_edge_crosses_as_few_words_as_possible():
    # One word crosses from 20 to 50, two cross from 50 to 60.
    assert edge((0, 60), (0, 20), (50, 145), (60, 145)) == 35
    assert edge((0, 60), (0, 60), (20, 145), (60, 145)) == 102.5


def test_an_edge_ends_at_the_heading_on_its_right():
    words = ((0, 20), (50, 90), (100, 110))
    assert edge(*words, headings=((0, 30), (100, 160))) == 95
    assert edge(*words, headings=((0, 30), (101.4, 160))) == 95
    assert edge(*words, headings=((0, 30), (101.5, 160))) == 35


def test_an_edge_has_words_of_both_columns_beside_it():
    assert edge((0, 20), (60, 62)) == 40
    assert edge((60, 70), (80, 90)) == 75


def test_words_of_the_column_behind_the_next_one_are_not_beside_an_edge():
    spans = [(0.0, 30.0), (130.0, 160.0), (260.0, 290.0)]

    def first_edge(x1: float) -> float:
        row = [word("a", 0, 20), word("b", 60, 62), word("c", 260, x1)]
        return boundaries(spans, [TextLine(row)], 0, 300)[1]

    # The third heading has its centre at 275.
    assert first_edge(289.8) == 103.5
    assert first_edge(290.2) == 40


@pytest.mark.parametrize(("end", "middle"), [(24.9, 70.0), (25.0, 22.5)])
def test_an_edge_is_in_no_gap_of_less_than_half_the_type_size(end, middle):
    # Three words begin at the end of the gap, so that it is a column otherwise.
    assert edge((0, 20), (end, 60, 3), (80, 145)) == middle


@pytest.mark.parametrize(("count", "middle"), [(2, 80.0), (3, 25.0)])
def test_three_words_with_one_left_side_begin_a_column(count, middle):
    assert edge((0, 20), (30, 60, count), (100, 145)) == middle


@pytest.mark.parametrize(("x0", "middle"), [(30.9, 25.0), (31.0, 80.0)])
def test_left_sides_of_a_column_differ_by_less_than_a_point(x0, middle):
    assert edge((0, 20), (30, 60, 2), (x0, 60), (100, 145)) == middle


def test_headings_in_one_line_have_roles_and_extents():
    row = line(("Byte", 0), ("Name", 60), ("Data", 120), ("Type", 145))
    below = line(("0", 0), ("Mode", 60), ("uint8", 120), top=15)
    titles = ["Byte", "Name", "Data Type"]
    header = HeadingRow("fields", ["at_bytes", "name", "type"], titles)
    spans = [(0, 20), (60, 80), (120, 165)]
    assert find_headings([row, below], WORDS) == Columns(header, spans, 1)
    assert find_headings([], WORDS) is None
    assert find_headings([below, row], WORDS) is None


def stacked(*texts, gap=2.0):
    """Return one line for each text, with words 60 points apart; `.` is no word."""
    return [
        line(
            *(
                (text, 60.0 * column)
                for column, text in enumerate(row.split())
                if text != "."
            ),
            top=(10 + gap) * number,
        )
        for number, row in enumerate(texts)
    ]


def test_lines_of_headings_are_at_most_120_percent_of_the_type_size_apart():
    def is_found(gap: int) -> bool:
        rows = stacked("Start Name Type", "Byte", gap=gap / 10)
        columns = find_headings(rows, WORDS)
        return columns is not None and columns.header.has_offsets

    columns = find_headings(stacked("Start Name Type", "Byte"), WORDS)
    assert columns is not None and columns.lines == 2
    assert columns.header.titles == ["Start Byte", "Name", "Type"]
    assert_limits(is_found, most=120)


def test_headings_have_at_most_four_lines():
    four = stacked("Value", "after", "Reset", ". Byte Name Type")
    columns = find_headings(four, WORDS)
    assert columns is not None and columns.lines == 4
    assert columns.header.roles == ["default", "at_bytes", "name", "type"]
    five = stacked("Value", "after", "Reset", ". Byte", ". . Name Type")
    assert find_headings(five, WORDS) is None


def test_headings_without_offsets_need_more_evidence():
    def is_found(text: str, loose: bool = True) -> bool:
        return find_headings(stacked(text), WORDS, loose) is not None

    assert is_found("Name Type Description")
    assert not is_found("Name Type Description", loose=False)
    assert not is_found("name Type Description")
    assert is_found("Name Type Description Colour")
    assert not is_found("Name Type Colour")
    assert not is_found("Name Type Description Colour Shape")


def test_a_known_heading_beside_another_word_is_a_sentence():
    sentence = line(("Mode", 0), ("of", 24.5), ("Value", 39))
    assert find_headings([sentence], WORDS) is None
    spaced = line(("Mode", 0), ("of", 24.6), ("Value", 39.2))
    columns = find_headings([spaced], WORDS)
    assert columns is not None
    assert columns.header.roles == ["name", "", "value"]


def test_lines_side_by_side_are_read_cell_by_cell():
    rows = stacked("Start Name", "Byte .")
    assert side_by_side(rows) == "Start Byte Name"
    assert side_by_side(rows[:1]) == "Start Name"


@pytest.mark.parametrize(("x1", "text"), [(3.0, "bb aa"), (3.1, "aa bb")])
def test_words_of_a_cell_overlap_by_more_than_30_percent(x1, text):
    upper = TextLine([word("aa", 0, 10)])
    lower = TextLine([word("bb", x1 - 10, x1, top=12)])
    assert side_by_side([upper, lower]) == text
