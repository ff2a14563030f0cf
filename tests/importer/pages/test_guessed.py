"""Aligned lines of several cells become tables; other lines stay text."""

from __future__ import annotations

import pytest

from icdgen.importer.document import PageBox
from icdgen.importer.pages.draft import TableDraft
from icdgen.importer.pages.flow import TextItem
from icdgen.importer.pages.guessed import with_guessed_tables


def text(row, *cells, kind="text", page=1, top=None):
    """Return a line of size 10 with cells given as (x, text), 20 points a row."""
    top = 20.0 * row if top is None else top
    box = PageBox(page, cells[0][0], top, cells[-1][0] + 30, top + 10)
    joined = " ".join(cell for _, cell in cells)
    return TextItem(kind, joined, box, 10.0, cells=list(cells))


def row(number, *texts, at=(0.0, 100.0, 200.0), **more):
    return text(number, *zip(at, texts, strict=True), **more)


HEAD = row(0, "Byte", "Name", "Type")
ROWS = [row(1, "0", "Mode", "uint8"), row(2, "1", "Load", "uint8")]


def shown(items):
    """Return the items: texts of lines, and the rows of tables."""
    return [
        item.text if isinstance(item, TextItem) else [row.texts for row in item.head]
        for item in with_guessed_tables(items)
    ]


TABLE = [["Byte", "Name", "Type"], ["0", "Mode", "uint8"], ["1", "Load", "uint8"]]


def test_three_aligned_lines_of_three_cells_are_a_table():
    assert shown([HEAD, *ROWS]) == [TABLE]
    assert shown([HEAD, ROWS[0]]) == ["Byte Name Type", "0 Mode uint8"]
    two = [text(n, (0.0, "a"), (100.0, "b")) for n in range(4)]
    assert shown(two) == ["a b"] * 4
    (table,) = with_guessed_tables([HEAD, *ROWS])
    assert table.boxes == [PageBox(1, 0.0, 0.0, 230.0, 50.0)]
    assert [printed.page for printed in table.head] == [1, 1, 1]


def test_text_around_a_table_keeps_its_place():
    before, after = text(-1, (7.0, "before")), text(3, (7.0, "after"))
    draft = TableDraft([HEAD.box])
    assert shown([before, HEAD, *ROWS, after]) == ["before", TABLE, "after"]
    assert shown([draft, HEAD, *ROWS]) == [[], TABLE]
    assert shown([HEAD, draft, *ROWS]) == [
        "Byte Name Type",
        [],
        "0 Mode uint8",
        "1 Load uint8",
    ]


def test_the_first_line_of_a_table_does_not_begin_with_a_number():
    third = row(3, "2", "Rate", "uint8")
    assert shown([*ROWS, third]) == ["0 Mode uint8", "1 Load uint8", "2 Rate uint8"]


@pytest.mark.parametrize(("x", "is_aligned"), [(103.9, True), (104.0, False)])
def test_cells_are_aligned_within_4_points(x, is_aligned):
    last = text(2, (50.0, "1"), (x, "Load"), (201.0, "uint8"))
    assert (len(shown([HEAD, ROWS[0], last])) == 1) == is_aligned


@pytest.mark.parametrize(("top", "is_near"), [(55.0, True), (55.1, False)])
def test_a_distance_of_more_than_two_and_a_half_lines_ends_a_table(top, is_near):
    last = row(2, "1", "Load", "uint8", top=top)
    assert (len(shown([HEAD, ROWS[0], last])) == 1) == is_near


def test_another_page_or_a_caption_ends_a_table():
    other_page = row(2, "1", "Load", "uint8", page=2)
    caption = row(2, "1", "Load", "uint8", kind="caption")
    for last in (other_page, caption):
        assert len(shown([HEAD, ROWS[0], last])) == 3
    heading = row(0, "Byte", "Name", "Type", kind="heading")
    third = row(3, "2", "Rate", "uint8")
    assert shown([heading, *ROWS, third])[0] == "Byte Name Type"


def test_a_single_cell_continues_a_column_except_the_first():
    more = text(2, (201.0, "or int8"))
    last = row(3, "1", "Load", "uint8")
    (table,) = shown([HEAD, ROWS[0], more, last])
    assert table[2] == ["", "", "or int8"]
    below = text(3, (1.0, "Text below"))
    assert shown([HEAD, *ROWS, below]) == [TABLE, "Text below"]
    # Two cells in one column are one text.
    split = text(2, (0.0, "1"), (90.0, "Load"), (110.0, "high"), (200.0, "x"))
    (table,) = shown([HEAD, ROWS[0], split])
    assert table[2] == ["1", "Load high", "x"]
