"""Words of a page become lines; small raised figures become superscripts."""

from __future__ import annotations

import pytest

from icdgen.importer.pages.extract import Word
from icdgen.importer.pages.lines import lines, text_of

SIZE = 10.0


def word(text: str, x0: float, *, size: float = SIZE, bottom: float = 20.0) -> Word:
    return Word(text, x0, bottom - size, x0 + 5 * len(text), bottom, size, "plain")


@pytest.mark.parametrize(
    ("size", "bottom", "text"),
    [
        (6.0, 16.0, "10⁻³ m"),
        (8.0, 18.7, "10⁻³ m"),
        (8.0, 18.9, "10-3 m"),  # hardly raised
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
