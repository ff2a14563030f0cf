"""The same example program in C, Rust and Python: it compiles without a warning, and
says the same whatever the node does.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests import documents
from tests.c import harness as c
from tests.conftest import ROOT
from tests.python import packages
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain
from tests.sim.device import simulator

EXAMPLES = {
    "c": ROOT / "examples" / "control.c",
    "rust": ROOT / "examples" / "rust" / "src" / "bin" / "control.rs",
    "python": ROOT / "examples" / "control.py",
}
FLAGS = ("-std=c99", "-D_POSIX_C_SOURCE=200809L", *c.WARNINGS)


@pytest.fixture(scope="module")
def headers(tmp_path_factory) -> Path:
    return c.generate(c.shipped(), tmp_path_factory.mktemp("headers"))


@pytest.fixture(scope="module")
def crate(tmp_path_factory) -> Path:
    """The compiled crate, with std."""
    folder = tmp_path_factory.mktemp("crate")
    return Toolchain("default").library(rust.generate(rust.shipped(), folder), *USED)


@pytest.fixture(scope="module")
def package(tmp_path_factory) -> Path:
    """The folder of the Python package."""
    folder = tmp_path_factory.mktemp("package")
    for path, text in packages.files(packages.shipped()).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def programs(headers, crate, package, tmp_path_factory) -> dict[str, list[str | Path]]:
    """The command of each."""
    folder = tmp_path_factory.mktemp("programs")
    return {
        "c": [
            c.compile(
                EXAMPLES["c"],
                *FLAGS,
                *c.SANITIZERS,
                f"-I{headers}",
                output=folder / "c",
            )
        ],
        "rust": [
            Toolchain("default").program(EXAMPLES["rust"], crate, folder / "rust")
        ],
        "python": [
            "env",
            f"PYTHONPATH={package}",
            sys.executable,
            "-B",
            EXAMPLES["python"],
        ],
    }


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            ["--set", "Estimated Attitude Angles", "roll=12.5"],
            (0, "roll 12.50 deg\nnothing is estimated\n", ""),
        ),
        (
            ["--set", "Current ADCS State", "attitude estimation mode=5"],
            (0, "roll 0.00 deg\nestimated by Full-state EKF\n", ""),
        ),
        (
            ["--set", "Current ADCS State", "attitude estimation mode=12"],
            (0, "roll 0.00 deg\nestimation mode 12 has no name\n", ""),
        ),
        (["--fault", "nack=100%"], (1, "", "refused, code 3\n")),
        (["--fault", "drop=100%@acknowledge"], (1, "", "no response, attempts: 1\n")),
    ],
)
def test_each_language_says_the_same_of_the_same_node(programs, options, said):
    with simulator("--node", "cubeacp", "--tcp", "0", *options) as (place, _):
        port = str(urlsplit(place).port)
        ran = {
            language: subprocess.run(
                [*command, port], capture_output=True, text=True, timeout=60
            )
            for language, command in programs.items()
        }
    got = {
        language: (done.returncode, done.stdout, done.stderr)
        for language, done in ran.items()
    }
    assert got == dict.fromkeys(programs, said)


def test_what_was_commanded_is_what_the_node_holds(programs):
    for command in programs.values():
        with simulator("--node", "cubeacp", "--tcp", "0") as (place, _):
            subprocess.run(
                [*command, str(urlsplit(place).port)],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            monitor = [
                sys.executable,
                "-m",
                "icdgen",
                "monitor",
                "cubeacp",
                "Commanded Attitude Angles",
                "--once",
            ]
            shown = subprocess.run(
                [*monitor, "--port", place], capture_output=True, text=True, check=True
            ).stdout
        assert [line.split()[-2:] for line in shown.splitlines() if "Roll" in line] == [
            ["1.5", "deg"]
        ], command


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_the_example_in_c_has_no_warning(headers, compiler):
    c.compile(EXAMPLES["c"], *FLAGS, f"-I{headers}", compiler=compiler)


def test_the_example_in_rust_is_tidy(crate, tmp_path):
    toolchain = Toolchain("default")
    toolchain.formatted(EXAMPLES["rust"])
    toolchain.linted(EXAMPLES["rust"], tmp_path, "--extern", f"icd={crate}")


def test_the_example_in_python_is_typed(package, tmp_path):
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--cache-dir",
        tmp_path,
        EXAMPLES["python"],
    ]
    path = {**os.environ, "MYPYPATH": str(package)}
    done = subprocess.run(
        command, cwd=tmp_path, env=path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout


def test_the_pages_show_the_examples_as_they_are():
    pages = {
        "c": "guides/driver-in-c",
        "rust": "guides/rust",
        "python": "guides/python",
    }
    for language, example in EXAMPLES.items():
        assert (
            f"```{language}\n{example.read_text(encoding='utf-8')}```\n"
            in documents.text(pages[language])
        ), language
