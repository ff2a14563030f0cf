"""Running heads, feet and page numbers are removed; all other lines stay."""

from __future__ import annotations

import pytest

from icdgen.importer.pages.extract import PageContents, Word
from icdgen.importer.pages.furniture import without_heads_and_feet
from icdgen.importer.pages.lines import TextLine
from tests.limits import assert_limits

HEIGHT = 1000.0  # so that the margins end at 120 and begin at 880


def line(text, middle):
    words = [
        Word(word, 40.0 * at, middle - 5, 40.0 * at + 30, middle + 5, 10.0, "plain")
        for at, word in enumerate(text.split(), 1)
    ]
    return TextLine(words)


def remaining(*pages, kept=()):
    """Return the texts of pages, given as mappings of text to the middle of a line."""
    contents = [PageContents(n, 600.0, HEIGHT) for n, _ in enumerate(pages, 1)]
    lines = {
        number: [line(text, middle) for text, middle in page]
        for number, page in enumerate(pages, 1)
    }
    result = without_heads_and_feet(
        contents, lines, lambda line, near: line.text in kept
    )
    return [[line.text for line in result[page.number]] for page in contents]


def repeated(times, count, middle=50.0, text="Manual"):
    pages = [
        [(text if number < times else "x" * (number + 1), middle)]
        for number in range(count)
    ]
    return [page[0] for page in remaining(*pages) if page].count(text) == 0


def test_a_line_is_a_head_if_it_is_on_30_percent_of_the_pages_and_on_two():
    assert_limits(lambda times: repeated(times, 4), least=2)
    assert_limits(lambda times: repeated(times, 10), least=3)
    assert_limits(lambda times: repeated(times, 20), least=6)
    assert remaining([("Manual", 50.0)]) == [["Manual"]]


def test_heads_and_feet_are_in_the_margins_of_12_percent():
    assert_limits(lambda middle: repeated(4, 4, float(middle)), most=119)
    assert_limits(lambda middle: repeated(4, 4, float(middle)), least=881)


def test_heads_may_be_at_slightly_different_heights_and_contain_page_numbers():
    assert remaining([("Page 1 a", 50.0)], [("Page 2 a", 51.9)]) == [[], []]
    assert remaining([("Part 1 a", 51.9)], [("Part 12 a", 52.1)]) == [[], []]
    assert remaining([("Part 1 a", 50.9)], [("Part 12 a", 52.9)]) == [[], []]
    for far in (46.0, 56.0):
        pages = [("Part 1 a", 50.0)], [("Part 2 a", far)]
        assert remaining(*pages) == [["Part 1 a"], ["Part 2 a"]]
    assert remaining([("Rev1", 50.0)], [("Rev", 50.0)]) == [["Rev1"], ["Rev"]]
    # Equal lines of one page are not repeated.
    twice = [("Note", 50.0), ("Note", 50.0)]
    assert remaining(twice, [("Other", 60.0)]) == [["Note", "Note"], ["Other"]]


def test_lines_of_a_table_are_kept():
    pages = [[("Byte Name", 50.0), ("Manual", 60.0)]] * 3
    assert remaining(*pages, kept=["Byte Name"]) == [["Byte Name"]] * 3


def test_the_lines_directly_above_and_below_decide_with_the_line():
    seen = {}

    def keep(line, near):
        seen[line.text] = [other.text for other in near]
        return False

    texts = ["a", "b", "c", "d"]
    lines = [line(text, 20.0 + 10 * at) for at, text in enumerate(texts)]
    pages = [PageContents(n, 600.0, HEIGHT) for n in (1, 2)]
    without_heads_and_feet(pages, dict.fromkeys((1, 2), lines), keep)
    assert seen == {"a": ["b"], "b": ["a", "c"], "c": ["b", "d"], "d": ["c"]}


@pytest.mark.parametrize(
    "text", ["Page 7", "- 7 -", "7 / 20", "p. 7", "Seite 7 von 20", "7 of 9", "PAGE 7"]
)
def test_a_numbering_is_removed_without_a_comparison(text):
    assert remaining([(text, 950.0)]) == [[]]
    assert remaining([(text, 500.0)]) == [[text]]


@pytest.mark.parametrize("text", ["7 V", "Mode 7", "7 of", "page"])
def test_another_line_with_a_number_is_no_numbering(text):
    assert remaining([(text, 950.0)]) == [[text]]


def numbered(*figures):
    """Return the figures that stay on pages; each page has another height."""
    pages = [[(text, 885.0 + 10 * at)] for at, text in enumerate(figures)]
    return [page[0] for page in remaining(*pages) if page]


def test_a_bare_figure_is_a_page_number_if_half_of_the_pages_count_like_it():
    assert numbered("1", "2", "3", "4") == []
    assert numbered("11", "12", "99", "88") == ["99", "88"]
    assert numbered("11", "12", "99", "77", "66") == ["11", "12", "99", "77", "66"]
    assert numbered("5", "x") == ["5", "x"]
    # A single page has no others to compare with.
    assert numbered("1") == [] and numbered("2") == ["2"]
    # A figure of five digits is no page number.
    assert numbered("10000", "10001") == ["10000", "10001"]
    assert numbered("9998", "9999") == []
