"""``icdgen import`` as a user runs it."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import profile
from tests.importer.conftest import RULES
from tests.importer.test_text import ENUM, LIST, LISTED, MESSAGE, PUMP, RAW

TEXT = LIST.replace("\t6\n", "\t4\n").rsplit("141", 1)[0] + "\n" + MESSAGE + ENUM


def icdgen(*arguments, cwd) -> subprocess.CompletedProcess:
    """Run icdgen. An import of `pump.txt` gets the rules of the pump unless another
    profile is given.
    """
    rules = (
        ["--profile", "pump.yaml"]
        if "pump.txt" in arguments and "--profile" not in arguments
        else []
    )
    if rules:
        listed = (
            LISTED
            if "List of" in (cwd / "pump.txt").read_text(encoding="utf-8")
            else ""
        )
        profile = PUMP.read_text(encoding="utf-8").replace(
            "phrases:", f"{listed}phrases:"
        )
        (cwd / "pump.yaml").write_text(profile, encoding="utf-8")
    command = [sys.executable, "-m", "icdgen", *map(str, [*arguments, *rules])]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True)


def test_without_a_profile_nothing_becomes_a_message(folder):
    command = [sys.executable, "-m", "icdgen", "import", "pump.txt"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert result.returncode == 1 and not (folder / "icd").exists()
    assert "error[IMP004]: no rule gives a message" in result.stdout
    assert (
        "= help: write rules in a profile (--profile): --explore proposes them, --workbench serves a page"
        in result.stdout
    )
    assert result.stdout.count("warning[IMP100]: no rule applies to table") == 3


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "pump.txt").write_text(TEXT, encoding="utf-8")
    return tmp_path


def test_an_import_gives_an_icd_that_checks_formats_and_compiles(folder):
    result = icdgen("import", "pump.txt", cwd=folder)
    assert result.returncode == 0, result.stdout + result.stderr
    assert (
        "icd/pump.yaml: written; 1 message with 3 fields, 1 enumeration with 2 members"
        in result.stdout
    )
    assert result.stderr == ""
    assert icdgen("fmt", "--check", "icd", cwd=folder).returncode == 0
    assert icdgen("check", "icd", cwd=folder).stdout == "no findings\n"
    assert icdgen("--lang", "c", "--out", "include", "icd", cwd=folder).returncode == 0


def test_an_existing_icd_is_only_overwritten_with_an_option(folder):
    icdgen("import", "pump.txt", cwd=folder)
    before = (folder / "icd" / "pump.yaml").read_bytes()
    result = icdgen("import", "pump.txt", cwd=folder)
    assert result.returncode == 2
    assert "--update" in result.stderr
    assert (folder / "icd" / "pump.yaml").read_bytes() == before


def test_update_keeps_manual_edits_and_lists_the_changes(folder):
    icdgen("import", "pump.txt", cwd=folder)
    path = folder / "icd" / "pump.yaml"
    ours = path.read_text(encoding="utf-8")
    ours = ours.replace(
        "name: Pressure,",
        "name: Pressure, identifier: Tank Pressure, summary: Of the tank.,",
    )
    ours = ours.replace(
        "    length: 4\n",
        "    length: 4\n    summary: Ours.\n    # A comment of ours.\n",
        1,
    )
    ours = ours.replace(
        "    summary: Ours.\n",
        "    summary: Ours.\n    assumptions: {length: Not printed. It follows from the fields.}\n",
        1,
    )
    path.write_text(ours, encoding="utf-8")
    icdgen("fmt", "icd", cwd=folder)
    ours = path.read_text(encoding="utf-8")
    (folder / "icd" / "errata").mkdir()
    overlay = folder / "icd" / "errata" / "pump.yaml"
    overlay.write_text("errata: 1\nnode: pump\nentries: []\n", encoding="utf-8")
    second = icdgen("import", "pump.txt", "--update", cwd=folder)
    assert "icd/pump.yaml: unchanged" in second.stdout
    assert path.read_text(encoding="utf-8") == ours

    new = TEXT.replace("RAWVAL*0.1", "RAWVAL*0.2").replace(
        "1\tRunning\tRunning", "1\tRunning\tRunning\n2\tFailed\tFailed"
    )
    (folder / "pump.txt").write_text(
        new.replace("Valve Open", "Valve State"), encoding="utf-8"
    )
    result = icdgen("import", "pump.txt", "--update", cwd=folder)
    assert (
        "~ message `Pump State` (140): field `Pressure`: formula `raw*0.1` -> `raw*0.2`"
        in result.stdout
    )
    assert "+ enumeration `PumpMode`: member 2 `Failed`" in result.stdout
    assert "field `Valve State`: name `Valve Open` -> `Valve State`" in result.stdout
    text = path.read_text(encoding="utf-8")
    assert text == ours.replace("raw*0.1", "raw*0.2").replace(
        "Valve Open", "Valve State"
    ).replace(
        "{value: 1, name: Running}",
        "{value: 1, name: Running}\n      - {value: 2, name: Failed}",
    ).replace(
        "name: Valve State,                          ",
        "name: Valve State,                         ",
    ) or (
        "identifier: Tank Pressure" in text
        and "# A comment of ours." in text
        and "summary: Ours." in text
    )
    assert overlay.read_text(encoding="utf-8") == "errata: 1\nnode: pump\nentries: []\n"
    assert icdgen("fmt", "--check", "icd/pump.yaml", cwd=folder).returncode == 0


def test_update_adopts_statements_about_all_formulas(folder):
    icdgen("import", "pump.txt", cwd=folder)
    path = folder / "icd" / "pump.yaml"
    (folder / "pump.txt").write_text(TEXT.replace(MESSAGE, RAW), encoding="utf-8")
    result = icdgen("import", "pump.txt", "--update", cwd=folder)
    assert "~ formula_for (absent) -> {'telemetry': 'raw'}" in result.stdout
    assert "formula_for: {telemetry: raw}\n" in path.read_text(encoding="utf-8")
    assert (
        "icd/pump.yaml: unchanged"
        in icdgen("import", "pump.txt", "--update", cwd=folder).stdout
    )
    assert icdgen("fmt", "--check", "icd/pump.yaml", cwd=folder).returncode == 0
    (folder / "pump.txt").write_text(TEXT, encoding="utf-8")
    icdgen("import", "pump.txt", "--update", cwd=folder)
    assert "formula_for" not in path.read_text(encoding="utf-8")


def test_a_dry_run_writes_nothing(folder):
    result = icdgen("import", "pump.txt", "--dry-run", cwd=folder)
    assert "would be written" in result.stdout
    assert not (folder / "icd").exists()


def test_a_dry_run_lists_the_changes_to_an_existing_icd(folder):
    icdgen("import", "pump.txt", cwd=folder)
    path = folder / "icd" / "pump.yaml"
    assert (
        "pump.yaml: unchanged"
        in icdgen("import", "pump.txt", "--dry-run", cwd=folder).stdout
    )
    changed = path.read_text(encoding="utf-8").replace("bits: 16", "bits: 15", 1)
    path.write_text(changed, encoding="utf-8")
    result = icdgen("import", "pump.txt", "--dry-run", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    assert "pump.yaml: would be updated with --update; " in result.stdout
    assert "bits `15` -> `16`" in result.stdout
    result = icdgen("import", "pump.txt", "--dry-run", "--update", cwd=folder)
    assert "pump.yaml: would be updated; " in result.stdout
    assert path.read_text(encoding="utf-8") == changed


def test_findings_as_json(folder):
    result = icdgen("import", "pump.txt", "--format", "json", "--dry-run", cwd=folder)
    data = json.loads(result.stdout)
    assert [t["is"] for t in data["tables"]] == ["list", "message", "enumeration"]
    assert {"code", "severity", "message", "help", "table", "page", "line"} == set(
        data["findings"][0]
    )


def test_a_profile_that_is_wrong_is_a_finding_with_its_line(folder):
    (folder / "words.yaml").write_text(
        "profile: 1\nrules:\n  - {tablez: {}}\ntypes:\n  WORD: {type: word}\n",
        encoding="utf-8",
    )
    result = icdgen("import", "pump.txt", "--profile", "words.yaml", cwd=folder)
    assert result.returncode == 1
    assert "words.yaml:3:6: error[IMP001]: unknown key `tablez`" in result.stderr
    assert "words.yaml:5:" in result.stderr
    assert not (folder / "icd").exists()


@pytest.mark.parametrize(
    "line, expected",
    [
        ("captions: [1]", "this entry of `captions` must be text, not the number 1"),
        ("phrases: {unit: a}", "`unit` must be a list, not the text 'a'"),
        (
            "types: {WORD: 3}",
            "`X`: a mapping such as `{type: uint, bits: 16}`".replace("X", "WORD"),
        ),
        ("nodes: [{match: [a]}]", "`name` is missing from this entry of `nodes`"),
        (
            "nodes: [{name: a, tables: [1]}]",
            "`tables`: the first and the last table number: `[57, 68]`",
        ),
        (
            "damage: [{table: 97}]",
            "add `before:`, the number in the row below the heading",
        ),
        (
            "damage: [{}]",
            "`{printed: ..., meant: ...}` or `{table: 97, before: 171, group: ...}`",
        ),
        ("shares: [Common]", "did you mean `shared`?"),
    ],
)
def test_each_mistake_in_a_profile_has_a_remedy(tmp_path, line, expected):
    path = tmp_path / "words.yaml"
    path.write_text(f"profile: 1\n{line}\nrules: []\n", encoding="utf-8")
    with pytest.raises(Findings) as caught:
        profile.load(path)
    assert {(f.code, f.place.line) for f in caught.value.findings} == {("IMP001", 2)}
    assert any(expected in f"{f.message}: {f.help}" for f in caught.value.findings)


def test_a_profile_without_rules_is_an_error_with_a_remedy(folder):
    (folder / "words.yaml").write_text(
        "profile: 1\nheadings: {fields: {name: [Signal]}}\n", encoding="utf-8"
    )
    for option in ([], ["--workbench"], ["--explain", "1"]):
        result = icdgen(
            "import", "pump.txt", "--profile", "words.yaml", *option, cwd=folder
        )
        assert result.returncode == 1 and not (folder / "icd").exists()
        assert (
            "words.yaml:1:1: error[IMP001]: the profile has no `rules:`"
            in result.stderr
        )
        assert "--explore" in result.stderr and "--workbench" in result.stderr


def test_a_missing_profile_is_reported_with_the_available_ones(folder):
    result = icdgen("import", "pump.txt", "--profile", "nobody", cwd=folder)
    assert result.returncode == 2
    assert "addendum, cubeadcs" in result.stderr


@pytest.mark.parametrize("option", [[], ["--dry-run"], ["--format", "json"]])
def test_an_import_whose_result_has_errors_ends_with_1(folder, option):
    wide = MESSAGE.replace("\t4\n", "\t3\n", 1)
    # A field lies beyond the message.
    (folder / "pump.txt").write_text(wide + ENUM, encoding="utf-8")
    result = icdgen("import", "pump.txt", *option, cwd=folder)
    assert result.returncode == 1, result.stdout
    if "json" in option:
        assert {
            finding["severity"] for finding in json.loads(result.stdout)["check"]
        } == {"error"}
    else:
        # The manual was read; only the resulting ICD has errors.
        assert "error[" not in result.stdout
        assert "`icdgen check icd/pump.yaml`" in result.stdout.splitlines()[-1]
        assert "1 error" in result.stdout.splitlines()[-1]
    assert (folder / "icd").exists() == ("--dry-run" not in option)


def test_a_definition_whose_result_has_errors_ends_with_1(folder):
    (folder / "fan.dbc").write_text(
        'VERSION ""\n\nBU_: ECU\n\nBO_ 100 Fan: 8 ECU\n SG_ Speed : 0|8@1+ (1,0) [0|255] "" ECU\n',
        encoding="utf-8",
    )
    assert icdgen("import", "fan.dbc", "--dry-run", cwd=folder).returncode == 0
    (folder / "icd" / "errata").mkdir(parents=True)
    (folder / "icd" / "errata" / "fan.yaml").write_text(
        "errata: 1\nnode: engine\nentries: []\n", encoding="utf-8"
    )
    result = icdgen("import", "fan.dbc", "--dry-run", cwd=folder)
    assert result.returncode == 1
    assert "`icdgen check icd/fan.yaml` would have 1 error" in result.stdout


def test_an_incomplete_manual_ends_with_1_and_the_icd_is_written(folder):
    (folder / "pump.txt").write_text(
        TEXT.replace("\t16\t8", "\tl6\t8"), encoding="utf-8"
    )
    result = icdgen("import", "pump.txt", cwd=folder)
    assert result.returncode == 1
    assert "error[IMP023]: table 2 (`Pump State Telemetry Format`)" in result.stdout
    assert "--> pump.txt:" in result.stdout
    assert (folder / "icd" / "pump.yaml").is_file()


def test_nothing_is_written_if_one_of_several_files_exists(folder):
    two = TEXT.replace("List of Telemetry", "List of Pump Telemetry")
    two += (
        two.replace("Pump", "Tank")
        .replace("\n140", "\n150")
        .replace("ID\t140", "ID\t150")
    )
    (folder / "pump.txt").write_text(two, encoding="utf-8")
    (folder / "icd").mkdir()
    (folder / "icd" / "tank.yaml").write_text("", encoding="utf-8")
    assert icdgen("import", "pump.txt", cwd=folder).returncode == 2
    assert [p.name for p in (folder / "icd").iterdir()] == ["tank.yaml"]


def test_the_page_shows_each_doubtful_table_as_a_picture(tmp_path):
    from tests.importer.manuals import content
    from tests.importer.manuals.layouts import LAYOUTS

    manual = content.manual(content.shipped("common"), {"common": "Common"})
    LAYOUTS["ruled"](manual, tmp_path / "manual.pdf")
    # The fields have no type.
    rules = RULES.read_text(encoding="utf-8").replace(
        "Data Type: type", "Data Type: text"
    )
    (tmp_path / "rules.yaml").write_text(rules, encoding="utf-8")
    result = icdgen(
        "import",
        "manual.pdf",
        "--report",
        "report.html",
        "--profile",
        "rules.yaml",
        cwd=tmp_path,
    )
    assert (result.returncode, result.stderr) == (1, "")
    assert "IMP026" in result.stdout
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert 'id="table-' in page
    assert "data:image/png;base64," in page
    assert "http" not in page.replace("http-equiv", "")
