"""The programs behind the API table of the documents compile and run in every language."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scripts import api_page
from tests.c import harness
from tests.rust.tools import USED, Toolchain


@pytest.fixture(scope="module")
def generated(tmp_path_factory) -> Path:
    """Generate code from the ICD of the page."""
    folder = tmp_path_factory.mktemp("api")
    languages = [word for name in api_page.LANGUAGES for word in ("--lang", name)]
    command = [
        sys.executable,
        "-m",
        "icdgen",
        *languages,
        "--out",
        folder,
        api_page.FOLDER / "imu.yaml",
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


def test_the_page_contains_the_code_of_the_programs():
    assert api_page.PAGE.read_text("utf-8") == api_page.page()


@pytest.mark.parametrize(("compiler", "standard"), [("gcc", "c99"), ("clang", "c99")])
def test_the_c_program_runs(generated, compiler, standard, tmp_path):
    source = shutil.copy(api_page.FOLDER / "imu.c", tmp_path)
    options = (
        f"-std={standard}",
        *harness.WARNINGS,
        *harness.SANITIZERS,
        f"-I{generated / 'c'}",
    )
    program = harness.compile(
        source, *options, compiler=compiler, output=tmp_path / "imu"
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, f"line {done.returncode}: {done.stderr[:2000]}"


def test_the_python_program_runs_and_is_typed(generated, tmp_path):
    program, package = (
        shutil.copy(api_page.FOLDER / "imu.py", tmp_path),
        str(generated / "python"),
    )
    environment = {
        **os.environ,
        "PYTHONPATH": package,
        "MYPYPATH": package,
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    for command in ([], ["-m", "mypy", "--strict"]):
        command = [sys.executable, *command, program]
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, cwd=tmp_path
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_the_rust_program_runs(generated, tmp_path):
    tools = Toolchain("default")
    library = tools.library(generated / "rust" / "src" / "lib.rs", *USED)
    program = tools.program(api_page.FOLDER / "imu.rs", library, tmp_path / "imu")
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("file", "old", "new", "words"),
    [
        ("imu.c", "[decode]", "[decoded]", "disagree about [decode]"),
        ("imu.rs", "// [encode]\n", "// [decode]\n", "has [decode] twice"),
        ("imu.py", "# []\n", "", "does not end"),
        (
            "rows.yaml",
            "key: single, does: read the value in single precision, without:",
            "key: single, does: it, or:",
            "[single]",
        ),
        (
            "rows.yaml",
            "- {key: flag, does: read a flag}\n",
            "",
            "['flag'], of which rows.yaml knows nothing",
        ),
    ],
)
def test_a_row_that_a_language_lacks_is_an_error(
    file, old, new, words, tmp_path, monkeypatch
):
    shutil.copytree(api_page.FOLDER, tmp_path / "api")
    monkeypatch.setattr(api_page, "FOLDER", tmp_path / "api")
    text = (tmp_path / "api" / file).read_text("utf-8")
    assert old in text
    (tmp_path / "api" / file).write_text(text.replace(old, new), "utf-8")
    with pytest.raises(ValueError, match=words.replace("[", r"\[")):
        api_page.page()
