"""``icdgen diff`` as a command: exit status, formats and misuse."""

from __future__ import annotations

import json
import os
import pty
import re
import subprocess
import sys

import pytest

from tests.conftest import DEMO
from tests.diff.conftest import LATER

FORMATS = ["text", "markdown", "json", "sarif", "github", "html"]


class TestExitStatus:
    def test_without_fail_on_it_is_0_whatever_changed(self, icdgen, releases):
        assert icdgen("diff", "old", "new").status == 0

    @pytest.mark.parametrize(
        "layers, status",
        [
            ("wire", 1),
            ("meaning", 1),
            ("source", 0),
            ("text", 0),
            ("source,text", 0),
            ("text, wire", 1),
            ("additions", 0),
        ],
    )
    def test_fail_on_counts_only_its_layers(self, icdgen, releases, layers, status):
        assert icdgen("diff", "old", "new", "--fail-on", layers).status == status

    def test_fail_on_may_be_repeated(self, icdgen, releases):
        assert (
            icdgen(
                "diff", "old", "new", "--fail-on", "text", "--fail-on", "wire"
            ).status
            == 1
        )

    def test_an_addition_counts_only_if_asked_for(self, icdgen, releases):
        more = "  - name: More\n    id: 150\n    kind: telemetry\n    length: 0\n"
        (releases[1] / "demo.yaml").write_text(DEMO + more)
        assert (
            icdgen("diff", "old", "new", "--fail-on", "wire,meaning,source,text").status
            == 0
        )
        assert icdgen("diff", "old", "new", "--fail-on", "additions").status == 1
        assert icdgen("diff", "old", "new", "--fail-on", "wire,additions").status == 1

    def test_text_changes_fail_only_if_requested(self, icdgen, releases):
        (releases[1] / "demo.yaml").write_text(
            DEMO.replace("title: Demo", "title: A demo")
        )
        assert (
            icdgen("diff", "old", "new", "--fail-on", "wire,meaning,source").status == 0
        )
        assert icdgen("diff", "old", "new", "--fail-on", "text").status == 1

    @pytest.mark.parametrize(
        "arguments, expected",
        [
            ((), "Missing argument"),
            (("old",), "name what to compare with"),
            (("old", "nowhere"), "there is no nowhere"),
            (("old", "new", "old"), "3 arguments"),
            (
                ("old", "new", "--fail-on", "wires"),
                "'wires' is not one of wire, meaning",
            ),
            (("old", "new", "--format", "xml"), "xml"),
            (("old", "new", "--uses", "nowhere"), "there is no nowhere"),
            (("old", "new", "--accepted", "nowhere.yaml"), "cannot read the file"),
            (("old", "new", "--out", "old"), "cannot write old"),
        ],
    )
    def test_misuse_is_2_with_a_remedy(self, icdgen, releases, arguments, expected):
        result = icdgen("diff", *arguments)
        assert result.status == 2 and expected in result.err
        assert "Traceback" not in result.err


class TestBadIcds:
    def test_an_icd_with_errors_is_not_compared(self, icdgen, releases):
        (releases[1] / "demo.yaml").write_text(LATER.replace("length: 3", "length: 2"))
        result = icdgen("diff", "old", "new")
        assert (
            result.status == 2
            and "error[ICD020]" in result.err
            and "new/demo.yaml:" in result.err
        )
        assert result.out == ""

    def test_rule_violations_can_be_ignored(self, icdgen, releases):
        (releases[1] / "demo.yaml").write_text(LATER.replace("length: 3", "length: 2"))
        result = icdgen("diff", "old", "new", "--unchecked")
        assert result.status == 0 and "DIF106" in result.out

    def test_unreadable_files_cannot_be_ignored(self, icdgen, releases):
        (releases[1] / "demo.yaml").write_text(LATER.replace("bits: 4", "bits: four"))
        result = icdgen("diff", "old", "new", "--unchecked")
        assert result.status == 2 and "ICD010" in result.err

    def test_duplicate_names_do_not_crash_an_unchecked_comparison(
        self, icdgen, releases
    ):
        twice = "      - {at: 20, bits: 4, name: Roll Angle, type: uint}\n  - name: Set Roll"
        (releases[1] / "demo.yaml").write_text(
            LATER.replace("  - name: Set Roll", twice)
        )
        result = icdgen("diff", "old", "new", "--unchecked")
        assert result.status == 0 and "DIF114" in result.out

    def test_an_unknown_enumeration_does_not_crash_an_unchecked_comparison(
        self, icdgen, releases
    ):
        (releases[1] / "demo.yaml").write_text(
            LATER.replace("enum: Mode", "enum: Mood")
        )
        result = icdgen("diff", "old", "new", "--unchecked")
        assert result.status == 0 and "DIF204" in result.out


class TestOutput:
    @pytest.mark.parametrize("form", FORMATS)
    def test_every_format_contains_the_changes(self, icdgen, releases, form):
        result = icdgen("diff", "old", "new", "--format", form)
        assert result.status == 0 and result.err == ""
        assert "DIF201" in result.out and "DIF103" in result.out

    @pytest.mark.parametrize("form", FORMATS)
    def test_every_format_supports_equal_icds(self, icdgen, releases, form):
        result = icdgen("diff", "old", "old", "--format", form)
        assert result.status == 0 and "DIF" not in result.out

    def test_a_report_can_be_written_to_a_file(self, icdgen, releases, tmp_path):
        result = icdgen(
            "diff",
            "old",
            "new",
            "--format",
            "html",
            "--out",
            "pages/diff.html",
            "--fail-on",
            "wire",
        )
        assert (result.status, result.out) == (1, "")
        assert (tmp_path / "pages/diff.html").read_text().startswith("<!DOCTYPE html>")

    def test_output_is_the_same_every_time(self, icdgen, releases):
        for form in FORMATS:
            assert (
                icdgen("diff", "old", "new", "--format", form).out
                == icdgen("diff", "old", "new", "--format", form).out
            )

    def test_text_changes_are_shortened_without_all(self, icdgen, releases):
        rows = "".join(
            f"      - {{value: {n}, name: Mode {n}, summary: S}}\n"
            for n in range(2, 40)
        )
        old = DEMO.replace("messages:\n", rows + "messages:\n", 1).replace(
            "bits: 4", "bits: 8"
        )
        (releases[0] / "demo.yaml").write_text(old)
        (releases[1] / "demo.yaml").write_text(old.replace("summary: S", "summary: T"))
        short, long = (
            icdgen("diff", "old", "new").out,
            icdgen("diff", "old", "new", "--all").out,
        )
        assert "and 28 more changes of words, which --all lists" in short
        assert long.count("DIF401") == 38

    def test_hostile_names_are_escaped_in_every_format(self, icdgen, releases):
        evil = LATER.replace(
            "name: Roll Angle",
            'name: "Roll\\e[31m<script>alert(1)</script>|`x`\\u202e Angle"',
            1,
        )
        (releases[1] / "demo.yaml").write_text(evil)
        for form in FORMATS:
            out = icdgen("diff", "old", "new", "--format", form).out
            assert "\x1b" not in out and "\u202e" not in out, form
            # In Markdown a code span is plain text.
            if form in (
                "markdown",
                "html",
            ):
                assert "<script>alert" not in (
                    re.sub("`[^`]*`", "", out) if form == "markdown" else out
                )

    @pytest.mark.pty
    def test_colour_is_for_terminals(self, releases, tmp_path):
        command = [sys.executable, "-m", "icdgen", "diff", "old", "new"]
        plain = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, check=True
        )
        assert "\x1b[" not in plain.stdout
        environment = {**os.environ, "TERM": "xterm"}
        environment.pop("NO_COLOR", None)
        assert b"\x1b[1;31m" in in_terminal(command, tmp_path, environment)
        assert b"\x1b[1;31m" not in in_terminal(
            command, tmp_path, {**environment, "NO_COLOR": "1"}
        )


def in_terminal(command, folder, environment) -> bytes:
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        command, cwd=folder, stdout=theirs, stderr=theirs, env=environment
    )
    os.close(theirs)
    output = b""
    while True:
        try:
            part = os.read(ours, 65536)
        except OSError:
            break
        if not part:
            break
        output += part
    os.close(ours)
    assert process.wait() == 0
    return output


class TestRule:
    def test_rules_of_changes_are_explained_with_an_example_pair(self, icdgen):
        out = icdgen("rule", "dif201").out
        assert out.startswith("# DIF201: ") and "Before:" in out and "After:" in out

    def test_rules_of_changes_are_listed_after_those_of_icds(self, icdgen):
        lines = icdgen("rule").out.splitlines()
        assert lines == sorted(lines, key=lambda line: (line[:3] != "ICD", line))
        assert any(line.startswith("DIF101  ") for line in lines)

    def test_the_json_list_of_rules_is_valid(self, icdgen, releases):
        assert (
            json.loads(icdgen("diff", "old", "new", "--format", "json").out)["counts"][
                "meaning"
            ]
            == 1
        )
