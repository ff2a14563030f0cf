"""Words of a page become lines; small raised figures become superscripts."""

from __future__ import annotations

import pytest

from icdgen.importer.document import PageBox
from icdgen.importer.pages.extract import Word
from icdgen.importer.pages.lines import (
    NARROW_GAP,
    WIDE_GAP,
    TextLine,
    box_around,
    lines,
    runs,
    text_of,
    words_of,
)

SIZE = 10.0


def word(text: str, x0: float, *, size: float = SIZE, bottom: float = 20.0) -> Word:
    return Word(text, x0, bottom - size, x0 + 5 * len(text), bottom, size, "plain")


@pytest.mark.parametrize(
    ("size", "bottom", "text"),
    [
        (6.0, 16.0, "10⁻³ m"),
        (8.0, 18.7, "10⁻³ m"),
        (8.0, 18.8, "10-3 m"),  # hardly raised
        (8.1, 16.0, "10-3 m"),  # nearly as large as the text
        (6.0, 20.0, "10-3 m"),  # on the line
        (6.0, 22.0, "10-3 m"),  # a subscript
    ],
)
def test_only_small_raised_figures_are_superscripts(size, bottom, text):
    raised = word("-3", 10, size=size, bottom=bottom)
    assert text_of([word("m", 24), raised, word("10", 0)]) == text


def test_a_raised_figure_after_a_blank_is_no_superscript():
    raised = word("2", 13, size=6.0, bottom=16.0)
    assert text_of([word("10", 0), raised]) == "10 2"


def test_a_raised_mark_belongs_to_the_line_of_its_word():
    raised = word("2", 5, size=6.0, bottom=16.0)
    words = [word("m", 0), word("s", 0, bottom=32.0), raised, word("kg", 20)]
    assert [line.text for line in lines(words)] == ["m² kg", "s"]


@pytest.mark.parametrize(("gap", "text"), [(1.1, "uint8"), (1.25, "uint 8")])
def test_words_that_touch_are_one_word(gap, text):
    assert text_of([word("8", 20 + gap), word("uint", 0)]) == text


def test_a_word_behind_a_superscript_is_measured_by_the_word_in_front_of_it():
    raised = word("2", 5, size=6.0, bottom=16.0)
    assert text_of([word("m", 0), raised, word("/s", 10.5)]) == "m²/s"
    # 8.0 is not raised from 10.0, so it is the measure of the next word.
    second = word("3", 10, size=8.0, bottom=18.0)
    assert text_of([word("10", 0), second, word("4", 15, size=6.4, bottom=16.0)]) == (
        "10³⁴"
    )


@pytest.mark.parametrize(("bottom", "count"), [(25.0, 2), (24.9, 1)])
def test_words_of_a_line_overlap_by_more_than_half_of_the_lower_word(bottom, count):
    result = lines([word("a", 0), word("b", 20, bottom=bottom)])
    assert len(result) == count
    small = word("b", 20, size=4.0, bottom=bottom - 3)
    assert len(lines([word("a", 0), small])) == count


def test_a_word_joins_the_line_with_which_it_overlaps_most():
    words = [word("a", 0), word("b", 0, bottom=25.5)]
    # It overlaps with 75 percent of its height with the first line.
    words.append(word("c", 20, size=6.0, bottom=21.5))
    assert [line.text for line in lines(words)] == ["a", "b c"]


def test_lines_are_from_top_to_bottom_with_words_from_left_to_right():
    words = [word("d", 9, bottom=40.0), word("b", 9), word("a", 0)]
    words.append(word("c", 0, bottom=40.0))
    assert [line.text for line in lines(words)] == ["a b", "c d"]
    assert [w.text for w in words_of(lines(words))] == ["a", "b", "c", "d"]


def test_a_line_has_the_extent_of_its_words_and_the_style_of_the_first():
    raised = word("22222", 5, size=6.0, bottom=8.0)._replace(style="raised")
    line = TextLine([raised, word("m", 0), word("n", 4)])
    extent = (line.x0, line.x1, line.top, line.bottom, line.size, line.style)
    assert extent == (0, 30, 2, 20, 10, "plain")
    assert line.middle == 11


@pytest.mark.parametrize("gap", [NARROW_GAP, WIDE_GAP, 0.6])
def test_runs_are_more_than_the_gap_apart_in_the_larger_type_size(gap):
    for sizes in ((10.0, 4.0), (4.0, 10.0)):
        for distance, count in ((10 * gap, 1), (10 * gap + 0.1, 2)):
            words = [word("a", 0, size=sizes[0])]
            words.append(word("b", 5 + distance, size=sizes[1]))
            result = runs(TextLine(words), gap)
            assert [w.text for run in result for w in run] == ["a", "b"]
            assert len(result) == count
    default = TextLine([word("a", 0), word("b", 11), word("c", 22.1)])
    assert [len(run) for run in runs(default)] == [2, 1]


def test_a_box_is_around_all_its_things():
    things = [TextLine([word("a", 3)]), PageBox(7, 1.0, 12.0, 4.0, 15.0)]
    assert box_around(2, things) == PageBox(2, 1.0, 10.0, 8.0, 20.0)
    assert box_around(2, things[1:]) == PageBox(2, 1.0, 12.0, 4.0, 15.0)


@pytest.mark.parametrize(("top", "count"), [(14.9, 1), (15.0, 2)])
def test_a_line_is_as_high_as_its_largest_word(top, count):
    raised = word("2", 5, size=6.0, bottom=15.0)
    large = word("L", 40, size=30.0, bottom=top + 30)
    assert len(lines([word("m", 0), raised, large])) == count
