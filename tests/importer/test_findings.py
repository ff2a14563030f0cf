"""Findings of an import are explained, in a fixed order, never merged, and never a
traceback.
"""

from __future__ import annotations

import json
import re

import pytest
from reportlab.pdfgen.canvas import Canvas

from icdgen.import_results.findings import CERTAIN
from icdgen.importer import findings
from tests.conftest import ROOT
from tests.importer.test_command import TEXT, icdgen
from tests.importer.test_text import ENUM, MESSAGE, findings_of, read

SOURCES = [
    *(ROOT / "codegen" / "icdgen" / "importer").rglob("*.py"),
    *(ROOT / "codegen" / "icdgen" / "definitions").rglob("*.py"),
    ROOT / "codegen/icdgen/commands/import_.py",
]


def test_every_code_that_an_import_gives_has_a_page_with_an_example():
    codes = {
        code
        for path in SOURCES
        for code in re.findall(r'"(IMP[0-9]{3})"', path.read_text("utf-8"))
    }
    assert codes == set(findings.pages())
    assert all(
        re.search(r"^ {4}\S", page.text, re.M) for page in findings.pages().values()
    )


def test_icdgen_rule_explains_and_lists_the_findings_of_an_import(tmp_path):
    assert icdgen("rule", "imp100", cwd=tmp_path).stdout.startswith("# IMP100: ")
    assert "\nIMP063  taken from the list\n" in icdgen("rule", cwd=tmp_path).stdout


def draw_message(path, below: float = 0, crop=None) -> None:
    """Draw a ruled message table near the lower edge of the page. ``below``: points by
    which its last row is below the edge.
    """
    canvas = Canvas(str(path), pagesize=(400, 300), invariant=1)
    if crop:
        canvas.setCropBox(crop)
    rows = [["ID", "140", "Frame Length (bytes)", "", "4"], ["Offset (bits)", "Length (bits)", "Name", "Data Type", "Notes"],
            ["0", "16", "Pressure", "INT", "of the tank"], ["16", "16", "Speed", "INT", "of the pump"]]  # fmt: skip
    top = 4 * 20 - below
    for index, row in enumerate(rows):
        y = top - 20 * index
        for column, text in enumerate(row):
            canvas.rect(20 + 70 * column, y - 20, 70, 20)
            canvas.setFont("Helvetica", 7)
            canvas.drawString(23 + 70 * column, y - 13, text)
    canvas.drawString(20, 290, "Manual of the pump")
    canvas.showPage()
    canvas.save()


def test_text_below_the_edge_of_the_page_is_left_out_with_a_finding(tmp_path):
    canvas = Canvas(str(tmp_path / "edge.pdf"), pagesize=(400, 300), invariant=1)
    canvas.drawString(20, 200, "Nothing but prose")
    canvas.drawString(20, -40, "under the edge")
    canvas.showPage()
    canvas.save()
    run = icdgen("import", "edge.pdf", cwd=tmp_path)
    assert run.returncode == 1
    assert "Traceback" not in run.stderr
    assert "note[IMP013] page 1: 3 words stand outside the visible page" in run.stdout


@pytest.mark.parametrize("crop", [None, (0, 50, 400, 300), (0, 150, 200, 300)])
def test_a_table_over_the_edge_of_the_page_does_not_stop_summary_and_report(
    tmp_path, crop
):
    draw_message(tmp_path / "pump.pdf", below=30, crop=crop)
    run = icdgen("import", "pump.pdf", "--report", "report.html", cwd=tmp_path)
    assert "Traceback" not in run.stderr
    assert "findings: " in run.stdout
    assert "<h1>" in (tmp_path / "report.html").read_text("utf-8")


def test_findings_stand_in_the_same_order_in_each_run(tmp_path):
    text = "".join(
        MESSAGE.replace("INT", f"WORD{n}").replace("ID\t140", f"ID\t{n}")
        for n in range(100, 120)
    )
    (tmp_path / "pump.txt").write_text(text, encoding="utf-8")
    runs = {
        icdgen(
            "import", "pump.txt", "--dry-run", "--format", "json", cwd=tmp_path
        ).stdout
        for _ in range(3)
    }
    assert len(runs) == 1


def test_equal_findings_of_one_place_are_counted(tmp_path):
    text = (
        MESSAGE.replace("\t16\t8\tMode", "\tx\t8\tMode\tUINT\tx\n\tx\t8\tMode") + ENUM
    )
    result, _ = read(tmp_path, text)
    assert findings_of(result, "IMP023") == [
        "table 1 (`Pump State Telemetry Format`), field `Mode`: `bit` is `x`, which is not a number; the same in 1 more row"
    ]


def test_a_message_that_is_left_out_is_not_called_certain(tmp_path):
    result, tree = read(tmp_path, MESSAGE.replace("ID\t140", "Id\tx") + ENUM)
    assert "messages" not in tree
    assert (
        "its rule gives no id; the message was left out"
        in findings_of(result, "IMP031")[0]
    )
    assert result.sureness()[CERTAIN] == 1  # the enumeration


def test_nothing_found_names_the_headings_that_were_seen_and_gives_a_report(tmp_path):
    text = "Table 1: Things\n\nPlace\tSize\tThing\n1\t2\tx\n\nTable 2: More\n\nPlace\tSize\tThing\n1\t2\ty\n"
    (tmp_path / "odd.txt").write_text(text, encoding="utf-8")
    run = icdgen("import", "odd.txt", "--report", "report.html", cwd=tmp_path)
    assert run.returncode == 1
    assert (
        "no rule applies to tables 1, 2 with the headings `Place | Size | Thing`"
        in run.stdout
    )
    assert "Things" in (tmp_path / "report.html").read_text("utf-8")
    assert not (tmp_path / "icd").exists()


def test_json_is_json_whatever_happens(tmp_path):
    (tmp_path / "odd.txt").write_text("nothing\n", encoding="utf-8")
    (tmp_path / "bad.pdf").write_bytes(b"%PDF-1.4\n" + b"\x00garbage" * 40)
    (tmp_path / "pump.txt").write_text(TEXT, encoding="utf-8")
    (tmp_path / "words.yaml").write_text("profile: 1\nrulez: []\n", encoding="utf-8")
    for arguments, code in ((["odd.txt"], "IMP004"), (["bad.pdf"], "IMP003"), (["none.txt"], "IMP002"),
                            (["pump.txt", "--profile", "words.yaml"], "IMP001")):  # fmt: skip
        run = icdgen("import", *arguments, "--format", "json", cwd=tmp_path)
        assert (run.returncode, run.stderr) == (1, "")
        assert [f["code"] for f in json.loads(run.stdout)["findings"]] == [code]


def test_a_row_without_offset_does_not_vanish_in_the_row_above(tmp_path):
    result, _ = read(
        tmp_path, MESSAGE.replace("\t24\t1\tValve Open", "\t\t\tValve Open") + ENUM
    )
    # Its name and type are read as further lines of the row above, which makes them
    # invalid.
    assert result.failed


def test_a_column_without_a_role_is_named_with_its_cells(tmp_path):
    text = MESSAGE.replace(
        "Data Type\tDescription", "Data Type\tDescription\tGain"
    ).replace("Valve open\n", "Valve open\t2.5\n")
    result, _ = read(tmp_path, text + ENUM)
    assert "gives the column `Gain` no role: `2.5`" in findings_of(result, "IMP102")[0]


def test_rotated_words_are_left_out_with_a_finding(tmp_path):
    canvas = Canvas(str(tmp_path / "turned.pdf"), invariant=1)
    canvas.drawString(72, 700, "Upright")
    canvas.rotate(90)
    canvas.drawString(200, -300, "Turned label")
    canvas.showPage()
    canvas.save()
    shown = icdgen("import", "turned.pdf", cwd=tmp_path).stdout
    assert re.search(r"note\[IMP014\] page 1: [0-9]+ words are rotated", shown)
