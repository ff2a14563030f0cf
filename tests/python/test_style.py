"""Generated packages pass the formatter, the linter and both type checkers, whatever
the names.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.python import lengths, packages
from tests.python.packages import Package

HERE = Path(__file__).parent


def check(package: Package, *command: str | Path) -> str:
    """What a tool prints; fails if it finds anything."""
    done = tool(package, *command)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def tool(package: Package, *command: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs a tool of the test environment in the folder of the package."""
    words = [sys.executable, "-m", *map(str, command)]
    return subprocess.run(words, cwd=package.folder, capture_output=True, text=True)


@pytest.fixture(scope="module")
def long(tmp_path_factory) -> Package:
    """Made from an ICD with names of all lengths.

    It is not imported: files of such names are beyond most file systems.
    """
    icd = packages.read(
        lengths.write(tmp_path_factory.mktemp("lengths"), range(48, 98))
    )
    return packages.write(icd, tmp_path_factory.mktemp("long"), "long_messages")


@pytest.mark.parametrize("name", ["shipped", "odd", "ordered", "long"])
def test_ruff_changes_nothing(name, request):
    package = request.getfixturevalue(name)
    check(package, "ruff", "format", "--no-cache", "--check", package.name)


@pytest.mark.parametrize("name", ["odd", "long"])
def test_nor_does_black(name, request):
    """Asked of two packages, since it takes seconds: ruff and black differ in the lines
    that they break, and here are lines of all lengths.
    """
    check(request.getfixturevalue(name), "black", "--check", ".")


@pytest.mark.parametrize("name", ["shipped", "odd", "ordered", "long"])
def test_ruff_finds_nothing(name, request):
    check(request.getfixturevalue(name), "ruff", "check", "--no-cache", ".")


def test_mypy_finds_nothing(package, tmp_path):
    check(package, "mypy", "--strict", "--cache-dir", tmp_path, package.name)


def test_pyright_finds_nothing(shipped, odd):
    for package in (shipped, odd):
        check(package, "pyright", package.name)


def test_programs_that_use_the_package_are_checked(shipped, tmp_path):
    check(shipped, "mypy", "--strict", "--cache-dir", tmp_path, HERE / "user.py")
    check(shipped, "pyright", write(shipped, "user.py"))


@pytest.mark.parametrize(
    "command", [("mypy", "--strict", "--show-error-codes"), ("pyright",)]
)
def test_mistakes_in_programs_are_found(shipped, tmp_path, command):
    program = write(shipped, "misuse.py")
    lines = program.read_text(encoding="utf-8").splitlines()
    wrong = {
        number for number, line in enumerate(lines, 1) if line.endswith("# expect")
    }
    cache = ("--cache-dir", tmp_path) if command[0] == "mypy" else ()
    done = tool(shipped, *command, *cache, program)
    found = {
        int(number) for number in re.findall(r"misuse\.py:(\d+):.* error", done.stdout)
    }
    assert found == wrong, done.stdout


def write(package: Package, name: str) -> Path:
    """A copy of a program beside the package, where type checkers find that."""
    path = package.folder / name
    path.write_text((HERE / name).read_text(encoding="utf-8"), encoding="utf-8")
    return path
