"""The plug-in of docs/guides/add-a-language.md does what the page shows after
installing it like a user.
"""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import DEMO, ROOT

PAGE = ROOT / "docs" / "guides" / "add-a-language.md"
_FILE = re.compile(
    r"^```\w+\n(?:#|--|\{#) (?P<path>\S+)[^\n]*\n(?P<text>.*?)^```\n",
    re.MULTILINE | re.DOTALL,
)


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("lua")
    files = {
        match_["path"]: match_["text"]
        for match_ in _FILE.finditer(PAGE.read_text("utf-8"))
    }
    assert len(files) == 4 and sum(text.count("\n") for text in files.values()) < 100
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    command = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--target",
        folder / "site",
        folder,
    ]
    subprocess.run(command, check=True)
    return folder / "site"


@pytest.fixture
def icdgen(installed, tmp_path):
    """Run icdgen with the plug-in installed; another site folder may be given."""
    (tmp_path / "demo.yaml").write_text(DEMO)

    def run(
        *arguments: str, site: Path = installed
    ) -> subprocess.CompletedProcess[str]:
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(site), str(ROOT / "codegen")]),
        }
        command = [sys.executable, "-m", "icdgen", *arguments]
        result = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert "Traceback" not in result.stderr
        return result

    return run


def test_a_plug_in_generates_from_its_own_templates_and_runtime(icdgen, tmp_path):
    assert icdgen("--lang", "lua", "--out", "out", "demo.yaml").returncode == 0
    assert (tmp_path / "out" / "demo.lua").read_text() == (
        'local registry = require("registry")\n\nlocal demo = {\n'
        "    estimated_roll = { ids = { 146 }, length = 3 },\n    set_roll = { ids = { 20 }, length = 2 },\n}\n"
        "demo.name_of = registry.name_of(demo)\nreturn demo\n"
    )
    assert (
        (tmp_path / "out" / "registry.lua")
        .read_text()
        .startswith("local registry = {}\n")
    )
    assert (
        icdgen("--lang", "lua", "--out", "out", "--check", "demo.yaml").returncode == 0
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("End", "message `End` becomes `end`, a reserved word in lua"),
        (
            "Name Of",
            "message `Name Of` and the function `name_of` both become `name_of` in lua",
        ),
    ],
)
def test_names_of_a_plug_in_are_checked_if_it_is_generated(
    icdgen, tmp_path, name, words
):
    (tmp_path / "demo.yaml").write_text(DEMO.replace("name: Set Roll", f"name: {name}"))
    result = icdgen("--lang", "lua", "--out", "out", "demo.yaml")
    assert (
        result.returncode == 1
        and words in result.stderr
        and "demo.yaml:" in result.stderr
    )
    assert not (tmp_path / "out").exists()
    assert icdgen("check", "demo.yaml").returncode == 0
    (tmp_path / "icdgen.toml").write_text('lang = ["lua"]\n')
    assert words in icdgen("check", "demo.yaml").stdout


def test_files_of_a_plug_in_can_be_replaced(icdgen, tmp_path):
    (tmp_path / "own" / "lua").mkdir(parents=True)
    (tmp_path / "own" / "lua" / "node.lua.j2").write_text("-- {{ node.model.title }}\n")
    (tmp_path / "own" / "lua" / "registry.lua").write_text("-- ours\n")
    assert (
        icdgen(
            "--lang", "lua", "--out", "out", "--templates", "own", "demo.yaml"
        ).returncode
        == 0
    )
    assert (tmp_path / "out" / "demo.lua").read_text() == "-- Demo\n"
    assert (tmp_path / "out" / "registry.lua").read_text() == "-- ours\n"


@pytest.fixture
def changed(installed, tmp_path):
    """Return the installed plug-in with a change in its class or its entry point."""

    def change(old: str, new: str) -> Path:
        site = tmp_path / "site"
        shutil.copytree(installed, site, ignore=shutil.ignore_patterns("__pycache__"))
        for path in (
            site / "icdgen_lua" / "__init__.py",
            next(site.glob("*.dist-info/entry_points.txt")),
        ):
            path.write_text(path.read_text().replace(old, new))
        return site

    return change


@pytest.mark.parametrize("place", ["for file in render.runtime_files():", "scope = "])
def test_a_crash_of_a_plug_in_is_a_clear_error(icdgen, changed, tmp_path, place):
    site = changed(
        place, f"1 / 0; {place}" if place == "scope = " else f"1 / 0\n        {place}"
    )
    result = icdgen("--lang", "lua", "--out", "out", "demo.yaml", site=site)
    assert result.returncode == 2 and "failed: ZeroDivisionError" in result.stderr
    assert (
        "the backend `lua` of icdgen-lua" in result.stderr
        and "icdgen_lua" in result.stderr
    )
    assert not (tmp_path / "out").exists()


def test_the_entry_point_must_have_the_name_of_the_plug_in(icdgen, changed):
    result = icdgen(
        "--lang",
        "luna",
        "demo.yaml",
        site=changed("lua = icdgen_lua", "luna = icdgen_lua"),
    )
    assert result.returncode == 2
    assert (
        "`luna = icdgen_lua:LuaBackend` of icdgen-lua leads to a backend called `lua`"
        in result.stderr
    )


def test_two_packages_of_one_name_are_refused(icdgen, changed):
    site = changed("nothing", "nothing")
    info = site / "other-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[icdgen.backends]\nlua = other:Backend\n")
    result = icdgen("--lang", "lua", "demo.yaml", site=site)
    assert result.returncode == 2
    assert (
        "there are 2 backends `lua`: `icdgen_lua:LuaBackend` of icdgen-lua and `other:Backend` of other"
        in result.stderr
    )


def test_help_lists_the_plug_in_and_no_testee(icdgen, tmp_path):
    for arguments in (["--help"], ["generate", "--help"]):
        # argparse also breaks lines after hyphens.
        listed = "".join(icdgen(*arguments).stdout.split())
        assert (
            "c,python,rust,vectors,c-selftest,html,assurance,xtce,xlsx,csv,andofotherpackageslua(icdgen-lua)."
            in listed
        )
        assert "csv." in " ".join(icdgen(*arguments, site=tmp_path).stdout.split())


def test_names_of_a_plug_in_are_in_the_traceability_report(icdgen, tmp_path):
    result = icdgen("--lang", "assurance", "--out", "pack", "demo.yaml")
    assert result.returncode == 0, result.stderr
    head, *rows = csv.reader(
        (tmp_path / "pack" / "trace.csv").read_text("utf-8").splitlines()
    )
    message = next(
        row for row in rows if row[0] == "message" and row[3] == "Estimated Roll"
    )
    assert message[head.index("lua")] == "estimated_roll (fields of the module demo)"
