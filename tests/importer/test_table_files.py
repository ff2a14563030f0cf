"""Table files: their complete text, what is read from it, and wrong files."""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer.document import (
    Document,
    PageBox,
    SourceCell,
    SourceRow,
    SourceTable,
)
from icdgen.importer.table_files import (
    document_of,
    is_folder_of_tables,
    read_tables,
    text_of,
    write_tables,
)
from icdgen.importer.words import table_number
from tests.importer.rules.small import table

DOCUMENT = Document("C:\\pump.pdf", title='The "Pump"')
ROWS = [
    SourceRow([SourceCell("Byte"), SourceCell("Name", 2)], 4, 10),
    SourceRow([SourceCell('0 "a"\n', 1, 2), SourceCell("Größe", 2, 1)], 4, 11),
    SourceRow([SourceCell("x"), SourceCell("")], 5, 20),
    SourceRow([], 5, None),
    SourceRow([SourceCell("y")], 5, 21),
]
TABLE = SourceTable(
    12, ROWS, "Motor\nState", table_number("4-12"), ["4 Motor", "4.2 State"],
    ["above: this", "b"], ["end"], [PageBox(4, 1.5, 20, 300.25, 40)], "Sheet 1",
)  # fmt: skip
TEXT = r"""# Table 4-12: Motor State
# same headings as table 3, 15
table: 12
document: "C:\\pump.pdf"
title: "The \"Pump\""
sheet: "Sheet 1"
label: "4-12"
caption: "Motor\nState"
headings:
  - "4 Motor"
  - "4.2 State"
before:
  - "above: this"
  - "b"
after:
  - "end"
boxes:  # page, then left, top, right and bottom in points
  - [4, 1.5, 20, 300.25, 40]
rows:
  - {line: 10}
  - ["Byte", {text: "Name", columns: 2}]
  - [{text: "0 \"a\"\n", rows: 2}, {text: "Größe", columns: 2}]
  - {page: 5}
  - {line: 20}
  - ["x", ""]
  - []
  - {line: 21}
  - ["y"]
"""


def test_the_text_of_a_table_is_complete_and_is_read_back(tmp_path):
    assert text_of(TABLE, DOCUMENT, [3, 12, 15]) == TEXT
    (tmp_path / "012.table.yaml").write_text(TEXT, encoding="utf-8")
    (read,) = read_tables(tmp_path)
    # A row without a line of its own follows the row above it.
    expected = [row.line for row in ROWS[:3]] + [21, 21]
    assert [row.line for row in read.rows] == expected
    for row, own in zip(read.rows, ROWS, strict=True):
        row.line = own.line
    assert read == TABLE
    assert document_of(tmp_path) == DOCUMENT


def test_a_bare_table_has_number_document_and_rows_only(tmp_path):
    bare = SourceTable(1, [SourceRow([SourceCell("a")])])
    text = text_of(bare, Document("pump.txt"), [1])
    assert text == '#\ntable: 1\ndocument: "pump.txt"\nrows:\n  - ["a"]\n'
    (tmp_path / "1.table.yaml").write_text(text, encoding="utf-8")
    assert read_tables(tmp_path) == [bare]
    (tmp_path / "0.table.yaml").write_text("table: 0\nrows: []\n", encoding="utf-8")
    assert document_of(tmp_path) == Document(tmp_path.name)


def test_at_most_eight_tables_with_the_same_headings_are_named():
    def line(count: int) -> str:
        return text_of(table("a|b"), DOCUMENT, list(range(8, 8 + count))).splitlines()[
            1
        ]

    numbers = ", ".join(map(str, range(8, 16)))
    assert line(8) == f"# same headings as table {numbers}"
    assert line(9) == f"# same headings as table {numbers} ..."


def test_files_are_numbered_with_three_digits_or_as_many_as_needed(tmp_path):
    folder = tmp_path / "new" / "tables"
    folder.mkdir(parents=True)
    for name in ("007.table.yaml", "0001.table.yaml", "notes.yaml"):
        (folder / name).write_text("mine", encoding="utf-8")
    tables = [SourceTable(n, table(rows).rows) for n, rows in ((2, "a|b"), (10, "A|B"))]
    paths = write_tables(tables, folder, DOCUMENT)
    assert [path.name for path in paths] == ["002.table.yaml", "010.table.yaml"]
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["002.table.yaml", "010.table.yaml", "notes.yaml"]
    assert "# same headings as table 10\n" in paths[0].read_text(encoding="utf-8")
    assert [read.number for read in read_tables(folder)] == [2, 10]
    assert is_folder_of_tables(folder)
    assert not is_folder_of_tables(tmp_path)
    assert not is_folder_of_tables(paths[0])


def test_all_wrong_files_are_reported_with_their_lines(tmp_path):
    texts = {
        "1": "table: 1\nrows: [\n",
        "2": "table: 2\nrows: []\ncolour: red\n",
        "3": 'table: 3\nrows:\n  - {page: 4}\n  - [a, {text: "b", rows: 3}]\n  - [c]\n',
        "4": "table: 4\nrows: []\n",
        "5": "rows: []\ntable: 4\n",
    }
    for name, text in texts.items():
        (tmp_path / f"{name}.table.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(Findings) as caught:
        read_tables(tmp_path)
    findings = caught.value.findings
    places = [(f.place.file.split("/")[-1][0], f.place.line) for f in findings]
    assert places[-3:] == [("2", 3), ("3", 4), ("5", 2)]
    assert {f.code for f in findings} == {"IMP006"} and places[0][0] == "1"
    assert findings[-2].message == (
        "the cell `b` lies below another cell, or spans more rows than there are"
    )
    assert (
        findings[-2].help
        == "correct `rows:` and `columns:` of the cells here and below"
    )
    assert findings[-1].message == "two files have the number 4"
    assert findings[-1].help == "give each table a number of its own"
