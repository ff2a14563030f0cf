"""Spreadsheets, web pages, Markdown and Word documents give the same tables as a PDF,
for the same rules.
"""

from __future__ import annotations

import datetime
from pathlib import Path
from zipfile import ZipFile

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import profile, run, sources, table_files
from tests.importer.rules.test_rules import NODE, findings_of

openpyxl = pytest.importorskip("openpyxl", reason="pip install 'icdgen[import]'")
docx = pytest.importorskip("docx", reason="pip install 'icdgen[import]'")

TITLES = ["Message", "ID", "Dir", "Byte", "Type", "Resolution", "Unit", "Comment"]
ROWS = [  # the message cells are merged over the rows of a message
    ["Motor state", "0x21", "TM", "1", "uint8", "", "", "Mode"],
    [None, None, None, "2-3", "int16", "0.5", "rpm", "Speed\nof the motor"],
    ["Set speed", "0x22", "TC", "1-2", "uint16", "0.5", "rpm", "Speed"],
]
RULES = (
    NODE
    + r"""rules:
  - tables: {head: Message | ID | Dir}
    columns:
      Message: message
      ID: id
      Dir: kind
      Byte: '^{byte}(?:-{last_byte})?$'
      Type: type
      Resolution: scale
      Unit: unit
      Comment: ['^{name:\w+} of', name]
    map: {kind: {TM: telemetry, TC: telecommand}}
    origin: 1
"""
)


def xlsx(path: Path) -> None:
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "Messages"
    sheet.append(["Interface of the motor, issue 3"])
    sheet.append([])
    for row in (TITLES, *ROWS):
        sheet.append([int(cell) if cell and cell.isdigit() else cell for cell in row])
    for column in "ABC":
        sheet.merge_cells(f"{column}4:{column}5")
    hidden = book.create_sheet("Old")
    hidden.append(TITLES)
    hidden.sheet_state = "hidden"
    book.properties.title = "Manual of the motor"
    book.save(path)


def word(path: Path) -> None:
    document = docx.Document()
    document.add_heading("Messages", 1)
    table = document.add_table(1 + len(ROWS), len(TITLES))
    for index, row in enumerate((TITLES, *ROWS)):
        for column, text in enumerate(row):
            table.cell(index, column).text = text or ""
    for column in range(3):
        table.cell(1, column).merge(table.cell(2, column))
        table.cell(1, column).text = ROWS[0][column]
    document.save(str(path))


def html(path: Path) -> None:
    body = "".join(f"<th>{title}</th>" for title in TITLES)
    lines = [f"<tr>{body}</tr>"]
    for index, row in enumerate(ROWS):
        span = ' rowspan="2"' if index == 0 else ""
        cells = (
            f"<td{span if c < 3 else ''}>{(t or '').replace(chr(10), '<br>')}</td>"
            for c, t in enumerate(row)
            if t is not None
        )
        lines.append("<tr>" + "\n  ".join(cells) + "</tr>")
    path.write_text(
        f"<html><body><h1>Messages</h1><table>{''.join(lines)}</table></body></html>",
        encoding="utf-8",
    )


def separated(path: Path) -> None:
    lines = [";".join(TITLES)]
    for index, row in enumerate(ROWS):
        row = [
            text if text is not None else ROWS[index - 1][column]
            for column, text in enumerate(row)
        ]
        lines.append(";".join(f'"{text}"' if "\n" in text else text for text in row))
    path.write_text(
        "Interface of the motor\n\n" + "\n".join(lines) + "\n", encoding="utf-8"
    )


def markdown(path: Path) -> None:
    lines = [
        "# Messages",
        "",
        "| " + " | ".join(TITLES) + " |",
        "|---" * len(TITLES) + "|",
    ]
    for index, row in enumerate(ROWS):
        row = [
            text if text is not None else ROWS[index - 1][column]
            for column, text in enumerate(row)
        ]
        lines.append(
            "| " + " | ".join(text.replace("\n", "<br>") for text in row) + " |"
        )
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


WRITERS = {
    "motor.xlsx": xlsx,
    "motor.docx": word,
    "motor.html": html,
    "motor.csv": separated,
    "motor.md": markdown,
}


@pytest.mark.parametrize("name", WRITERS)
def test_one_rule_reads_a_table_of_every_source(tmp_path, name):
    WRITERS[name](tmp_path / name)
    (tmp_path / "rules.yaml").write_text(RULES, encoding="utf-8")
    result, trees = run.run(
        tmp_path / name, profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    assert [t.message for t in result.import_findings if t.severity == "error"] == []
    state, speed = trees["motor"]["messages"]
    assert (state["name"], state["id"], state["kind"], state["length"]) == (
        "Motor state",
        0x21,
        "telemetry",
        3,
    )
    assert [(f["at"], f["bits"], f["name"], f["type"]) for f in state["fields"]] == [
        (0, 8, "Mode", "uint"),
        (8, 16, "Speed", "int"),
    ]
    assert (state["fields"][1]["formula"], state["fields"][1]["unit"]) == (
        "raw*0.5",
        "rpm",
    )
    assert (speed["name"], speed["kind"], speed["length"]) == (
        "Set speed",
        "telecommand",
        2,
    )


@pytest.mark.parametrize("name", WRITERS)
def test_table_files_of_every_source_give_the_same(tmp_path, name):
    WRITERS[name](tmp_path / name)
    document, tables = sources.read(tmp_path / name, profile.load())
    assert [cell.text for cell in tables[0].rows[0].cells] == TITLES
    assert tables[0].rows[2].cells[-1].text == "Speed\nof the motor"
    table_files.write_tables(tables, tmp_path / "tables", document)
    assert table_files.read_tables(tmp_path / "tables") == tables


def test_each_value_that_a_spreadsheet_program_changed_is_an_error_at_its_cell(
    tmp_path,
):
    book = openpyxl.Workbook()
    for row in (
        ["Byte", "Name"],
        [datetime.date(2026, 1, 2), "Speed"],  # 1-2
        [datetime.time(1, 30), "Load"],  # 1:30
        [datetime.datetime(2026, 1, 2, 3, 4), "Mode"],
        ["=A1+1", "Sum"],
        ["#REF!", "#4"],
        ["#NAME?", 0.1],
        ["#N/A", 2.0],
        [True, False],
    ):
        book.active.append(row)
    book.save(tmp_path / "motor.xlsx")
    document, (table,) = sources.read(tmp_path / "motor.xlsx", profile.load())
    made, error = "the spreadsheet program made the date", "its formula gives the error"
    assert [
        (finding.code, finding.severity, finding.spot.line, finding.message)
        for finding in document.import_findings
    ] == [
        ("IMP023", "error", line, f"sheet `Sheet`, cell A{line}: {message}")
        for line, message in enumerate(
            (
                f"{made} 2026-01-02 00:00:00 of what was typed",
                f"{made} 01:30:00 of what was typed",
                f"{made} 2026-01-02 03:04:00 of what was typed",
                "the formula `=A1+1` has no stored value",
                f"{error} `#REF!`",
                f"{error} `#NAME?`",
                f"{error} `#N/A`",
            ),
            2,
        )
    ]
    assert "range such as 1-2" in document.import_findings[0].help
    assert [[cell.text for cell in row.cells] for row in table.rows[1:]] == [
        ["2026-01-02 00:00:00", "Speed"],
        ["01:30:00", "Load"],
        ["2026-01-02 03:04:00", "Mode"],
        ["", "Sum"],
        ["#REF!", "#4"],
        ["#NAME?", "0.1"],
        ["#N/A", "2"],
        ["TRUE", "FALSE"],
    ]


def test_rows_of_csv_have_the_numbers_of_their_lines(tmp_path):
    """A quoted cell can contain line ends."""
    (tmp_path / "motor.csv").write_bytes(
        b'Motor\r\n\r\nByte,Name\r\n0,"Speed\r\nof the motor"\r\n1, Load \r\n,\r\n2,Mode\r\n'
    )
    document, tables = sources.read(tmp_path / "motor.csv", profile.load())
    assert [
        [(row.line, [cell.text for cell in row.cells]) for row in table.rows]
        for table in tables
    ] == [
        [
            (3, ["Byte", "Name"]),
            (4, ["0", "Speed\nof the motor"]),
            (6, ["1", "Load"]),
        ],
        [(8, ["2", "Mode"])],
    ]
    assert [(block.text, block.line) for block in document.blocks[:1]] == [("Motor", 1)]


def test_merged_cells_span_their_columns_and_empty_edges_of_a_sheet_are_left_out(
    tmp_path,
):
    book = openpyxl.Workbook()
    sheet = book.active
    for row in (["Title", None], [], ["Both", None, "Unit"], ["a", "b", "V"], [1], []):
        sheet.append(row)
    sheet.merge_cells("A3:B3")
    sheet["E9"] = " "  # of a cell that was cleared
    plain = book.create_sheet("Plain")
    for row in (["Byte", "Name", None], [0, "Speed", " "]):
        plain.append(row)
    book.save(tmp_path / "motor.xlsx")
    _, tables = sources.read(tmp_path / "motor.xlsx", profile.load())
    assert [
        [(row.line, [(c.text, c.columns, c.rows) for c in row.cells]) for row in rows]
        for rows in (table.rows for table in tables)
    ] == [
        [
            (3, [("Both", 2, 1), ("Unit", 1, 1), ("", 1, 1), ("", 1, 1)]),
            (4, [(text, 1, 1) for text in ("a", "b", "V", "", "")]),
            (5, [(text, 1, 1) for text in ("1", "", "", "", "")]),
        ],
        [
            (1, [("Byte", 1, 1), ("Name", 1, 1)]),
            (2, [("0", 1, 1), ("Speed", 1, 1)]),
        ],
    ]


def test_sheets_have_several_tables_with_texts_above_and_hidden_ones_are_named(
    tmp_path,
):
    xlsx(tmp_path / "motor.xlsx")
    book = openpyxl.load_workbook(tmp_path / "motor.xlsx")
    sheet = book["Messages"]
    for row in ([], ["Errors"], ["Code", "Meaning"], [0, "none"], [1.5, "hot"]):
        sheet.append(row)
    book.save(tmp_path / "motor.xlsx")
    document, tables = sources.read(tmp_path / "motor.xlsx", profile.load())
    assert [(t.headings, t.before, t.sheet) for t in tables] == [
        (["Messages"], ["Messages", "Interface of the motor, issue 3"], "Messages"), (["Messages"], ["Errors"], "Messages"),
    ]  # fmt: skip
    assert [[cell.text for cell in row.cells] for row in tables[1].rows] == [
        ["Code", "Meaning"],
        ["0", "none"],
        ["1.5", "hot"],
    ]
    assert [t.message for t in document.import_findings] == [
        "the sheet `Old` is hidden; it was left out"
    ]
    assert document.title == "Manual of the motor"


def test_captions_and_the_chain_of_headings_come_from_the_document(tmp_path):
    text = """<h1>4 Telemetry</h1><h2>4.1 Motor</h2><p>Asked for by <b>0x21</b>.</p><table><caption>Motor state</caption>
      <tr><td>a</td><td colspan=2>b</td></tr></table>
      <p>Table 7: Tank state</p><table><tr><td rowspan=9>c</td><td>d<p>e</p></td></tr></table><h2>4.2 Rest</h2>"""
    (tmp_path / "a.html").write_text(text, encoding="utf-8")
    _, (first, second) = sources.read(tmp_path / "a.html", profile.load())
    assert (first.headings, first.caption, first.before[-1]) == (
        ["4 Telemetry", "4.1 Motor"],
        "Motor state",
        "Asked for by 0x21.",
    )
    assert first.rows[0].cells[1].columns == 2
    assert (second.label, second.caption, second.rows[0].cells[1].text) == (
        7,
        "Tank state",
        "d\ne",
    )
    assert second.rows[0].cells[0].rows == 1  # no more than there are


def _read_html(path: Path, body: str):
    """Return the document of a web page and its tables."""
    path.write_text(f"<html><body>{body}</body></html>", encoding="utf-8")
    return sources.read(path, profile.load())


TABLE = "<table><tr><td>a<td>b</table>"


@pytest.mark.parametrize(
    ("body", "lines"),
    [
        ("<div>Id <!-- of the bus --> 0x21 of it.</div>", ["Id 0x21 of it."]),
        (
            "<!-- x -->Id 0x21<script>no()</script>, <b>always</b>.",
            ["Id 0x21, always."],
        ),
        ("<p>Id<br>0x21</p>Length 8", ["Id", "0x21", "Length 8"]),
        ("<p>Id of\n  the bus</p>", ["Id of the bus"]),
        ("<pre>struct <b>a\n{</b>\nint8_t x;</pre>", ["struct a", "{", "int8_t x;"]),
        ("<dl><dt>Id<dd>0x21</dl>", ["Id", "0x21"]),
        ("<ul><li>Id<li>0x21</ul>", ["Id", "0x21"]),
        ("<p>Id <s>0x20</s><del>0x2</del>0x21</p>", ["Id 0x21"]),
        ("<p>10 \u00b5A, 20 \u00b0C</p>", ["10 \u00b5A, 20 \u00b0C"]),
    ],
)
def test_all_text_of_a_web_page_is_kept_in_the_lines_that_a_browser_shows(
    tmp_path, body, lines
):
    _, (table,) = _read_html(tmp_path / "a.html", body + TABLE)
    assert table.before == lines


def test_a_caption_in_several_elements_and_source_lines_is_one_caption(tmp_path):
    body = f"<div><b>Table 7:</b> Tank\n  <i>state</i></div>{TABLE}"
    _, (table,) = _read_html(tmp_path / "a.html", body)
    assert (table.label, table.caption) == (7, "Tank state")


def test_a_heading_within_any_element_begins_a_section(tmp_path):
    body = f"<aside><header><h2>4.1 Motor</h2></header>{TABLE}</aside>"
    _, (table,) = _read_html(tmp_path / "a.html", body)
    assert table.headings == ["4.1 Motor"]


@pytest.mark.parametrize(
    ("span", "rows"),
    [
        ("0", 3),
        ("2", 2),
        ("9", 3),
        (" +2;", 2),
        ("x", 1),
        ("\u00b2", 1),
        ("9" * 9999, 3),
    ],
)
def test_row_spans_end_with_their_group_of_rows_as_in_browsers(tmp_path, span, rows):
    body = f"""<table><thead><tr><th>A<th>B</thead>
      <tbody><tr><td rowspan="{span}">a<td>1<tr><td>2<tr><td>3</tbody>
      <tbody><tr><td>b<td>4</tbody></table>"""
    _, (table,) = _read_html(tmp_path / "a.html", body)
    assert table.rows[1].cells[0].rows == rows
    assert [cell.text for cell in table.rows[-1].cells] == ["b", "4"]


def test_a_page_that_declares_its_encoding_is_read_in_it(tmp_path):
    page = f"<meta charset='iso-8859-15'><p>10 \u00b5A, 5 \u20ac</p>{TABLE}"
    (tmp_path / "a.html").write_bytes(page.encode("iso-8859-15"))
    _, (table,) = sources.read(tmp_path / "a.html", profile.load())
    assert table.before == ["10 \u00b5A, 5 \u20ac"]


def test_a_page_whose_parts_the_parser_leaves_out_is_a_finding(tmp_path):
    with pytest.raises(Findings) as caught:
        _read_html(tmp_path / "a.html", "<div>" * 5000 + TABLE)
    assert "nested too deeply" in caught.value.findings[0].message


WORD = """<w:body xmlns:w="http://schemas.openxmlformats.org/wordprocessingml/2006/main">
  <w:p><w:r><w:t xml:space="preserve">Id </w:t></w:r>
    <w:ins w:id="1" w:author="a"><w:r><w:t>0x21</w:t></w:r></w:ins>
    <w:del w:id="2" w:author="a"><w:r><w:delText>0x20</w:delText></w:r></w:del></w:p>
  <w:p><w:r><w:t xml:space="preserve">Table </w:t></w:r>
    <w:fldSimple w:instr="SEQ Table"><w:r><w:t>3</w:t></w:r></w:fldSimple>
    <w:r><w:t>: Motor</w:t></w:r></w:p>
  <w:sdt><w:sdtPr/><w:sdtContent><w:tbl><w:tblPr/><w:tblGrid/>
    <w:tr><w:tc><w:p><w:sdt><w:sdtContent><w:r><w:t>a</w:t></w:r></w:sdtContent></w:sdt></w:p></w:tc>
      <w:sdt><w:sdtContent><w:tc><w:p><w:r><w:rPr><w:strike/></w:rPr><w:t>1</w:t></w:r>
        <w:r><w:rPr><w:strike w:val="0"/></w:rPr><w:t>2</w:t></w:r></w:p></w:tc></w:sdtContent></w:sdt></w:tr>
    <w:tr><w:trPr><w:del w:id="3" w:author="a"/></w:trPr><w:tc><w:p><w:r><w:t>old</w:t></w:r></w:p></w:tc></w:tr>
    <w:tr><w:trPr><w:ins w:id="4" w:author="a"/></w:trPr><w:tc><w:p><w:r><w:t>b</w:t></w:r></w:p></w:tc></w:tr>
  </w:tbl></w:sdtContent></w:sdt></w:body>"""


def test_a_word_document_is_read_with_its_changes_fields_and_content_controls(tmp_path):
    document = docx.Document()
    for element in reversed(docx.oxml.parse_xml(WORD)):
        document.element.body.insert(0, element)
    document.save(str(tmp_path / "a.docx"))
    _, (table,) = sources.read(tmp_path / "a.docx", profile.load())
    assert (table.before, table.label, table.caption) == (["Id 0x21"], 3, "Motor")
    rows = [[cell.text for cell in row.cells] for row in table.rows]
    assert rows == [["a", "2"], ["b"]]


def test_a_heading_whose_paragraph_mark_is_struck_through_stays_a_heading(tmp_path):
    document = docx.Document()
    properties = document.add_heading("4 Motor", 1)._p.get_or_add_pPr()
    mark = docx.oxml.OxmlElement("w:rPr")
    mark.append(docx.oxml.OxmlElement("w:strike"))
    properties.append(mark)
    document.add_table(1, 1).cell(0, 0).text = "a"
    document.save(str(tmp_path / "a.docx"))
    _, (table,) = sources.read(tmp_path / "a.docx", profile.load())
    assert table.headings == ["4 Motor"]


def test_the_lines_of_a_list_in_a_cell_are_lines(tmp_path):
    body = "<table><tr><td><dl><dt>0<dd>Off<dt>1<dd>On</dl><td>Mode</table>"
    _, (table,) = _read_html(tmp_path / "a.html", body)
    assert table.rows[0].cells[0].text == "0\nOff\n1\nOn"


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.xlsx", b"PK\x03\x04nothing"),
        ("a.docx", b"PK\x03\x04nothing"),
        ("a.csv", b"a;\xff"),
        ("a.csv", b'a;"b'),
        ("a.zip", b"PK\x03\x04"),
        ("a.md", b"\xff"),
    ],
)
def test_a_file_that_cannot_be_read_is_a_finding(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(Findings) as caught:
        sources.read(tmp_path / name, profile.load())
    assert caught.value.findings[0].code == "IMP002" and caught.value.findings[0].help


def test_commas_of_descriptions_do_not_separate_columns_of_semicolons(tmp_path):
    text = "Byte;Description\n1;Speed, in rpm, of wheel 1, 2, 3, or 4\n2;Mode\n"
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    _, (table,) = sources.read(tmp_path / "a.csv", profile.load())
    rows = [[cell.text for cell in row.cells] for row in table.rows]
    assert rows[1:] == [["1", "Speed, in rpm, of wheel 1, 2, 3, or 4"], ["2", "Mode"]]


def test_an_invalid_number_stays_text(tmp_path):
    book = openpyxl.Workbook()
    book.active.append(["Byte", "Value"])
    book.active.append([1, 1.5])
    book.save(tmp_path / "b.xlsx")
    with ZipFile(tmp_path / "b.xlsx") as old, ZipFile(tmp_path / "a.xlsx", "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name).replace(b"<v>1.5</v>", b"<v>1e999</v>"))
    _, (table,) = sources.read(tmp_path / "a.xlsx", profile.load())
    assert [cell.text for cell in table.rows[1].cells] == ["1", "inf"]


def test_without_rules_a_spreadsheet_gives_its_tables_and_no_message(tmp_path):
    xlsx(tmp_path / "motor.xlsx")
    result, trees = run.run(tmp_path / "motor.xlsx", profile.load(), jobs=1)
    assert trees == {} and len(findings_of(result, "IMP100")) == 1
