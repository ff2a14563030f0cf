"""Reports for programs: JSON, workflow commands of GitHub, SARIF."""

from __future__ import annotations

import json

import pytest

from icdgen import reports
from icdgen.reports import get
from tests.reports.findings import CORRECTED, ERROR, NOTE, TEXTS, TWICE, WARNING

ALL = [ERROR, WARNING, NOTE]


@pytest.mark.parametrize("name", reports.FORMATS)
def test_every_format_takes_findings_and_no_findings(name):
    assert isinstance(get(name)(ALL, TEXTS), str)
    assert isinstance(get(name)(iter(()), {}), str)


def test_json():
    report = json.loads(get("json")(ALL, TEXTS))
    assert report["counts"] == {"error": 1, "warning": 1, "note": 1}
    assert report["findings"][0] == {
        "code": "ICD020",
        "severity": "error",
        "message": "`Voltage` is 100% wrong: it ends, alas",
        "help": "correct it",
        "file": "icd/demo.yaml",
        "line": 2,
        "column": 7,
        "length": 12,
    }


def test_json_has_the_correction_and_the_other_place():
    corrected, twice = json.loads(get("json")([CORRECTED, TWICE], TEXTS))["findings"]
    place = {"file": "icd/demo.yaml", "line": 2, "column": 14, "length": 4}
    assert corrected["fix"] == place | {"text": "demos"}
    assert twice["related"] == place | {"label": "the first of this name"}


def test_github_escapes_characters_that_end_a_command():
    assert get("github")(ALL, TEXTS).splitlines() == [
        "::error title=icdgen ICD020,file=icd/demo.yaml,line=2,endLine=2,col=7,endColumn=19"
        "::ICD020: `Voltage` is 100%25 wrong: it ends, alas%0Ahelp: correct it",
        "::warning title=icdgen ICD041,file=icd/demo.yaml,line=1,endLine=1,col=1,endColumn=7::ICD041: nothing uses it",
        "::notice title=icdgen ICD999,file=a b/größe%2C1%3A2.yaml,line=7,endLine=7,col=3,endColumn=4"
        "::ICD999: no such rule%0Ahelp: two%0Alines",
    ]


def test_github_prints_nothing_without_findings():
    assert get("github")([], TEXTS) == ""


def test_a_name_cannot_smuggle_a_command_into_a_github_report():
    hostile = ERROR._replace(message="x\n::set-output name=a::b\r::error::c", help="")
    assert len(get("github")([hostile], TEXTS).splitlines()) == 1


def run() -> dict:
    report = json.loads(get("sarif")(ALL, TEXTS))
    assert report["version"] == "2.1.0"
    assert report["$schema"].endswith("sarif-2.1.0.json")
    (only,) = report["runs"]
    return only


def test_sarif_names_the_tool_and_the_rules_that_were_broken():
    driver = run()["tool"]["driver"]
    assert driver["name"] == "icdgen"
    assert [rule["id"] for rule in driver["rules"]] == ["ICD020", "ICD041", "ICD999"]
    first = driver["rules"][0]
    assert (
        first["shortDescription"]["text"] == "Field extends past the end of its message"
    )
    assert first["fullDescription"]["text"]
    assert "Wrong:" in first["help"]["text"]
    assert first["defaultConfiguration"] == {"level": "error"}
    assert driver["rules"][1]["defaultConfiguration"] == {"level": "warning"}


def test_sarif_results_refer_to_rules_and_places():
    only = run()
    assert only["columnKind"] == "unicodeCodePoints"
    rules = only["tool"]["driver"]["rules"]
    for result, finding in zip(only["results"], ALL, strict=True):
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"] == finding.code
        assert result["level"] == finding.severity
        assert result["message"]["text"].startswith(finding.message)
        (location,) = result["locations"]
        region = location["physicalLocation"]["region"]
        assert (region["startLine"], region["startColumn"]) == finding.place[1:3]
        assert region["endColumn"] - region["startColumn"] == finding.place.length


def test_sarif_files_are_uris():
    uris = [
        r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
        for r in run()["results"]
    ]
    assert uris == [
        "icd/demo.yaml",
        "icd/demo.yaml",
        "a%20b/gr%C3%B6%C3%9Fe%2C1%3A2.yaml",
    ]
    absolute = ERROR._replace(place=ERROR.place._replace(file="/icd/a b.yaml"))
    report = json.loads(get("sarif")([absolute], {}))
    place = report["runs"][0]["results"][0]["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "file:///icd/a%20b.yaml"


def test_sarif_has_the_correction_and_the_other_place():
    corrected, twice = json.loads(get("sarif")([CORRECTED, TWICE], TEXTS))["runs"][0][
        "results"
    ]
    (fix,) = corrected["fixes"]
    assert fix["description"]["text"] == "did you mean `demos`?"
    (change,) = fix["artifactChanges"]
    assert change["artifactLocation"]["uri"] == "icd/demo.yaml"
    assert change["replacements"] == [
        {
            "deletedRegion": {"startLine": 2, "startColumn": 14, "endColumn": 18},
            "insertedContent": {"text": "demos"},
        }
    ]
    (related,) = twice["relatedLocations"]
    assert related["message"]["text"] == "the first of this name"
    assert related["physicalLocation"]["region"]["startLine"] == 2
