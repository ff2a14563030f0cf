"""`icdgen import`: ranges of pages, kinds of files, refusals and the next step."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import click
import pytest

from icdgen.commands.import_ import PAGES, _next_step, _refuse
from icdgen.diagnostics import Finding, Findings, Place
from tests.limits import assert_limits

DBC = """\
VERSION ""

NS_ :

BS_:

BU_: ECU

BO_ 256 Drive: 8 ECU
 SG_ Speed : 0|16@1+ (0.1,0) [0|100] "km/h" Vector__XXX
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", (1, 1)),
        ("12", (12, 12)),
        ("20-35", (20, 35)),
        ("7-7", (7, 7)),
        ("999999", (999999, 999999)),
    ],
)
def test_pages_are_one_page_or_a_range(text, expected):
    assert PAGES.convert(text, None, None) == expected


@pytest.mark.parametrize(
    "text",
    ["0", "0-3", "3-2", "-3", "3-", "1000000", "1-1000000", "x", "", "1,2", "1 "],
)
def test_other_texts_are_no_pages(text):
    with pytest.raises(click.BadParameter) as error:
        PAGES.convert(text, None, None)
    assert str(error.value) == f"`{text}` names no pages: write 12 or 20-35"


def finding(severity: str) -> Finding:
    return Finding("ICD020", "wrong", Place("a.yaml"), "", severity)


@pytest.mark.parametrize(
    ("severities", "written", "dry"),
    [
        ([], "`icdgen check a.yaml b.yaml`: no findings", "would have no findings"),
        (
            ["warning"],
            "next: `icdgen check a.yaml b.yaml` has 1 warning",
            "would have 1 warning",
        ),
        (
            ["warning", "error", "warning"],
            "next: `icdgen check a.yaml b.yaml` has 1 error and 2 warnings",
            "would have 1 error and 2 warnings",
        ),
    ],
)
def test_the_next_step_is_to_check_the_files(severities, written, dry):
    targets = [SimpleNamespace(path=Path(name)) for name in ("a.yaml", "b.yaml")]
    checked = [finding(severity) for severity in severities]
    assert _next_step(targets, checked, False) == written
    assert _next_step(targets, checked, True) == (f"`icdgen check a.yaml b.yaml` {dry}")


def test_a_refusal_shows_lines_only_of_files_that_have_them(tmp_path, capsys):
    profile = tmp_path / "profile.yaml"
    profile.write_text("profile: 1\nwords: {}\n")
    findings = [
        Finding("IMP002", "it is no PDF", Place("manual.pdf"), "convert it"),
        Finding("IMP003", "no table", Place("manual.txt", 7)),
        Finding("ICD010", "no such key", Place(str(profile), 2, 1, 5)),
        Finding("ICD010", "gone", Place("missing.yaml", 3, 1, 5)),
    ]
    _refuse(Findings(findings), Path("manual.pdf"), "text")
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(
        "manual.pdf: error[IMP002]: it is no PDF\n"
        "  = help: convert it\n"
        "manual.txt:7: error[IMP003]: no table\n"
        f"{profile}:2:1: error[ICD010]: no such key\n"
        "  |\n"
        "2 | words: {}\n"
        "  | ^^^^^\n"
    )
    assert captured.err.endswith("\n2 errors in 2 files\n")
    _refuse(Findings(findings[:1]), Path("manual.pdf"), "text")
    assert capsys.readouterr().err == (
        "manual.pdf: error[IMP002]: it is no PDF\n  = help: convert it\n"
    )


def test_a_refusal_is_an_object_for_programs(capsys):
    found = [Finding("IMP002", "it is no PDF", Place("manual.pdf"), "convert it")]
    _refuse(Findings(found), Path("manual.pdf"), "json")
    captured = capsys.readouterr()
    assert captured.err == ""
    assert "it is no PDF" in json.dumps(json.loads(captured.out))


@pytest.fixture
def network(tmp_path):
    file = tmp_path / "network.dbc"
    file.write_text(DBC)
    return file


def test_a_definition_is_written_to_the_folder_icd_by_default(
    icdgen, network, tmp_path
):
    dry = icdgen("import", network, "--dry-run")
    assert dry.status == 0
    assert "`icdgen check icd/network.yaml` would have" in dry.out
    assert not (tmp_path / "icd").exists()
    written = icdgen("import", network)
    assert written.status == 0
    names = sorted(path.name for path in (tmp_path / "icd").iterdir())
    assert names == ["icdgen.schema.json", "network.yaml"]
    elsewhere = icdgen("import", network, "--out", "other", "--format", "json")
    assert elsewhere.status == 0 and json.loads(elsewhere.out)
    assert (tmp_path / "other" / "network.yaml").is_file()


def test_an_existing_icd_is_only_updated_on_request(icdgen, network, tmp_path):
    icdgen("import", network)
    file = tmp_path / "icd" / "network.yaml"
    file.write_text(f"{file.read_text()}# mine\n")
    text = file.read_text()
    refused = icdgen("import", network)
    assert refused.status == 2
    assert "icd/network.yaml already there" in refused.err
    assert file.read_text() == text
    assert icdgen("import", network, "--update").status == 0
    assert "# mine\n" in file.read_text()


@pytest.mark.parametrize(
    ("words", "text", "help"),
    [
        (
            ("empty",),
            "there is no definition in the folder empty",
            "import a manual, or a file that --kind names",
        ),
        (
            ("network.dbc", "notes.txt"),
            "notes.txt is not a known definition",
            "import manuals one by one",
        ),
        (("network.dbc", "gone.dbc"), "gone.dbc", ""),
        (
            ("folder", "--kind", "xtce"),
            "there is no definition of the kind xtce in the folder folder",
            "kinds are ",
        ),
    ],
)
def test_files_that_cannot_be_imported_together_are_named(
    icdgen, network, tmp_path, words, text, help
):
    (tmp_path / "empty").mkdir()
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "network.dbc").write_text(DBC)
    (tmp_path / "notes.txt").write_text("These are notes.\n")
    result = icdgen("import", *words)
    assert result.status == 2
    assert text in result.err and help in result.err
    assert not (tmp_path / "icd").exists()


def test_a_file_in_a_given_folder_is_imported_once(icdgen, network, tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "network.dbc").write_text(DBC)
    once = icdgen("import", "folder", "--format", "json", "--dry-run")
    twice = icdgen(
        "import", "folder", "folder/network.dbc", "--format", "json", "--dry-run"
    )
    assert (once.status, twice.status) == (0, 0)
    assert json.loads(once.out) == json.loads(twice.out)


def test_the_number_of_processes_is_limited(icdgen, network):
    assert_limits(
        lambda jobs: icdgen("import", network, "--jobs", jobs, "--dry-run").status == 0,
        least=1,
        most=64,
    )
