"""Rows as printed become rows with cells that span columns and rows."""

from __future__ import annotations

from icdgen.importer.document import PageBox
from icdgen.importer.pages.draft import HeadingRow, PrintedRow, TableDraft

BOX = PageBox(4, 0.0, 0.0, 300.0, 100.0)
THREE = (0.0, 100.0, 200.0, 300.0)


def table(*rows, header=None, head=()):
    return TableDraft([BOX], header, head=list(head), rows=list(rows)).table()


def cells(*rows, **more):
    return [
        [(cell.text, cell.columns, cell.rows) for cell in row.cells]
        for row in table(*rows, **more).rows
    ]


def test_a_cell_spans_the_columns_between_its_edges():
    assert cells(
        PrintedRow(["a", "b", "c"], THREE),
        PrintedRow(["ab", "c"], (0.0, 200.0, 300.0)),
        PrintedRow(["abc"], (0.0, 300.0)),
    ) == [
        [("a", 1, 1), ("b", 1, 1), ("c", 1, 1)],
        [("ab", 2, 1), ("c", 1, 1)],
        [("abc", 3, 1)],
    ]


def test_edges_within_3_points_are_one_column():
    near = PrintedRow(["a", "b"], (0.0, 103.0, 300.0))
    far = PrintedRow(["a", "b"], (0.0, 103.1, 300.0))
    first = PrintedRow(["a", "b"], (0.0, 100.0, 300.0))
    assert cells(first, near)[1] == [("a", 1, 1), ("b", 1, 1)]
    assert cells(first, far)[1] == [("a", 2, 1), ("b", 1, 1)]
    # Both sides of a narrow cell are one edge: its text joins the cell before.
    narrow = PrintedRow(["a", "i", "b"], (0.0, 100.0, 102.0, 300.0))
    assert cells(narrow) == [[("a\ni", 1, 1), ("b", 1, 1)]]


def test_a_row_that_begins_further_right_has_empty_cells_before():
    last = PrintedRow(["c"], (200.0, 300.0))
    assert cells(PrintedRow(["a", "b", "c"], THREE), last)[1] == [
        ("", 1, 1),
        ("", 1, 1),
        ("c", 1, 1),
    ]


def test_a_row_on_a_facing_page_is_shifted_if_it_is_as_wide():
    first = PrintedRow(["a", "b", "c"], THREE)
    shifted = PrintedRow(["d", "e", "f"], tuple(x + 40 for x in THREE))
    assert cells(first, shifted)[1] == [("d", 1, 1), ("e", 1, 1), ("f", 1, 1)]
    wider = PrintedRow(["d", "e", "f"], (40.0, 140.0, 240.0, 348.0))
    assert len(cells(first, wider)[1]) == 3
    too_wide = PrintedRow(["d", "e", "f"], (40.0, 140.0, 240.0, 348.1))
    assert cells(first, too_wide)[1][0] == ("", 1, 1)


def test_a_cell_without_a_rule_above_continues_the_cell_above():
    rows = [
        PrintedRow(["a", "b", "c"], THREE),
        PrintedRow(["", "d", "e"], THREE, (True, False, True)),
        PrintedRow(["f", "g", "h"], THREE, (True, True, False)),
    ]
    assert cells(*rows) == [
        [("a\nf", 1, 3), ("b", 1, 1), ("c\ne", 1, 2)],
        [("d\ng", 1, 2)],
        [("h", 1, 1)],
    ]
    # A cell of another width does not continue, nor does one without a cell above.
    wide = PrintedRow(["ab", "c"], (0.0, 200.0, 300.0), (True, False))
    assert cells(rows[0], wide)[1] == [("ab", 2, 1), ("c", 1, 1)]
    assert cells(PrintedRow(["a"], (0.0, 300.0), (True,))) == [[("a", 1, 1)]]


def test_rows_without_edges_have_a_cell_for_each_text():
    assert cells(PrintedRow(["a", "b"])) == [[("a", 1, 1), ("b", 1, 1)]]
    title = PrintedRow(["Title"])
    assert cells(PrintedRow(["a", "b", "c"], THREE), head=[title])[0] == [
        ("Title", 3, 1)
    ]
    assert cells(PrintedRow(["a"], (0.0, 300.0)), head=[title])[0] == [("Title", 1, 1)]


def test_rows_above_the_headings_come_first_and_rows_have_their_page():
    header = HeadingRow("fields", ["at", ""], ["Byte", "Note"])
    rows = [PrintedRow(["0", "x"], page=5)]
    result = table(*rows, header=header, head=[PrintedRow(["Status"])])
    assert [(row.page, row.shown) for row in result.rows] == [
        (4, "Status"),
        (4, "Byte | Note"),
        (5, "0 | x"),
    ]
    header.printed = [PrintedRow(["Byte", ""]), PrintedRow(["[0]", "Note"])]
    result = table(*rows, header=header)
    assert [row.shown for row in result.rows] == ["Byte", "[0] | Note", "0 | x"]
    assert result.boxes == [BOX]


def test_a_heading_row_counts_cells_with_a_role():
    header = HeadingRow("fields", ["at", "", "name"], ["Byte No", "X y z", "Name"])
    assert (header.known, header.known_words, header.has_offsets) == (2, 3, True)
    assert HeadingRow("fields", ["at_bytes"], ["Byte"]).has_offsets
    assert not HeadingRow("fields", ["name"], ["Name"]).has_offsets


def test_a_slice_of_a_row_has_both_sides_of_its_cells():
    row = PrintedRow(["a", "b  b\nb", "c"], THREE, (True, False, True), 7)
    part = row.slice(1, 2)
    assert part == PrintedRow(["b  b\nb", "c"], THREE[1:], (False, True), 7)
    assert part.lines == ["b b b", "c"]
