"""Complete reports in each format with an accepted change, an unused acceptance and a
use of a changed name.
"""

from __future__ import annotations

import json
from contextlib import chdir
from dataclasses import replace
from pathlib import Path

import pytest

from icdgen.diff import accepted, inputs, reports, uses
from icdgen.diff.report import DiffReport, make_report
from icdgen.diff.reports.findings import of_report
from icdgen.diff.reports.groups import groups
from icdgen.diff.reports.text import COLOURS, RESET
from tests.conftest import DEMO
from tests.diff.conftest import LATER

SOURCE = "int a = state.roll_angle; demo_estimated_roll_t b; send(DEMO_SET_ROLL_ID);"
ACCEPTED = """\
accepted: 1
changes:
  - {code: DIF103, node: demo, message: Set Roll, was: '20', now: '21', reason: Agreed in review 7.}
  - {code: DIF106, node: demo, message: Gone, reason: Old.}
"""
TEXT = f"""\
old -> new

  wire        0  values are at other bits or are read differently
  meaning     1  the raw values are the same, their meaning differs
  source      0  generated names and types change
  text        0  words only

version of the generated packages: major. Reason: 1 change of the wire format and \
1 change of meaning, the first: the telecommand id of `Set Roll` is 21, was 20.

Can an old ground station read the new device's telemetry? partly: 0 of 1 frame as before
  partly demo Estimated Roll (146): another formula: `Roll Angle`

Can old telecommands still be sent? no: 0 of 1 frame as before
  no     demo Set Roll (20): its id is 21 now

Can new software read old log files? partly: 0 of 1 frame as before
  partly demo Estimated Roll (146): another formula: `Roll Angle`

meaning: the raw values are the same, their meaning differs

  Estimated Roll (telemetry 146, demo)
    error[DIF201] the value of `Roll Angle` is raw*0.001, was raw*0.01
        Identical bits give 0.1 times the value.
        old/demo.yaml:14:77 -> new/demo.yaml:14:77

uses in your sources
  src.c:1:15: roll_angle (DIF201)
    {SOURCE}
      the value of `Roll Angle` is raw*0.001, was raw*0.01

accepted: 1 change
  DIF103 the telecommand id of `Set Roll` is 21, was 20
    Agreed in review 7. (acc.yaml:3:12)

acc.yaml:4:12: warning[DIF901]: this accepted change does not happen: DIF106 at node `demo`, message `Gone`
  help: take the entry out, or correct it
"""
MARKDOWN = r"""
### meaning: the raw values are the same, their meaning differs

**Estimated Roll** (telemetry 146, demo)

- error `DIF201` the value of `Roll Angle` is raw\*0.001, was raw\*0.01 – old/demo.yaml:14 → new/demo.yaml:14
  - Identical bits give 0.1 times the value.

### Uses in your sources: 1

- src.c:1 `roll_angle` (`DIF201`)

<details><summary>accepted: 1 change</summary>

- `DIF103` the telecommand id of `Set Roll` is 21, was 20 – Agreed in review 7.

</details>

> **warning** this accepted change does not happen: DIF106 at node `demo`, message `Gone` (acc.yaml:4:12)
"""
GITHUB = """\
::error title=icdgen DIF201,file=new/demo.yaml,line=14,endLine=14,col=77,endColumn=86::\
DIF201: meaning: the value of `Roll Angle` is raw*0.001, was raw*0.01%0Ahelp: Identical bits give 0.1 times the value.
::warning title=icdgen DIF901,file=acc.yaml,line=4,endLine=4,col=12,endColumn=18::\
DIF901: this accepted change does not happen: DIF106 at node `demo`, message `Gone`%0Ahelp: take the entry out, or correct it
::error title=icdgen DIF201,file=src.c,line=1,endLine=1,col=15,endColumn=25::\
DIF201: `roll_angle` is touched: the value of `Roll Angle` is raw*0.001, was raw*0.01
"""


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> DiffReport:
    folder = tmp_path_factory.mktemp("report")
    for name, text in (("old", DEMO), ("new", LATER)):
        (folder / name).mkdir()
        (folder / name / "demo.yaml").write_text(text)
    (folder / "src.c").write_text(f"{SOURCE}\n")
    (folder / "acc.yaml").write_text(ACCEPTED)
    with chdir(folder):
        entries, text = accepted.read_file(Path("acc.yaml"), "acc.yaml")
        assert text == ACCEPTED
        result = make_report(*inputs.sides(["old", "new"], []), entries)
        result.uses = uses.uses(result.comparison, result.changes, [Path("src.c")])
    return result


def test_the_text_has_every_section_in_its_order(report):
    assert reports.get("text")(report) == TEXT


def test_colours_mark_layers_verdicts_and_severities(report):
    def painted(role: str, text: str) -> str:
        return f"{COLOURS[role]}{text}{RESET}"

    lines = reports.get("text")(report, colour=True).splitlines()
    assert lines[0] == painted("head", "old -> new")
    assert lines[2].startswith("  wire        0")
    assert lines[3].startswith(f"  {painted('meaning', 'meaning ')}    1")
    text = "\n".join(lines)
    for role, marked in (
        ("partly", "partly"),
        ("no", "no    "),
        ("error", "error[DIF201]"),
        ("place", "old/demo.yaml:14:77 -> new/demo.yaml:14:77"),
        ("place", "src.c:1:15"),
        ("warning", "warning[DIF901]"),
        ("head", "accepted: 1 change"),
        ("head", "Estimated Roll"),
    ):
        assert painted(role, marked) in text, marked


def test_markdown_has_changes_uses_and_acceptances(report):
    text = reports.get("markdown")(report)
    assert text.endswith(f"</details>\n{MARKDOWN}")
    assert text.count("<details>") == 4


def test_commands_of_github_are_about_changes_acceptances_and_uses(report):
    assert reports.get("github")(report) == GITHUB


def test_findings_of_a_report_have_places_and_severities(report):
    assert [
        (finding.code, finding.severity, str(finding.place), finding.place.length)
        for finding in of_report(report)
    ] == [
        ("DIF201", "error", "new/demo.yaml:14:77", 9),
        ("DIF901", "warning", "acc.yaml:4:12", 6),
        ("DIF201", "error", "src.c:1:15", 10),
    ]


def test_json_has_all_changes_with_reasons_names_and_uses(report):
    document = json.loads(reports.get("json")(report))
    first, second = document["changes"]
    generated = first.pop("generated")
    assert first == {
        "code": "DIF103",
        "layer": "wire",
        "severity": "error",
        "addition": False,
        "breaking": True,
        "message": "the telecommand id of `Set Roll` is 21, was 20",
        "where": {"node": "demo", "message": "Set Roll"},
        "was": "20",
        "now": "21",
        "old": {"file": "old/demo.yaml", "line": 17, "column": 9, "length": 2},
        "new": {"file": "new/demo.yaml", "line": 17, "column": 9, "length": 2},
        "details": [],
        "sure": 1.0,
        "errata": [],
        "accepted": "Agreed in review 7.",
    }
    assert [*generated] == ["c", "python", "rust"]
    assert generated["python"] == ["SetRoll"]
    assert "DEMO_SET_ROLL_ID" in generated["c"]
    assert "accepted" not in second
    assert document["stale"] == [
        {
            "code": "DIF106",
            "node": "demo",
            "message": "Gone",
            "reason": "Old.",
            "place": {"file": "acc.yaml", "line": 4, "column": 12, "length": 6},
        }
    ]
    assert document["uses"] == [
        {
            "file": "src.c",
            "line": 1,
            "column": 15,
            "name": "roll_angle",
            "text": SOURCE,
            "changes": [1],
        }
    ]
    assert [
        (each["key"], each["verdict"], each["frames_total"], len(each["frames"]))
        for each in document["compatibility"]
    ] == [
        ("telemetry", "partly", 1, 1),
        ("telecommands", "no", 1, 1),
        ("logs", "partly", 1, 1),
    ]
    assert document["compatibility"][1]["frames"] == [
        {
            "node": "demo",
            "message": "Set Roll",
            "id": 20,
            "verdict": "no",
            "reasons": ["its id is 21 now"],
        }
    ]


def test_the_message_of_several_uses_is_shown_once(report):
    (use,) = report.uses
    changes = report.comparison.changes
    twice = replace(report, uses=[use, use._replace(changes=tuple(changes[::-1]))])
    text = reports.get("text")(twice)
    assert text.count("  src.c:1:15: roll_angle (DIF") == 2
    assert text.count(f"      {changes[1].message}\n") == 1
    document = json.loads(reports.get("json")(twice))
    assert [each["changes"] for each in document["uses"]] == [[1], [0, 1]]


def test_sarif_suppresses_accepted_changes(report):
    (run,) = json.loads(reports.get("sarif")(report))["runs"]
    results = run["results"]
    assert [
        (result["ruleId"], result["level"], result.get("suppressions"))
        for result in results
    ] == [
        ("DIF201", "error", None),
        ("DIF901", "warning", None),
        ("DIF201", "error", None),
        (
            "DIF103",
            "error",
            [
                {
                    "kind": "external",
                    "status": "accepted",
                    "justification": "Agreed in review 7.",
                }
            ],
        ),
    ]
    assert [result.get("properties") for result in results] == [
        {"layer": "meaning", "addition": False, "sure": 1.0},
        None,
        None,
        {"layer": "wire", "addition": False, "sure": 1.0},
    ]
    assert [len(result.get("relatedLocations", ())) for result in results] == [
        1,
        0,
        0,
        1,
    ]
    (related,) = results[0]["relatedLocations"]
    assert (related["id"], related["message"]) == (1, {"text": "as it was"})
    region = related["physicalLocation"]["region"]
    assert region == {"startLine": 14, "startColumn": 77, "endColumn": 85}
    rules = run["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == ["DIF103", "DIF201", "DIF901"]
    assert rules[2] == {
        "id": "DIF901",
        "shortDescription": {"text": "an accepted change that does not happen"},
    }


def test_changes_are_grouped_by_their_message(report):
    changes = report.comparison.changes
    both = groups([changes[1], changes[0], changes[1]])
    assert [
        (group.title, group.about, group.node, len(group.changes), group.layers)
        for group in both
    ] == [
        ("Estimated Roll", "telemetry 146", "demo", 2, ["meaning"]),
        ("Set Roll", "telecommand 21", "demo", 1, ["wire"]),
    ]
