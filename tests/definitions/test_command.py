"""``icdgen import`` of a definition as a user runs it."""

from __future__ import annotations

import json
import re
import shutil

import pytest

from tests.definitions.test_can import FILES
from tests.importer.test_command import icdgen


@pytest.fixture
def folder(tmp_path):
    shutil.copy(FILES / "train.dbc", tmp_path)
    return tmp_path


def test_written_files_are_formatted_and_pass_the_check(folder):
    result = icdgen("import", "train.dbc", cwd=folder)
    assert result.returncode == 0, result.stdout + result.stderr
    assert (
        "train.dbc: a CAN database (DBC), 3 of 3 messages imported\n" in result.stdout
    )
    assert (
        "2 names that are not valid identifiers got one:\n  value `2nd gear`: `value 2nd gear`\n"
        in result.stdout
    )
    assert result.stdout.endswith("`icdgen check icd/train.yaml`: no findings\n")
    assert icdgen("fmt", "--check", "icd", cwd=folder).returncode == 0


def test_update_keeps_identifiers_summaries_and_comments_and_takes_limits(folder):
    icdgen("import", "train.dbc", cwd=folder)
    path, source = folder / "icd" / "train.yaml", folder / "train.dbc"
    ours = path.read_text().replace(
        "identifier: class field", "identifier: train class"
    )
    path.write_text(
        ours.replace("    kind: telemetry\n", "    kind: telemetry  # ours\n", 1)
    )
    source.write_text(
        source.read_text()
        .replace("[0|300]", "[0|250]")
        .replace("BO_ 257 Heartbeat", "BO_ 258 Alive")
    )
    assert icdgen("import", "train.dbc", cwd=folder).returncode == 2
    result = icdgen("import", "train.dbc", "--update", cwd=folder)
    assert result.returncode == 0, result.stdout + result.stderr
    assert (
        "~ message `DriveStatus` (256): field `Speed`: max `300` -> `250`"
        in result.stdout
    )
    assert (
        "+ message `Alive` (258)" in result.stdout
        and "- message `Heartbeat` (257)" in result.stdout
    )
    assert (
        "identifier: train class" in path.read_text() and "# ours" in path.read_text()
    )


def test_missing_messages_are_in_the_json_report_and_the_exit_status(folder):
    shutil.copy(FILES / "faulty.dbc", folder)
    result = icdgen(
        "import",
        "faulty.dbc",
        "--format",
        "json",
        "--kind",
        "dbc",
        "--dry-run",
        cwd=folder,
    )
    assert result.returncode == 1
    report = json.loads(result.stdout)
    assert (report["messages"], report["held"]) == (4, 4) and not (
        folder / "icd"
    ).exists()
    assert {"IMP091", "IMP075"} <= {finding["code"] for finding in report["findings"]}


def test_an_unknown_kind_and_a_broken_file_give_no_traceback(folder):
    result = icdgen("import", "train.dbc", "--kind", "dbx", cwd=folder)
    assert (
        result.returncode == 2
        and "there is no kind of definition `dbx`" in result.stderr
    )
    (folder / "bad.dbc").write_text("BU_: A\nBO_ 1 x")
    result = icdgen("import", "bad.dbc", cwd=folder)
    assert (
        result.returncode == 1
        and "bad.dbc" in result.stderr
        and "error[IMP005]" in result.stderr
    )
    assert not (folder / "icd").exists()


def test_log_output_of_the_library_is_not_printed(tmp_path):
    message = 'BO_ {} Twice: 1 Node\n SG_ Level : 0|8@1+ (1,0) [0|0] "" Node\n\n'
    (tmp_path / "twice.dbc").write_text(
        'VERSION ""\n\nBU_: Node\n\n' + message.format(1) + message.format(2)
    )
    result = icdgen("import", "twice.dbc", "--dry-run", cwd=tmp_path)
    assert "Overwriting" not in result.stderr + result.stdout
    assert "2 messages with 2 fields" in result.stdout


def test_the_help_lists_all_kinds_of_definitions(folder):
    from icdgen.definitions import kinds

    words = re.findall(r"[a-z0-9]+", icdgen("import", "--help", cwd=folder).stdout)
    assert set(kinds._BUILT_IN) <= set(words)
