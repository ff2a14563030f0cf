"""Tables of a document: the slots of spanning cells, headings, and places."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.document import (
    PageBox,
    SourceCell,
    SourceRow,
    SourceTable,
)
from tests.importer.rules.small import table


def slots(*rows: str) -> list[list[tuple[str, int, bool]]]:
    """Return text, first column and beginning of the cell in each slot of a table."""
    return [
        [(slot.cell.text, slot.column, slot.is_origin) for slot in row]
        for row in table(*rows).grid()
    ]


def test_a_cell_over_columns_and_rows_is_in_all_of_its_slots():
    assert slots("a|b>2v2|c", "d|e", "f|g|h|i") == [
        [("a", 0, True), ("b", 1, True), ("b", 1, False), ("c", 3, True)],
        [("d", 0, True), ("b", 1, True), ("b", 1, False), ("e", 3, True)],
        [("f", 0, True), ("g", 1, True), ("h", 2, True), ("i", 3, True)],
    ]


def test_cells_of_two_rows_above_leave_the_free_columns_to_a_row():
    assert slots("av3|b|c", "dv2|e", "f") == [
        [("a", 0, True), ("b", 1, True), ("c", 2, True)],
        [("a", 0, True), ("d", 1, True), ("e", 2, True)],
        [("a", 0, True), ("d", 1, True), ("f", 2, True)],
    ]


def test_columns_between_the_cells_of_a_row_are_empty_slots():
    assert slots("a|b|cv2", "d", "") == [
        [("a", 0, True), ("b", 1, True), ("c", 2, True)],
        [("d", 0, True), ("", 1, True), ("c", 2, True)],
        [("", 0, True)],
    ]
    assert SourceTable(rows=[SourceRow([])]).grid() == [[]]


def test_the_text_of_a_cell_is_in_its_first_column_and_in_all_of_its_rows():
    source = table("a>2v2|b", "c")
    assert [[slot.text for slot in row] for row in source.grid()] == [
        ["a", "", "b"],
        ["a", "", "c"],
    ]
    assert source.width == 3
    assert SourceTable().width == 0
    assert table("a", "b|c|d>3", "e").width == 5


@pytest.mark.parametrize(
    ("rows", "titles", "kind"),
    [
        ([], [], ()), (["State"], ["State"], ("state",)),
        (["State", "Byte|Data-Type", "0|uint"], ["Byte", "Data-Type"], ("byte", "datatype")),
        (["|State|", "Byte (1)| |Na\nme"], ["Byte (1)", "", "Na me"], ("byte1", "", "name")),
        (["a|b", "c|d"], ["a", "b"], ("a", "b")),
    ],
)  # fmt: skip
def test_the_first_row_with_two_filled_cells_gives_the_headings(rows, titles, kind):
    assert (table(*rows).titles, table(*rows).kind) == (titles, kind)


@pytest.mark.parametrize(
    ("keys", "title"),
    [
        ({}, "table 7"), ({"caption": "Motor  State"}, "table 7 (`Motor State`)"),
        ({"headings": ["4 Motor", "4.2 State"]}, "table 7 (`4.2 State`)"),
        ({"caption": "A", "headings": ["B"], "label": 12}, "table 7 (`A`)"),
        ({"caption": "x" * 61}, f"table 7 (`{'x' * 60}`)"),
    ],
)  # fmt: skip
def test_a_table_is_titled_by_its_caption_or_its_last_heading(keys, title):
    assert table("a", **keys).title == title


def test_a_table_is_at_its_first_box_or_at_its_first_row_with_a_place():
    rows = [SourceRow([]), SourceRow([], 4, 17), SourceRow([], 5, 18)]
    source = SourceTable(3, rows, label=12)
    assert (source.page, source.line) == (4, 17)
    assert source.spot == SourcePlace(4, 17, 12, 2)
    assert source.spot_of(rows[2]) == SourcePlace(5, 18, 12, 2)
    # A row without a place has the page of its table.
    assert source.spot_of(rows[0]) == SourcePlace(4, None, 12, 2)
    source.boxes = [PageBox(2, 0, 0, 1, 1), PageBox(9, 0, 0, 1, 1)]
    assert source.page == 2
    assert (SourceTable().page, SourceTable().line) == (None, None)


def test_a_row_is_shown_without_its_empty_cells():
    cells = [SourceCell(text) for text in ("0", " ", "a\nb", "")]
    assert SourceRow(cells).shown == "0 | a b"
