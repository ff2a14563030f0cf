"""Names in the boxes of a drawing never exceed their box."""

from __future__ import annotations

import pytest

from icdgen.backends.html.labels import BoxLabel, fit_name
from tests.limits import assert_limits


def texts(width, height, name="abcdefghij"):
    return [label.text for label in fit_name([(0, 0, width, height)], name, 7)]


def test_a_name_in_one_line_is_in_the_middle_of_its_box():
    assert fit_name([(10, 20, 101, 30)], "Speed", 7) == [
        BoxLabel(60, 39.7, 13, "Speed")
    ]


def test_lines_of_a_name_are_centered_with_equal_distances():
    assert fit_name([(0, 0, 50, 60)], "Mean Solar Time", 7) == [
        BoxLabel(25, 19.3, 13, "Mean"),
        BoxLabel(25, 34.7, 13, "Solar"),
        BoxLabel(25, 50.0, 13, "Time"),
    ]


def test_words_that_fit_share_a_line():
    # 11 characters of 13 units are 77.2 units wide; 8 units are margins.
    assert texts(86, 60, "Mean Solar Time") == ["Mean Solar", "Time"]
    assert texts(85, 60, "Twenty Four") == ["Twenty", "Four"]
    assert texts(86, 60, "Twenty Four") == ["Twenty Four"]


def test_a_name_that_is_too_wide_is_smaller_and_then_a_number():
    # 10 characters: 70.2 or 59.4 units, and 8 units of margins
    def size(width):
        return fit_name([(0, 0, width, 30)], "abcdefghij", 7)[0].size

    assert_limits(lambda width: size(width) == 13, least=79)
    assert_limits(lambda width: texts(width, 30) == ["abcdefghij"], least=68)
    assert texts(67, 30) == ["7"]


def test_a_box_has_as_many_lines_as_its_height_permits():
    # Two lines of 11 units are 25.96 units high; 6 units are margins.
    assert_limits(lambda height: texts(50, height, "Mean Solar") != ["7"], least=32)
    assert texts(60, 1, "Mean") == ["Mean"]  # one line is always permitted


def test_the_number_is_in_the_largest_box_the_upper_of_equal_ones():
    boxes = [(0, 50, 20, 21), (0, 90, 30, 22), (0, 10, 30, 22)]
    assert fit_name(boxes, "Temperature", 7) == [BoxLabel(15, 25.0, 11, "7", True)]


def test_each_box_that_is_large_enough_has_the_name():
    labels = fit_name([(0, 0, 90, 30), (0, 30, 10, 30), (0, 60, 90, 30)], "Speed", 7)
    assert [(label.text, label.y, label.key) for label in labels] == [
        ("Speed", 19.7, False),
        ("Speed", 79.7, False),
    ]


@pytest.mark.parametrize("name", ["", "Speed"])
def test_without_boxes_there_is_no_label(name):
    assert fit_name([], name, 7) == []
