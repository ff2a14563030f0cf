"""A page with two columns of text is read column by column."""

from __future__ import annotations

from icdgen.importer.pages.extract import PageContents, Word
from icdgen.importer.pages.gutter import columns_of_text
from icdgen.importer.pages.lines import lines, runs
from icdgen.importer.pages.rules import Region
from tests.limits import assert_limits

WIDTH = 1000.0  # so that the middle of the page is from 400 to 600


def words(x0, x1, row, count):
    step = (x1 - x0) / count
    return [
        Word(f"w{row}", x0 + n * step, 20.0 * row, x0 + n * step + step - 2 if n < count - 1 else x1,
             20.0 * row + 10, 10.0, "plain")
        for n in range(count)
    ]  # fmt: skip


def columns(rows=8, count=7, left=(50, 490), right=(510, 950), short=(), regions=()):
    """Return the number of words of each column that the page is divided into."""
    page_words = []
    for row in range(rows):
        end = left[1] - (short[row] if row < len(short) else 0)
        page_words += words(left[0], end, row, count)
        page_words += words(*right, row, 7)
    page = PageContents(1, WIDTH, 1400.0)
    parts = columns_of_text(page, list(regions), lines(page_words))
    return [
        (len(found), sum(len(line.words) for line in inside)) for found, inside in parts
    ]


TWO, ONE = [(0, 56), (0, 56)], [(0, 112)]


def test_text_left_and_right_of_a_gap_is_two_columns():
    assert columns() == TWO
    page = PageContents(1, WIDTH, 1400.0)
    assert columns_of_text(page, [], []) == [([], [])]


def test_a_gap_has_at_least_6_points():
    assert_limits(lambda gap: len(columns(left=(50, 510 - gap))) == 2, least=6)


def test_a_gap_is_within_the_middle_of_the_page():
    assert columns(left=(50, 300), right=(390, 950)) == ONE
    # Only the part of a gap from 40 to 60 percent of the width counts.
    assert_limits(
        lambda end: len(columns(left=(50, 300), right=(end, 950))) == 2, least=406
    )
    assert_limits(
        lambda start: len(columns(left=(50, start), right=(599, 950))) == 2, most=593
    )


def test_the_left_column_comes_first():
    assert columns(count=8) == [(0, 64), (0, 56)]
    regions = [Region(520, 0, 900, 9), Region(50, 0, 480, 9), Region(50, 9, 480, 20)]
    assert columns(regions=regions) == [(2, 56), (1, 56)]
    assert_limits(
        lambda start: len(columns(left=(50, 500), right=(start, 950))) == 2, most=599
    )


def test_cells_with_wide_gaps_are_no_column_of_text():
    def is_text(gap):
        page_words = []
        for row in range(8):
            page_words += words(50, 250, row, 4) + words(250 + gap, 490, row, 4)
            page_words += words(510, 950, row, 7)
        page = PageContents(1, WIDTH, 1400.0)
        return len(columns_of_text(page, [], lines(page_words))) == 2

    assert_limits(is_text, most=9)


def test_a_column_has_8_full_lines_of_7_words():
    assert_limits(lambda rows: len(columns(rows=rows)) == 2, least=8)
    assert_limits(lambda count: len(columns(count=count)) == 2, least=7)
    # The last lines of paragraphs are shorter than 80 percent of the column.
    assert len(columns(rows=9, short=[87])) == 2
    assert columns(short=[87]) == TWO
    assert columns(short=[89]) == ONE


def test_regions_belong_to_a_column_and_fill_the_gap():
    left, right = Region(50, 0, 480, 9), Region(520, 0, 900, 9)
    assert columns(regions=[left, right]) == [(1, 56), (1, 56)]
    across = Region(50, 0, 900, 9)
    assert columns(regions=[across]) == [(1, 112)]


def test_runs_of_words_are_separated_by_a_gap_above_the_limit():
    def two_runs(gap):
        first = Word("a", 0.0, 0.0, 10.0, 10.0, 10.0, "plain")
        second = first._replace(x0=10.0 + gap, x1=30.0, size=8.0)
        (line,) = lines([first, second])
        return [len(run) for run in runs(line, 0.5)] == [1, 1]

    assert_limits(lambda gap: not two_runs(gap), most=5)
