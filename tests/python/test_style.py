"""Generated packages pass the formatters, the linter and both type checkers.

This includes packages with names of all lengths and with hostile names.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.python import lengths, packages
from tests.python.packages import Package

HERE = Path(__file__).parent


def check(package: Package, *command: str | Path) -> str:
    """Run a tool and return its output; fail if it reports an error."""
    done = tool(package, *command)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def tool(package: Package, *command: str | Path) -> subprocess.CompletedProcess[str]:
    """Run a tool of the test environment in the folder of the package."""
    words = [sys.executable, "-m", *map(str, command)]
    return subprocess.run(words, cwd=package.folder, capture_output=True, text=True)


@pytest.fixture(scope="module")
def long(tmp_path_factory) -> Package:
    """Package generated from an ICD with names of all lengths.

    No test imports it: most file systems do not allow file names of such length.
    """
    icd = packages.read(
        lengths.write(tmp_path_factory.mktemp("lengths"), range(48, 98))
    )
    return packages.write(icd, tmp_path_factory.mktemp("long"), "long_messages")


@pytest.mark.parametrize("name", ["shipped", "odd", "ordered", "long"])
def test_ruff_format_leaves_the_package_unchanged(name, request):
    package = request.getfixturevalue(name)
    check(package, "ruff", "format", "--no-cache", "--check", package.name)


@pytest.mark.parametrize("name", ["odd", "long"])
def test_black_leaves_the_package_unchanged(name, request):
    """ruff and black may break different lines; the packages have lines of all lengths.

    The test checks only two packages, since black takes seconds.
    """
    check(request.getfixturevalue(name), "black", "--check", ".")


@pytest.mark.parametrize("name", ["shipped", "odd", "ordered", "long"])
def test_ruff_check_reports_no_errors(name, request):
    check(request.getfixturevalue(name), "ruff", "check", "--no-cache", ".")


@pytest.fixture(scope="module", params=["mypy", "pyright"])
def mistakes(request, shipped, odd, ordered, tmp_path_factory) -> dict[str, set[int]]:
    """Line numbers of the errors that a type checker reports, by file.

    One run checks all packages and two programs that use the shipped one.
    """
    folder = tmp_path_factory.mktemp("checked")
    packages = (shipped, odd, ordered)
    for package in packages:
        shutil.copytree(package.folder / package.name, folder / package.name)
    for program in ("user.py", "misuse.py"):
        shutil.copy(HERE / program, folder)
    options = {
        "mypy": ["--strict", "--cache-dir", tmp_path_factory.mktemp("mypy")],
        "pyright": [],
    }
    words = [request.param, *options[request.param], *(p.name for p in packages)]
    done = subprocess.run(
        [sys.executable, "-m", *map(str, words), "user.py", "misuse.py"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    lines: dict[str, set[int]] = {}
    for file, line in re.findall(
        r"^\s*(\S+\.py):(\d+):.* error", done.stdout, re.MULTILINE
    ):
        name = Path(file).relative_to(folder) if Path(file).is_absolute() else file
        lines.setdefault(str(name), set()).add(int(line))
    assert lines, done.stdout + done.stderr
    return lines


def test_type_checkers_report_no_errors_in_packages_and_programs(mistakes):
    assert {file: mistakes[file] for file in mistakes if file != "misuse.py"} == {}


def test_type_checkers_report_mistakes_in_programs(mistakes):
    lines = (HERE / "misuse.py").read_text(encoding="utf-8").splitlines()
    wrong = {
        number for number, line in enumerate(lines, 1) if line.endswith("# expect")
    }
    assert mistakes["misuse.py"] == wrong
