"""``icdgen --lang``: the properties that a build step relies on."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import DEMO, ROOT


def tree(folder: Path) -> dict[str, tuple[bytes, int]]:
    return {
        str(p.relative_to(folder)): (p.read_bytes(), p.stat().st_mtime_ns)
        for p in folder.rglob("*")
        if p.is_file()
    }


def test_one_language_goes_straight_into_the_folder_several_into_one_each(
    icdgen, demo, tmp_path
):
    assert icdgen("--lang", "c", "--out", "one", demo).status == 0
    assert (tmp_path / "one" / "demo.h").is_file()
    assert icdgen("--lang", "c", "--lang", "python", "--out", "two", demo).status == 0
    assert (tmp_path / "two" / "c" / "demo.h").is_file()
    assert (tmp_path / "two" / "python" / "pyproject.toml").is_file()


def test_without_out_the_folder_is_generated(icdgen, demo, tmp_path):
    assert icdgen("--lang", "c", demo).status == 0
    assert (tmp_path / "generated" / "c" / "demo.h").is_file()


def test_the_second_run_writes_no_file_and_reports_it(icdgen, demo, tmp_path):
    icdgen("--lang", "c", "--out", "out", demo)
    before = tree(tmp_path / "out")
    result = icdgen("--lang", "c", "--out", "out", demo)
    assert "are current" in result.out
    assert tree(tmp_path / "out") == before


def test_deleting_one_field_changes_only_the_files_that_mention_it(
    icdgen, demo, tmp_path
):
    icdgen("--lang", "c", "--out", "out", demo)
    before = tree(tmp_path / "out")
    line = "      - {at: 16, bits: 4,  name: Mode,       type: enum, enum: Mode}\n"
    text = DEMO.replace("length: 3", "length: 2").replace(line, "")
    start = text.index("enums:")
    demo.write_text(text[:start] + text[text.index("messages:") :])
    icdgen("--lang", "c", "--out", "out", demo)
    after = tree(tmp_path / "out")
    assert before["demo/set_roll.h"] == after["demo/set_roll.h"]
    assert before["icdgen.h"] == after["icdgen.h"]
    assert before["demo/estimated_roll.h"] != after["demo/estimated_roll.h"]


def test_an_icd_with_a_finding_generates_nothing(icdgen, demo, tmp_path):
    demo.write_text(DEMO.replace("length: 3", "length: 2"))
    result = icdgen("--lang", "c", "--out", "out", demo)
    assert result.status == 1
    assert (
        "ICD020" in result.err
        and f"{demo.relative_to(tmp_path)}:"
        in result.err.replace(str(tmp_path) + "/", "")
    )
    assert not (tmp_path / "out").exists()


def test_check_reports_whether_the_output_is_current(icdgen, demo, tmp_path):
    missing = icdgen("--lang", "c", "--out", "out", "--check", demo)
    assert missing.status == 1 and "missing" in missing.out
    assert not (tmp_path / "out").exists()
    icdgen("--lang", "c", "--out", "out", demo)
    assert icdgen("--lang", "c", "--out", "out", "--check", demo).status == 0
    header = tmp_path / "out" / "demo.h"
    header.write_text(header.read_text() + "/* mine */\n")
    changed = icdgen("--lang", "c", "--out", "out", "--check", demo)
    assert changed.status == 1 and "-/* mine */" in changed.out
    assert header.read_text().endswith("/* mine */\n")


def test_a_dependency_file_names_outputs_and_all_inputs(icdgen, demo, tmp_path):
    overlay = demo.parent / "errata" / "demo.yaml"
    overlay.parent.mkdir()
    overlay.write_text("errata: 1\nnode: demo\nentries: []\n")
    icdgen("--lang", "c", "--out", "out", "--depfile", "out.d", demo)
    targets, _, needs = (tmp_path / "out.d").read_text().partition(": ")
    assert "demo.h" in targets
    assert (str(demo) in needs and str(overlay) in needs) or (
        "icd/demo.yaml" in needs and "icd/errata/demo.yaml" in needs
    )


@pytest.mark.parametrize(
    ("folder", "written"),
    [
        ("my icds", r"my\ icds"),
        ("my\\icds", r"my\\icds"),
        ("icds \\#1", r"icds\ \\\#1"),
        ("cost$", "cost$$"),
        ("c:icds", r"c\:icds"),
    ],
)
def test_paths_in_a_dependency_file_have_the_syntax_of_make(
    icdgen, demo, tmp_path, folder, written
):
    demo.parent.rename(tmp_path / folder)
    icd = os.path.join(folder, demo.name)
    icdgen("--lang", "c", "--out", f"{folder}/out", "--depfile", "out.d", icd)
    names = re.split(r":? \\\n  ", (tmp_path / "out.d").read_text().rstrip("\n"))
    assert f"{written}/out/demo.h" in names
    assert any(name.endswith(f"{written}/demo.yaml") for name in names)


def test_icdgen_toml_sets_icds_languages_and_folder(icdgen, demo, tmp_path):
    (tmp_path / "icdgen.toml").write_text(
        'icds = ["icd/demo.yaml"]\nlang = ["c"]\nout = "gen"\n'
    )
    assert icdgen().status == 0
    assert (tmp_path / "gen" / "c" / "demo.h").is_file()


def test_the_shipped_icds_are_the_default(icdgen, tmp_path):
    assert icdgen("--lang", "c", "--out", "out").status == 0
    assert (tmp_path / "out" / "cubeacp.h").is_file()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--lang", "cobol"], "there is no backend `cobol`; there are: assurance, c, "),
        (["--lang", "C"], "did you mean `c`?"),
        (["--lang", "py"], "did you mean `python`?"),
        (["--lang"], "requires an argument"),
        (["--langs", "c"], "No such option"),
        (["--lang", "c", "--templates", "nowhere"], "there is no folder nowhere"),
    ],
)
def test_misuse_is_status_2_with_a_remedy_and_writes_nothing(
    icdgen, tmp_path, arguments, words
):
    result = icdgen(*arguments)
    assert result.status == 2
    assert words in result.err
    assert list(tmp_path.iterdir()) == []


def test_a_missing_icd_is_a_finding(icdgen):
    result = icdgen("--lang", "c", "nowhere.yaml")
    assert result.status == 1
    assert "nowhere.yaml:1:1" in result.err and "cannot read the file" in result.err
    assert "|" not in result.err  # no line is shown


@pytest.mark.parametrize(
    "arguments", [("check",), ("--lang", "c"), ("show",), ("fmt",)]
)
def test_a_missing_icd_of_the_configuration_is_found_where_it_is_named(
    icdgen, tmp_path, arguments
):
    (tmp_path / "icdgen.toml").write_text(
        'out = "gen"\nicds = [\n    "./icd/nowhere.yaml",\n]\n'
    )
    result = icdgen(*arguments)
    assert result.status == 1
    report = result.out + result.err
    assert report.startswith("icdgen.toml:3:6: error[ICD001]: `icd/nowhere.yaml`: ")


def test_a_missing_icd_argument_is_not_reported_in_the_configuration(
    icdgen, demo, tmp_path
):
    (tmp_path / "icdgen.toml").write_text('icds = ["icd/demo.yaml"]\n')
    assert "nowhere.yaml:1:1" in icdgen("check", "nowhere.yaml").out


def test_single_templates_can_be_replaced(icdgen, demo, tmp_path):
    own = tmp_path / "mine" / "c"
    own.mkdir(parents=True)
    (own / "node.h.j2").write_text("/* our own node header */\n")
    assert (
        icdgen("--lang", "c", "--out", "out", "--templates", "mine", demo).status == 0
    )
    assert (tmp_path / "out" / "demo.h").read_text() == "/* our own node header */\n"
    assert (tmp_path / "out" / "icdgen.h").is_file()


@pytest.mark.parametrize(
    ("lang", "file", "out"),
    [
        ("c", "icdgen.h", "icdgen.h"),
        ("c", "support/words.h", "icdgen.h"),
        ("python", "icdgen_runtime/_errors.py", "icdgen_messages/_errors.py"),
        ("rust", "src/support/scale.rs", "src/support/scale.rs"),
    ],
)
def test_single_files_of_the_runtime_can_be_replaced(
    icdgen, demo, tmp_path, lang, file, out
):
    own = tmp_path / "mine" / lang / file
    own.parent.mkdir(parents=True)
    own.write_text("our own code\n")
    assert (
        icdgen("--lang", lang, "--out", "out", "--templates", "mine", demo).status == 0
    )
    text = (tmp_path / "out" / out).read_text()
    assert "Generated by icdgen" in text.splitlines()[0] and "our own code\n" in text


def test_a_replaced_file_of_the_runtime_must_be_text(icdgen, demo, tmp_path):
    (tmp_path / "icdgen.h").write_bytes(b"\xff")
    result = icdgen("--lang", "c", "--out", "out", "--templates", ".", demo)
    assert (
        result.status == 2
        and "icdgen.h: 'utf-8' codec" in result.err
        and "correct the file" in result.err
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("line\n{% if %}\n", "node.h.j2:2: Expected an expression"),
        (
            "line\n{{ nothing_of_that_name }}\n",
            "node.h.j2:2: 'nothing_of_that_name' is undefined",
        ),
    ],
)
def test_a_bad_template_is_named_with_its_line(icdgen, demo, tmp_path, text, words):
    own = tmp_path / "mine"
    own.mkdir()
    (own / "node.h.j2").write_text(text)
    result = icdgen("--lang", "c", "--out", "out", "--templates", "mine", demo)
    assert result.status == 2 and words in result.err
    assert not (tmp_path / "out").exists()


PLUGIN = """
from pathlib import PurePosixPath

class ListBackend:
    name = "list"
    reserved = frozenset()

    def files(self, icd, render):
        for node in icd.nodes:
            yield PurePosixPath(f"{node.name}.txt"), "".join(f"{m.name}\\n" for m in node.messages)

    def identifiers(self, icd):
        return iter(())
"""


def test_a_backend_of_another_package_is_found_by_its_entry_point(demo, tmp_path):
    site = tmp_path / "site"
    info = site / "icd_list-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "icd_list.py").write_text(PLUGIN)
    (info / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: icd-list\nVersion: 1.0\n"
    )
    (info / "entry_points.txt").write_text(
        "[icdgen.backends]\nlist = icd_list:ListBackend\n"
    )
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(site), str(ROOT / "codegen")]),
    }
    command = [
        sys.executable,
        "-m",
        "icdgen",
        "--lang",
        "list",
        "--out",
        "out",
        str(demo),
    ]
    subprocess.run(
        command, cwd=tmp_path, env=environment, check=True, capture_output=True
    )
    assert (tmp_path / "out" / "demo.txt").read_text() == "Estimated Roll\nSet Roll\n"


class TestStart:
    """Runs icdgen in a process of its own with its cache."""

    def run(self, demo, tmp_path, *more):
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "codegen")}
        command = [
            sys.executable,
            "-X",
            "importtime",
            "-m",
            "icdgen",
            "--lang",
            "c",
            "--out",
            "out",
            *more,
            str(demo),
        ]
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True
        )

    def test_a_run_with_nothing_to_do_imports_nothing_heavy(self, demo, tmp_path):
        assert self.run(demo, tmp_path).returncode == 0
        second = self.run(demo, tmp_path)
        assert second.returncode == 0 and "are current" in second.stdout
        assert not {"click", "yaml", "jinja2", "jsonschema_rs"} & {
            line.rsplit("|", 1)[-1].strip() for line in second.stderr.splitlines()
        }

    @pytest.mark.parametrize(
        "what", ["icd", "output", "overlay", "missing output", "stale output"]
    )
    def test_any_change_of_the_inputs_runs_the_generation(self, demo, tmp_path, what):
        self.run(demo, tmp_path)
        out = tmp_path / "out"
        expected = {name: data for name, (data, _) in tree(out).items()}
        if what == "icd":
            demo.write_text(DEMO.replace("Roll Angle", "Bank Angle"))
        elif what == "overlay":
            (demo.parent / "errata").mkdir()
            (demo.parent / "errata" / "demo.yaml").write_text("errata: 2\n")
        elif what == "output":
            (out / "demo.h").write_text("changed")
        elif what == "missing output":
            (out / "demo.h").unlink()
        elif what == "stale output":
            (out / ".icdgen-c.json").unlink()
        second = self.run(demo, tmp_path)
        if what == "overlay":
            assert second.returncode == 1 and "errata" in second.stderr
        elif what == "icd":
            assert "bank_angle" in (out / "demo" / "estimated_roll.h").read_text()
        elif what == "output":
            assert (out / "demo.h").read_bytes() == expected["demo.h"]
        else:
            assert {name: data for name, (data, _) in tree(out).items()} == expected
