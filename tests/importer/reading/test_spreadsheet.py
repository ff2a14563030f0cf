"""Rows of CSV files and sheets become tables and the texts above them."""

from __future__ import annotations

import openpyxl
import pytest

from icdgen.diagnostics import Findings
from icdgen.importer.document import Document, Heading, SourceTable, TextBlock
from icdgen.importer.reading import spreadsheet
from icdgen.importer.reading.spreadsheet import read_csv, read_xlsx


def shown(document: Document) -> list:
    """Return rows of tables as (line, texts), and other blocks."""
    return [
        [(row.line, [cell.text for cell in row.cells]) for row in block.rows]
        if isinstance(block, SourceTable)
        else block
        for block in document.blocks
    ]


@pytest.fixture
def csv_blocks(tmp_path):
    def read(text: str) -> list:
        path = tmp_path / "a.csv"
        path.write_bytes(text.encode())
        return shown(read_csv(path))

    return read


@pytest.fixture
def xlsx(tmp_path):
    """Return a function that reads a sheet of rows, with areas of merged cells."""

    def read(*rows: list, merged: tuple[str, ...] = ()) -> Document:
        book = openpyxl.Workbook()
        for row in rows:
            book.active.append(row)
        for area in merged:
            book.active.merge_cells(area)
        book.save(tmp_path / "a.xlsx")
        return read_xlsx(tmp_path / "a.xlsx")

    return read


@pytest.mark.parametrize("mark", [",", ";", "\t", "|"])
def test_cells_are_separated_by_the_mark_of_most_lines(csv_blocks, mark):
    other = ";" if mark == "," else ","
    text = f"A{mark}B\n0{mark}{other * 9}\n1{mark}\n"
    assert csv_blocks(text) == [
        [(1, ["A", "B"]), (2, ["0", other * 9]), (3, ["1", ""])]
    ]


def test_of_marks_in_as_many_lines_the_more_frequent_one_counts(csv_blocks):
    assert csv_blocks("A;B,C;D\n0;1,2;3\n")[0][1] == (2, ["0", "1,2", "3"])
    assert csv_blocks("A;B,C\n0;1,2\n")[0][1] == (2, ["0;1", "2"])


def test_only_the_first_ten_thousand_characters_decide_about_lines(csv_blocks):
    first = f"A;{'x' * 9995}\n"
    (table,) = csv_blocks(f"{first}0,1;2\n3,4;5\n")
    assert table[1] == (2, ["0,1", "2"])


def test_a_single_cell_above_a_table_is_a_text_and_within_it_a_row(csv_blocks):
    text = "Title,\n,Note\nA,B\nPart,\n0,x\n,\nNext\nC,D\n"
    assert csv_blocks(text) == [
        TextBlock("Title", line=1),
        TextBlock("Note", line=2),
        [(3, ["A", "B"]), (4, ["Part", ""]), (5, ["0", "x"])],
        TextBlock("Next", line=7),
        [(8, ["C", "D"])],
    ]


def test_empty_columns_at_the_right_are_left_out(csv_blocks):
    assert csv_blocks("A,,B,,\n0,,,,\n") == [[(1, ["A", "", "B"]), (2, ["0", "", ""])]]


@pytest.mark.parametrize(
    ("text", "line"),
    [('A,B\n0,"x"y\n1,z\n', 2), ('"A,B', 1), ('A,B\n0,x\n1,"y\n2,z\n', 3)],
)
def test_a_quote_that_does_not_fit_is_a_finding_at_its_line(tmp_path, text, line):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(Findings) as caught:
        read_csv(path)
    (finding,) = caught.value.findings
    assert (finding.code, finding.place.line) == ("IMP002", line)
    assert finding.message.startswith("this CSV cannot be parsed: ")


def test_a_row_below_a_merged_cell_does_not_end_its_table(xlsx):
    rows = (["A", "B"], ["0", "x"], [], ["1", "y"], [], ["End"])
    document = xlsx(*rows, merged=("A2:A3",))
    heading, table, text = document.blocks
    assert heading == Heading("", "Sheet")
    assert [(row.line, row.shown) for row in table.rows] == [
        (1, "A | B"),
        (2, "0 | x"),
        (3, ""),
        (4, "1 | y"),
    ]
    assert [(c.text, c.columns, c.rows) for c in table.rows[1].cells] == [
        ("0", 1, 2),
        ("x", 1, 1),
    ]
    assert text == TextBlock("End", line=6)
    # The empty rows at the end of a table are none of it.
    document = xlsx(["A", "B"], ["0", "x"], [], [], ["z"], merged=("B2:B4",))
    (table,) = document.tables
    assert [row.line for row in table.rows] == [1, 2, 3, 4, 5]
    document = xlsx(["A", "B"], ["0", "x"], merged=("B2:B4",))
    (table,) = document.tables
    assert [row.line for row in table.rows] == [1, 2]


def test_a_cell_over_columns_and_rows_covers_all_its_places(xlsx):
    document = xlsx(
        ["A", "B", "C"], ["x", None, "1"], [None, None, "2"], merged=("A2:B3",)
    )
    (table,) = document.tables
    cells = [[(c.text, c.columns, c.rows) for c in row.cells] for row in table.rows]
    assert cells[1:] == [[("x", 2, 2), ("1", 1, 1)], [("2", 1, 1)]]


def test_rows_and_columns_above_the_limits_are_not_read(xlsx, monkeypatch):
    monkeypatch.setattr(spreadsheet, "MOST_ROWS", 2)
    monkeypatch.setattr(spreadsheet, "MOST_COLUMNS", 3)
    document = xlsx(["A", "B", "C", "D"], ["0"], ["1"], merged=("B1:D1", "A2:A3"))
    (table,) = document.tables
    assert [[(c.text, c.columns, c.rows) for c in row.cells] for row in table.rows] == [
        [("A", 1, 1), ("B", 2, 1)],
        [("0", 1, 1), ("", 1, 1), ("", 1, 1)],
    ]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (3, "3"),
        (3.0, "3"),
        (0.1, "0.1"),
        (1e300, str(int(1e300))),
        (True, "TRUE"),
        (False, "FALSE"),
        (" a\r\nb ", "a\nb"),
        ("#1", "#1"),
        ("N/A", "N/A"),
        (None, ""),
    ],
)
def test_a_value_is_the_text_that_the_sheet_shows(xlsx, value, text):
    document = xlsx(["A", "B"], [value, "x"])
    assert shown(document)[1][1] == (2, [text, "x"])
    assert document.import_findings == []
