"""Reports of an import as text and for JSON: findings, files and their changes."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.diagnostics import Finding, Place
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.import_results.report import (
    checked_as_json,
    files,
    files_as_json,
    finding_as_json,
    findings,
    severities,
    where,
)
from icdgen.import_results.targets import Target

BELL = "\x07\x1b[2J"


@pytest.mark.parametrize("severity", ["error", "warning", "note"])
def test_control_characters_of_a_manual_are_escaped(severity):
    spot = SourcePlace(line=3, file=f"manual{BELL}.txt")
    given = ImportFinding(
        "IMP010", f"message{BELL}", spot, help=f"help{BELL}", severity=severity
    )
    text = "\n".join(findings([given], "manual.pdf"))
    assert "message" in text and "IMP010" in text
    assert all(letter == "\n" or letter.isprintable() for letter in text)


@pytest.mark.parametrize(
    ("spot", "text"),
    [
        (SourcePlace(), "manual.pdf"),
        (SourcePlace(page=12), "manual.pdf, page 12"),
        (SourcePlace(line=482), "manual.pdf:482"),
        (SourcePlace(line=0, page=0), "manual.pdf:0, page 0"),
        (SourcePlace(line=3, file="types.xml"), "types.xml:3"),
    ],
)
def test_a_place_has_file_line_and_page(spot, text):
    assert where("manual.pdf", spot) == text


ERROR = ImportFinding(
    "IMP103",
    "no pattern",
    SourcePlace(line=3),
    "add one",
    "error",
    place=Place("rules.yaml", 4, 5),
)
WARNING = ImportFinding("IMP010", "odd", SourcePlace(page=2))
NOTE = ImportFinding("IMP108", "drops", SourcePlace(page=2), "look", "note")


def test_errors_and_warnings_are_blocks_in_front_of_the_lines_of_notes():
    assert findings([NOTE, ERROR, WARNING], "m.txt") == [
        "error[IMP103]: no pattern",
        "  --> m.txt:3",
        "  = rule: rules.yaml:4:5",
        "  = help: add one",
        "",
        "warning[IMP010]: odd",
        "  --> m.txt, page 2",
        "",
        "note[IMP108] page 2: drops",
        "",
    ]
    general = NOTE._replace(spot=SourcePlace())
    assert findings([general], "m.txt") == ["note[IMP108] the document: drops", ""]
    assert findings([], "m.txt") == []


def test_severities_have_colours_if_wanted():
    lines = findings([ERROR, WARNING, NOTE], "m.txt", colour=True)
    assert lines[0] == "\x1b[31;1merror[IMP103]\x1b[0m: no pattern"
    assert lines[5] == "\x1b[33;1mwarning[IMP010]\x1b[0m: odd"
    assert lines[8] == "\x1b[36mnote\x1b[0m[IMP108] page 2: drops"


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ([], "findings: none"),
        ([NOTE], "findings: 1 note"),
        ([NOTE, WARNING, ERROR, ERROR], "findings: 2 errors, 1 warning, 1 note"),
    ],
)
def test_findings_are_counted_by_severity(given, text):
    assert severities(given) == text


TREE = {
    "messages": [{"fields": [{}, {}]}, {}],
    "enums": [{"members": [{}, {}, {}]}],
}
CONTENT = "2 messages with 2 fields, 1 enumeration with 3 members"
NEW = Target(Path("a.yaml"), "", TREE)
SAME = Target(Path("b.yaml"), "", {}, [], same=True)
CHANGED = Target(Path("c.yaml"), "", TREE, ["id: 1 -> 2", "x"])
REFUSED = Target(Path("d.yaml"), "", {}, ["x"], refused=True)
NOTHING = "0 messages with 0 fields, 0 enumerations with 0 members"


def test_each_file_is_listed_with_its_state_its_content_and_its_changes():
    assert files([NEW, SAME, CHANGED]) == [
        f"a.yaml: written; {CONTENT}",
        f"b.yaml: unchanged; {NOTHING}",
        f"c.yaml: updated; {CONTENT}",
        "  id: 1 -> 2",
        "  x",
    ]
    assert files([NEW, SAME, CHANGED, REFUSED], dry=True) == [
        f"a.yaml: would be written; {CONTENT}",
        f"b.yaml: unchanged; {NOTHING}",
        f"c.yaml: would be updated; {CONTENT}",
        "  id: 1 -> 2",
        "  x",
        f"d.yaml: would be updated with --update; {NOTHING}",
        "  x",
    ]


def test_findings_and_files_have_the_same_keys_in_json():
    item = {"code": "IMP010", "severity": "warning", "message": "odd", "help": ""}
    assert finding_as_json(WARNING) == item
    assert finding_as_json(ERROR) == {
        "code": "IMP103",
        "severity": "error",
        "message": "no pattern",
        "help": "add one",
        "rule": "rules.yaml:4:5",
    }
    checked = Finding("ICD055", "same", Place("a.yaml", 7, 2), "change", "warning")
    assert checked_as_json([checked]) == [
        {
            "code": "ICD055",
            "severity": "warning",
            "message": "same",
            "help": "change",
            "file": "a.yaml",
            "line": 7,
        }
    ]
    assert files_as_json([NEW, CHANGED]) == [
        {"file": "a.yaml", "changes": None},
        {"file": "c.yaml", "changes": ["id: 1 -> 2", "x"]},
    ]
