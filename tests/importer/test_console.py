"""Report of an import: summary, JSON, and the certainty of each table."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from icdgen.diagnostics import Finding, Place
from icdgen.import_results.findings import (
    DOUBTFUL,
    ImportFinding,
    SourcePlace,
)
from icdgen.import_results.targets import Target
from icdgen.importer import console
from icdgen.importer.document import PageBox, SourceRow, SourceTable
from icdgen.importer.model import BACKGROUND, UNKNOWN
from icdgen.importer.words import table_number
from tests.importer.results import result_of

TABLES = [SourceTable(number=number) for number in range(1, 9)]
KINDS = ["message", "message", "enumeration", "list", "loggable frames"]


def finding(order: int | None, severity: str = "warning", **keys) -> ImportFinding:
    spot = keys.pop("spot", SourcePlace(order=order))
    code = keys.pop("code", "IMP010")
    return ImportFinding(code, "odd", spot, severity=severity, **keys)


@pytest.mark.parametrize(
    ("kinds", "pages", "findings", "lines"),
    [
        ([], None, [], ["0 tables", "read: none", "findings: none"]),
        (["message"], 1, [],
         ["1 page, 1 table: 1 message", "read: 1 certain", "findings: none"]),
        ([*KINDS, BACKGROUND, UNKNOWN, UNKNOWN], 12, [finding(0), finding(2, "error")],
         ["12 pages, 8 tables: 2 messages, 1 enumeration, 1 list, 1 loggable frames,"
          " 1 background, 2 not understood",
          "read: 4 certain, 1 likely, 1 doubtful", "findings: 1 error, 1 warning"]),
        ([UNKNOWN], None, [],
         ["1 table: 1 not understood", "read: none", "findings: none"]),
    ],
)  # fmt: skip
def test_the_summary_counts_tables_by_kind_and_by_certainty(
    kinds, pages, findings, lines
):
    entries = zip(TABLES, kinds, strict=False)
    result = result_of(*entries, findings=findings, pages=pages)
    assert console.summary(result) == lines
    assert console.report(result).splitlines()[-3:] == lines


def test_the_json_report_has_tables_findings_files_and_the_check():
    chapter = table_number("4-12")
    first = SourceTable(1, [SourceRow([], line=5)], "State", 12)
    second = SourceTable(2, caption="Größe", label=chapter)
    second.boxes = [PageBox(3, 0, 0, 9, 9)]
    spot = SourcePlace(3, None, chapter, 1)
    place = Place("rules.yaml", 4, 5)
    findings = [
        ImportFinding("IMP023", "bad", spot, "mend", "error", DOUBTFUL, place),
        ImportFinding("IMP013", "outside", SourcePlace(), severity="note"),
    ]
    result = result_of(
        (first, "message"), (second, UNKNOWN), (TABLES[2], "list"), findings=findings
    )
    result.document.pages = 7
    result.targets.append(Target(Path("a.yaml"), "", {}, ["+ x"]))
    checked = Finding("ICD055", "same", Place("a.yaml", 7), "change", "warning")
    text = console.as_json(result, [checked])
    assert json.loads(text) == {
        "manual": "pump.txt",
        "pages": 7,
        "tables": [
            {"table": 12, "caption": "State", "page": None, "line": 5,
             "is": "message", "sure": "certain"},
            {"table": "4-12", "caption": "Größe", "page": 3, "line": None,
             "is": "not understood", "sure": "doubtful"},
            {"table": None, "caption": "", "page": None, "line": None,
             "is": "list", "sure": "certain"},
        ],
        "findings": [
            {"code": "IMP013", "severity": "note", "message": "outside", "help": "",
             "table": None, "page": None, "line": None},
            {"code": "IMP023", "severity": "error", "message": "bad", "help": "mend",
             "rule": "rules.yaml:4:5", "table": "4-12", "page": 3, "line": None},
        ],
        "files": [{"file": "a.yaml", "changes": ["+ x"]}],
        "check": [
            {"code": "ICD055", "severity": "warning", "message": "same",
             "help": "change", "file": "a.yaml", "line": 7},
        ],
    }  # fmt: skip
    assert "Größe" in text


def test_a_manual_that_cannot_be_read_has_a_report_with_the_same_keys():
    place = Place("rules.yaml", 4, 5)
    refused = Finding("IMP001", "Größe", place, "correct it", "warning")
    text = console.refused_as_json("pump.pdf", [refused])
    assert json.loads(text) == {
        "manual": "pump.pdf",
        "pages": None,
        "tables": [],
        "findings": [
            {"code": "IMP001", "severity": "warning", "message": "Größe",
             "help": "correct it", "file": "rules.yaml", "table": None, "page": None,
             "line": 4},
        ],
        "files": [],
        "check": [],
    }  # fmt: skip
    assert "Größe" in text
    assert list(json.loads(text)) == list(json.loads(console.as_json(result_of(), [])))
