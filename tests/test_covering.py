"""`tests.covering` names tests for each file that a contributor may change."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.covering import COVERING, FIRST, covering_tests


def tracked(*folders: str) -> list[str]:
    command = ["git", "ls-files", "--", *folders]
    listed = subprocess.run(
        command, cwd=ROOT, check=True, capture_output=True, text=True
    )
    return listed.stdout.split()


def test_every_source_file_has_tests():
    files = tracked("codegen", "runtime", "templates", "icd", "scripts", "examples")
    assert len(files) > 700
    for file in files:
        for test in covering_tests(file):
            assert (ROOT / test).exists(), f"{file}: {test}"


def test_each_folder_of_the_table_exists():
    for start, tests in COVERING.items():
        assert any(file.startswith(start) for file in tracked(start.rstrip("/")))
        assert [test for test in tests if not (ROOT / test).exists()] == []


def test_each_test_named_as_the_first_of_a_file_exists_and_is_first():
    for start, test in FIRST.items():
        files = [file for file in tracked("codegen") if file.startswith(start)]
        assert files and all(covering_tests(file)[0] == test for file in files), start


def test_tests_with_the_name_of_a_file_come_first():
    assert (
        covering_tests("codegen/icdgen/icd/formula.py")[0]
        == "tests/icd/test_formula.py"
    )
    assert covering_tests("tests/icd/test_formula.py") == ["tests/icd/test_formula.py"]


def test_a_file_without_known_tests_is_rejected():
    with pytest.raises(KeyError):
        covering_tests("LICENSE")


def test_every_folder_of_tests_covers_a_folder():
    """A new folder of tests must be named, or its tests run for no file."""
    without = {"mutation", "fuzz"}
    named = {test.split("/")[1] for tests in COVERING.values() for test in tests}
    folders = {
        path.parent.relative_to(ROOT / "tests").parts[0]
        for path in map(Path, (ROOT / "tests").rglob("test_*.py"))
        if path.parent != ROOT / "tests"
    }
    assert folders - named - without == set()
