"""Inputs of the diff: files, folders, git revisions, the output of `icdgen show`. Order
and spelling of an ICD make no difference.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys

import pytest

from icdgen.diagnostics import Findings
from icdgen.diff.compare import compare
from icdgen.diff.inputs import shown
from icdgen.errors import UserError
from icdgen.loading import load
from icdgen.show import machine
from tests.conformance.icds import icd_of
from tests.conftest import DEMO, ROOT
from tests.diff.conftest import LATER
from tests.icd.files import loaded, status


@pytest.fixture
def repository(tmp_path):
    """Create a repository with the tags v1 and v2, and a working tree with another
    unit.
    """

    def git(*words: str) -> None:
        identity = (
            "-c",
            "user.name=A",
            "-c",
            "user.email=a@example.org",
            "-c",
            "commit.gpgsign=false",
        )
        subprocess.run(
            ["git", *identity, *words], cwd=tmp_path, check=True, capture_output=True
        )

    git("init", "-q", "-b", "main")
    (tmp_path / "icd" / "errata").mkdir(parents=True)
    for tag, text in (("v1", DEMO), ("v2", LATER)):
        (tmp_path / "icd" / "demo.yaml").write_text(text)
        git("add", "-A")
        git("commit", "-q", "-m", tag)
        git("tag", tag)
    (tmp_path / "icd" / "demo.yaml").write_text(LATER.replace("unit: deg", "unit: rad"))
    return tmp_path


def codes(out: str) -> set[str]:
    return {change["code"] for change in json.loads(out)["changes"]}


class TestGit:
    @pytest.mark.parametrize(
        "arguments",
        [
            ("v1..v2",),
            ("v1..v2", "icd"),
            ("v1..v2", "icd/demo.yaml"),
            ("v1...v2", "icd"),
            ("v1..", "icd"),
            ("v1:icd", "v2:icd"),
            ("v1:icd/demo.yaml", "v2:icd/demo.yaml"),
            ("HEAD~1:icd", "HEAD:icd"),
            ("v1:./icd/demo.yaml", "v2:icd/demo.yaml"),
        ],
    )
    def test_two_revisions_can_be_compared(self, icdgen, repository, arguments):
        result = icdgen("diff", *arguments, "--format", "json")
        assert (result.status, result.err) == (0, "")
        assert codes(result.out) == {"DIF201", "DIF103"}

    def test_a_revision_can_be_compared_with_the_working_tree(self, icdgen, repository):
        for arguments in (
            ("v2", "icd"),
            ("v2:icd/demo.yaml",),
            ("v2:icd/demo.yaml", "icd/demo.yaml"),
        ):
            assert codes(icdgen("diff", *arguments, "--format", "json").out) == {
                "DIF202",
                "DIF308",
            }

    def test_the_folder_icd_is_the_default(self, icdgen, repository):
        assert codes(icdgen("diff", "v2", "--format", "json").out) == {
            "DIF202",
            "DIF308",
        }
        (repository / "icd").rename(repository / "elsewhere")
        result = icdgen("diff", "v1..v2")
        assert result.status == 2 and "`icds` in icdgen.toml" in result.err

    def test_the_icds_of_icdgen_toml_are_the_default(self, icdgen, repository):
        (repository / "icdgen.toml").write_text('icds = ["icd"]\n')
        assert codes(icdgen("diff", "v1..v2", "--format", "json").out) == {
            "DIF201",
            "DIF103",
        }
        assert codes(icdgen("diff", "v2", "--format", "json").out) == {
            "DIF202",
            "DIF308",
        }
        assert codes(icdgen("diff", "v1", "v2", "--format", "json").out) == {
            "DIF201",
            "DIF103",
        }

    def test_places_refer_to_the_revision(self, icdgen, repository):
        out = icdgen("diff", "v1..v2", "icd").out
        assert "v1:icd/demo.yaml:14:77 -> v2:icd/demo.yaml:14:77" in out
        assert "/tmp" not in out

    def test_findings_refer_to_the_revision(self, icdgen, repository):
        (repository / "icd" / "demo.yaml").write_text(
            DEMO.replace("length: 3", "length: 2")
        )
        subprocess.run(
            [
                "git",
                "-c",
                "user.name=A",
                "-c",
                "user.email=a@b",
                "commit",
                "-qam",
                "bad",
            ],
            cwd=repository,
            check=True,
        )
        result = icdgen("diff", "HEAD~1..HEAD", "icd")
        assert result.status == 2
        assert "HEAD:icd/demo.yaml:" in result.err and "bits: 4" in result.err

    def test_includes_and_overlays_of_a_revision_are_read_with_it(
        self, icdgen, repository
    ):
        overlay = "errata: 1\nnode: demo\nentries:\n  - {id: D-001, title: T, where: {section: node}, printed: {title: Demo},"
        overlay += (
            " held: {title: Other}, why: W., evidence: E., confidence: certain}\n"
        )
        (repository / "icd" / "errata" / "demo.yaml").write_text(overlay)
        (repository / "icd" / "demo.yaml").write_text(LATER)
        git = ["git", "-c", "user.name=A", "-c", "user.email=a@b"]
        subprocess.run([*git, "add", "-A"], cwd=repository, check=True)
        subprocess.run([*git, "commit", "-qm", "overlay"], cwd=repository, check=True)
        result = icdgen(
            "diff", "v2:icd/demo.yaml", "HEAD:icd/demo.yaml", "--format", "json"
        )
        assert codes(result.out) == {"DIF401", "DIF403"}
        come = next(
            change
            for change in json.loads(result.out)["changes"]
            if change["code"] == "DIF403"
        )
        assert come["old"] is None and (come["new"]["file"], come["new"]["line"]) == (
            "HEAD:icd/errata/demo.yaml",
            4,
        )

    @pytest.mark.parametrize(
        "arguments, expected",
        [
            (("v1..v9", "icd"), "git knows no revision v9"),
            (("v9", "icd"), "there is no v9"),
            (("v1:icd/none.yaml", "icd"), "v1 has no icd/none.yaml"),
            (("v1:../x.yaml", "icd"), "must lie in the repository"),
            (("v1..v2", "/"), "is not in this git repository"),
            (("--", "-v1..v2", "icd"), "git knows no revision -v1"),
        ],
    )
    def test_a_missing_path_or_revision_is_named(
        self, icdgen, repository, arguments, expected
    ):
        result = icdgen("diff", *arguments)
        assert (
            result.status == 2
            and expected in result.err
            and "Traceback" not in result.err
        )

    def test_the_working_tree_stays_unchanged(self, icdgen, repository):
        before = {
            p: p.read_bytes()
            for p in repository.rglob("*")
            if p.is_file() and ".git" not in p.parts
        }
        icdgen("diff", "v1..v2", "icd")
        assert {
            p: p.read_bytes()
            for p in repository.rglob("*")
            if p.is_file() and ".git" not in p.parts
        } == before

    def test_without_git_files_can_still_be_compared(
        self, icdgen, releases, monkeypatch
    ):
        monkeypatch.setenv("PATH", "/nowhere")
        assert icdgen("diff", "old", "new").status == 0
        assert "there is no v1" in icdgen("diff", "v1", "new").err


class TestShown:
    def test_the_shipped_icds_are_the_same_when_shown(self, icdgen, tmp_path):
        (tmp_path / "shown.json").write_text(icdgen("show", "--format", "json").out)
        side = shown.from_file(tmp_path / "shown.json")
        assert compare(icd_of(), side.icd).changes == []
        assert compare(side.icd, icd_of()).changes == []

    def test_the_responses_to_telecommands_are_the_same_when_shown(
        self, icdgen, tmp_path
    ):
        wheel = ROOT / "examples" / "links" / "wheel.yaml"
        text = icdgen("show", "--format", "json", "--icd", wheel).out
        file = tmp_path / "shown.json"
        file.write_text(text)
        assert compare(icd_of([wheel]), shown.from_file(file).icd).changes == []
        file.write_text(text.replace('"repeat": true', '"hazard": "Moves."'))
        changes = compare(icd_of([wheel]), shown.from_file(file).icd).changes
        assert {change.code for change in changes} == {"DIF217", "DIF401"}

    @pytest.mark.parametrize(
        "folder",
        ["tests/conformance/odd_icds", "tests/conformance/links", "examples/links"],
    )
    def test_each_key_of_the_format_is_the_same_when_shown(self, folder):
        for file in sorted((ROOT / folder).glob("*.yaml")):
            icd = load([file], check=False).icd
            text = json.dumps(machine.to_json(icd))
            again = shown.from_bytes(text.encode(), "shown.json").icd
            assert compare(icd, again).changes == [], file.name
            assert [node.protocol for node in icd.nodes] == [
                node.protocol for node in again.nodes
            ]

    def test_notes_aliases_and_displays_are_the_same_when_shown(
        self, tmp_path, monkeypatch
    ):
        text = status(
            "at: 0, bits: 8, name: Level, type: uint, aliases: [Fill], display: hex",
            "at: 8, bits: 8, name: Rate, type: uint, unit: m, formula: raw*0.5",
        )
        note = "{id: D-1, title: T, where: {message: Status}, what: W., evidence: E.}"
        text += f"# errata/demo.yaml\nerrata: 1\nnode: demo\nnotes:\n  - {note}\n"
        icd = loaded(tmp_path, text).icd
        data = json.dumps(machine.to_json(icd)).encode()
        monkeypatch.setattr(shown, "_MOST", len(data))
        again = shown.from_bytes(data, "shown.json").icd
        assert compare(icd, again).changes == []
        (message,) = again.nodes[0].messages
        assert [(e.id, e.is_note) for e in message.errata] == [("D-1", True)]
        assert message.layout.fixed[0].aliases == ("Fill",)
        monkeypatch.setattr(shown, "_MOST", len(data) - 1)
        with pytest.raises(UserError, match=r"has more than the [0-9,]+ bytes allowed"):
            shown.from_bytes(data, "shown.json")
        monkeypatch.undo()
        zero = data.replace(b'"scale": "0.5"', b'"scale": "0"')
        zero = zero.replace(b'"scale": "1/2"', b'"scale": "0"')
        assert zero != data and shown._MOST == 64_000_000
        with pytest.raises(Findings) as error:
            shown.from_bytes(zero, "shown.json")
        (finding,) = error.value.findings
        assert (finding.code, finding.message) == ("ICD010", "`scale` cannot be 0")

    def test_places_refer_to_the_output_of_show(self, icdgen, releases, tmp_path):
        (tmp_path / "old.json").write_text(
            icdgen("show", "--icd", "old", "--format", "json").out
        )
        out = icdgen("diff", "old.json", "new").out
        place = (
            next(line for line in out.splitlines() if "-> new/demo.yaml:14:77" in line)
            .split(" -> ")[0]
            .strip()
        )
        file, line, _ = place.split(":")
        assert (
            file == "old.json"
            and '"formula": "raw*0.01"'
            in (tmp_path / file).read_text().splitlines()[int(line) - 1]
        )

    def test_the_output_of_show_may_come_from_standard_input(
        self, icdgen, releases, monkeypatch
    ):
        data = icdgen("show", "--icd", "old", "--format", "json").out.encode()
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))
        assert codes(icdgen("diff", "-", "new", "--format", "json").out) == {
            "DIF201",
            "DIF103",
        }

    def test_names_beyond_the_basic_plane_survive(self, icdgen, releases, tmp_path):
        text = DEMO.replace("title: Demo", "title: Demo \U0001f6f0")
        (releases[0] / "demo.yaml").write_text(text, encoding="utf-8")
        (tmp_path / "old.json").write_text(
            icdgen("show", "--icd", "old", "--format", "json").out
        )
        assert icdgen("diff", "old.json", "old").out == "old.json -> old\nno change\n"

    @pytest.mark.parametrize(
        "text, expected",
        [
            ("{", "not JSON"),
            ('{"format": 1}', "`nodes`"),
            ('{"format": 2, "nodes": [], "loggable": []}', "`format`"),
            ('{"format": 1, "loggable": [], "nodes": [7]}', "nodes.0"),
            ("{" * 100_000, "JSON"),
        ],
    )
    def test_other_json_is_a_finding(self, icdgen, releases, tmp_path, text, expected):
        (tmp_path / "bad.json").write_text(text)
        result = icdgen("diff", "bad.json", "new")
        assert (
            result.status == 2
            and "bad.json:1:" in result.err
            and "show --format json" in result.err
        )
        assert expected.strip("`") in result.err


class TestNoChange:
    @pytest.mark.parametrize(
        "old, new",
        [
            ("formula: raw*0.01", "formula: raw/100.0"),
            ("formula: raw*0.01", "formula: raw = value*100"),
            ("formula: raw*0.01", "formula: 0.010 * raw + 0"),
            ("{at: 0,  bits: 16", "{bits: 16, at: 0x0"),
            ("icdgen: 1\n", "# a comment\nicdgen: 1\n\n"),
            ("name: Demo,", 'name: "Demo",'),
        ],
    )
    def test_spelling_and_comments_are_no_change(self, icdgen, releases, old, new):
        (releases[1] / "demo.yaml").write_text(DEMO.replace(old, new))
        assert icdgen("diff", "old", "new").out == "old -> new\nno change\n"

    def test_the_order_of_declarations_is_no_change(self, icdgen, releases):
        head, first, second = (
            DEMO.split("  - name: Estimated")[0],
            *DEMO.split("messages:\n")[1].split("  - name: Set Roll"),
        )
        turned = f"{head}  - name: Set Roll{second}{first}"
        lines = turned.splitlines(keepends=True)
        at = next(i for i, line in enumerate(lines) if "name: Idle" in line)
        lines[at], lines[at + 1] = lines[at + 1], lines[at]
        (releases[1] / "demo.yaml").write_text("".join(lines))
        assert icdgen("diff", "old", "new").out == "old -> new\nno change\n"

    def test_offsets_counted_from_the_other_end_of_the_byte_are_no_change(
        self, icdgen, releases
    ):
        turned = DEMO.replace("bit_order: lsb0", "bit_order: msb0").replace(
            "{at: 16, bits: 4, ", "{at: 20, bits: 4, "
        )
        (releases[1] / "demo.yaml").write_text(turned)
        result = json.loads(icdgen("diff", "old", "new", "--format", "json").out)
        assert [change["code"] for change in result["changes"]] == ["DIF411"]
