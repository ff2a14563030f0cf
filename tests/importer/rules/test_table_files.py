"""Table files that people edit, and the options of `icdgen import` about tables and
rules.
"""

from __future__ import annotations

import json

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import table_files
from tests.importer.rules.test_mistakes import RULES, TABLE
from tests.importer.rules.test_rules import NODE
from tests.importer.test_command import icdgen


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "state.txt").write_text(TABLE, encoding="utf-8")
    (tmp_path / "rules.yaml").write_text(NODE + RULES, encoding="utf-8")
    return tmp_path


def test_a_correction_of_a_table_file_changes_the_result(folder):
    result = icdgen("import", "state.txt", "--tables", "tables", cwd=folder)
    assert (result.returncode, result.stdout) == (
        0,
        "tables: 1 table written; correct them, then `icdgen import tables`\n",
    )
    path = folder / "tables" / "001.table.yaml"
    path.write_text(
        path.read_text(encoding="utf-8").replace('"Level", "32"', '"Charge", "40"'),
        encoding="utf-8",
    )
    result = icdgen("import", "tables", "--profile", "rules.yaml", cwd=folder)
    assert result.returncode == 0, result.stdout
    assert "no field covers bit 32 to 39" in result.stdout
    assert "at: 40, bits: 8,  name: Charge," in (
        folder / "icd" / "state.yaml"
    ).read_text(encoding="utf-8")


def test_files_of_removed_tables_are_deleted(folder):
    icdgen("import", "state.txt", "--tables", "tables", cwd=folder)
    (folder / "tables" / "099.table.yaml").write_text(
        "table: 99\nrows: []\n", encoding="utf-8"
    )
    (folder / "tables" / "notes.txt").write_text("mine", encoding="utf-8")
    icdgen("import", "state.txt", "--tables", "tables", cwd=folder)
    assert sorted(path.name for path in (folder / "tables").iterdir()) == [
        "001.table.yaml",
        "notes.txt",
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("table: 1\nrows: [[1]]\n", "this must be text or a mapping, not the number 1"),
        ('table: 1\nrows:\n  - [{text: "a", column: 2}]\n', "unknown key `column`"),
        (
            'table: 1\nrows:\n  - [{text: "a", columns: 0}]\n',
            "`columns` must be at least 1, not 0",
        ),
        ('rows:\n  - ["a"]\n', "`table` is missing"),
        (
            'table: 1\nrows:\n  - ["a", {text: "b", rows: 2}]\n  - [{text: "c", columns: 2}]\n',
            "the cell `b` lies below another cell",
        ),
    ],
)
def test_a_table_file_that_is_wrong_is_a_finding_with_its_line(tmp_path, text, message):
    (tmp_path / "001.table.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(Findings) as caught:
        table_files.read_tables(tmp_path)
    assert [(f.code, f.place.line >= 1) for f in caught.value.findings][:1] == [
        ("IMP006", True)
    ]
    assert any(message in f.message for f in caught.value.findings), [
        f.message for f in caught.value.findings
    ]


def test_explain_says_which_rule_read_a_table_and_why_others_did_not(folder):
    rules = RULES.replace(
        "rules:\n",
        "rules:\n  - {rule: pins, what: ignore, tables: {head: Num | Pin}}\n",
    )
    (folder / "rules.yaml").write_text(NODE + rules, encoding="utf-8")
    result = icdgen(
        "import", "state.txt", "--profile", "rules.yaml", "--explain", "1", cwd=folder
    )
    assert result.returncode == 0
    assert (
        "rule `pins` (4) does not apply: the headings differ: `Pin` is wanted as cell 2, the table has `Parameter`"
        in result.stdout
    )
    assert "rule `state` (5) applies: message" in result.stdout
    assert "column `Num`: ignored" in result.stdout
    assert (
        "message: kind = `telemetry`, message = `STATE`, id = `0x02F4`" in result.stdout
    )
    assert "bit   16 +16  uint  Current A, raw*0.1 - 400" in result.stdout
    assert not (folder / "icd").exists()
    result = icdgen(
        "import", "state.txt", "--profile", "rules.yaml", "--explain", "2", cwd=folder
    )
    assert result.returncode == 2 and "tables are numbered from 1 to 1" in result.stderr
    result = icdgen("import", "state.txt", "--explain", "1", cwd=folder)
    assert (
        result.returncode == 0
        and "no rule applies: the table is not imported" in result.stdout
    )


def test_explore_gives_a_rule_for_each_kind_of_table(folder):
    (folder / "empty.yaml").write_text("profile: 1\nrules: []\n", encoding="utf-8")
    result = icdgen(
        "import", "state.txt", "--profile", "empty.yaml", "--explore", cwd=folder
    )
    assert (
        "  - tables: {head: Num | Parameter | Position | Length | Range | Factor | Offset | Unit}\n"
        in result.stdout
    )
    assert "      Offset:   # 0 | -400\n" in result.stdout
    result = icdgen(
        "import",
        "state.txt",
        "--profile",
        "empty.yaml",
        "--explore",
        "--format",
        "json",
        cwd=folder,
    )
    assert json.loads(result.stdout)["kinds"][0]["tables"] == [1]


def test_the_report_shows_the_cells_of_tables_that_rules_read(folder):
    (folder / "rules.yaml").write_text(
        NODE + RULES.replace("Factor: scale", "Scale: scale"), encoding="utf-8"
    )
    icdgen(
        "import",
        "state.txt",
        "--profile",
        "rules.yaml",
        "--dry-run",
        "--report",
        "report.html",
        cwd=folder,
    )
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "<td>Voltage</td><td>0</td><td>16</td>" in page and "IMP102" in page


def test_a_finding_of_a_rule_shows_the_rule(folder):
    (folder / "rules.yaml").write_text(
        NODE + RULES.replace("Factor: scale", "Scale: scale"), encoding="utf-8"
    )
    result = icdgen(
        "import", "state.txt", "--profile", "rules.yaml", "--dry-run", cwd=folder
    )
    assert result.returncode == 1
    assert "error[IMP102]: table 1 (`4.1 Basic state (STATE) " in result.stdout
    assert "  = rule: rules.yaml:12:7\n" in result.stdout
