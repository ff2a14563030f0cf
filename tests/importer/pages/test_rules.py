"""Ruling lines: pieces are joined, and regions have rows, columns and open cells."""

from __future__ import annotations

import pytest

from icdgen.importer.pages.extract import PageContents, RulingLine, Word
from icdgen.importer.pages.rules import Region, distinct, joined, regions


def test_values_within_the_distance_count_as_one():
    assert distinct([5.0, 1.0, 2.8, 2.9]) == [1.0, 2.9, 5.0]
    assert distinct([0.0, 3.0, 3.1], 3.0) == [0.0, 3.1]
    assert distinct([]) == []


@pytest.mark.parametrize(
    ("rules", "result"),
    [
        ([(10, 0, 5), (10, 6.8, 9)], [(10, 0, 9)]),
        ([(10, 0, 5), (10, 6.9, 9)], [(10, 0, 5), (10, 6.9, 9)]),
        ([(1.8, 5, 9), (0, 0, 5)], [(0, 0, 9)]),
        ([(1.9, 5, 9), (0, 0, 5)], [(0, 0, 5), (1.9, 5, 9)]),
        ([(10, 0, 9), (10, 2, 5)], [(10, 0, 9)]),
        # A chain of close rules does not drift: the first one is the measure.
        ([(10, 0, 5), (11, 0, 5), (12, 0, 5)], [(10, 0, 5), (12, 0, 5)]),
    ],
)
def test_collinear_pieces_that_touch_are_one_rule(rules, result):
    lines = joined([RulingLine(*rule) for rule in rules])
    assert [tuple(line) for line in lines] == result


def page(across=(), down=()):
    return PageContents(
        1,
        600.0,
        800.0,
        across=[RulingLine(*rule) for rule in across],
        down=[RulingLine(*rule) for rule in down],
    )


def boxes(across, down):
    return [(r.x0, r.top, r.x1, r.bottom) for r in regions(page(across, down))]


GRID = (
    [(100, 50, 250), (120, 50, 250), (140, 50, 250)],
    [(50, 100, 140), (150, 100, 140), (250, 100, 140)],
)


def test_a_region_has_a_vertical_rule_inside():
    across, down = GRID
    assert boxes(across, down) == [(50, 100, 250, 140)]
    assert boxes(across, [down[0], down[2]]) == []
    assert boxes(across, [down[1]]) == [(50, 100, 250, 140)]
    assert boxes(across, []) == []


@pytest.mark.parametrize(("gap", "is_met"), [(4, True), (4.1, False)])
def test_rules_meet_with_gaps_of_up_to_4_points(gap, is_met):
    expected = [(50, 140, 250, 200)] if is_met else []
    assert boxes(GRID[0][2:], [(150, 140 + gap, 200)]) == expected


def region(across=(), down=()):
    return Region(
        0.0,
        0.0,
        100.0,
        60.0,
        [RulingLine(*rule) for rule in across],
        [RulingLine(*rule) for rule in down],
    )


def test_rows_end_at_rules_over_40_percent_of_the_width():
    cuts = region([(20, 0, 40), (40, 0, 39.9), (50, 0, 20), (50, 60, 80)]).cuts()
    assert cuts == [0.0, 20, 50, 60.0]


def test_rows_end_where_an_inner_vertical_rule_ends():
    assert region(down=[(50, 15, 45)]).cuts() == [0.0, 15, 45, 60.0]
    for side in (0, 3, 97, 100):
        assert region(down=[(side, 15, 45)]).cuts() == [0.0, 60.0]
    assert region(down=[(50, -9, 70)]).cuts() == [0.0, 60.0]


def test_columns_end_at_rules_over_70_percent_of_the_height():
    table = region(down=[(30, 20, 34), (50, 20, 33.9), (70, 0, 60)])
    assert table.separators(20, 40) == [0.0, 30, 70, 100.0]


def test_a_cell_without_a_rule_above_continues_if_others_have_one():
    edges = [0.0, 50.0, 100.0]
    table = region([(20, 0, 50), (40, 0, 50), (40, 50, 65)])
    assert table.open_above(20, edges) == (False, True)
    assert table.open_above(21.75, edges) == (False, True)
    assert table.open_above(21.9, edges) == (False, False)  # no rule at this height
    assert table.open_above(40, edges) == (False, False)  # 30 % have one
    # The first row of a region continues nothing.
    assert region([(0, 0, 50)]).open_above(1.8, edges) == (False, False)


@pytest.mark.parametrize(
    ("x", "y", "is_inside"),
    [(-1, 30, True), (-1.1, 30, False), (101, 30, True), (101.1, 30, False),
     (50, -1, True), (50, -1.1, False), (50, 61, True), (50, 61.1, False)],
)  # fmt: skip
def test_a_word_is_in_a_region_with_a_tolerance_of_a_point(x, y, is_inside):
    word = Word("a", x - 2, y - 2, x + 2, y + 2, 4.0, "plain")
    assert region().holds(word) == is_inside
