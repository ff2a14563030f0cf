"""One example program in C, Rust and Python compiles without a warning and prints the
same text for every behaviour of the node.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

import pytest

from icdgen.icd.model import Icd
from icdgen.loading import load
from tests import documents
from tests.c import harness as c
from tests.conftest import ROOT
from tests.python import packages
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain
from tests.sim.device import simulator

CONTROL = {
    "c": ROOT / "examples" / "control.c",
    "rust": ROOT / "examples" / "rust" / "src" / "bin" / "control.rs",
    "python": ROOT / "examples" / "control.py",
}
WHEEL = {
    language: ROOT / "examples" / "links" / f"wheel.{ending}"
    for language, ending in (("c", "c"), ("rust", "rs"), ("python", "py"))
}
WHEEL_ICD = WHEEL["c"].with_suffix(".yaml")
FLAGS = ("-std=c99", "-D_POSIX_C_SOURCE=200809L", *c.WARNINGS)


class Example(NamedTuple):
    """A program in each language, and its generated code."""

    files: dict[str, Path]
    headers: Path
    crate: Path  # compiled, with std
    package: Path  # folder of the Python package
    commands: dict[str, list[str | Path]]


def built(icd: Icd, files: dict[str, Path], folder: Path) -> Example:
    """Compile the programs."""
    (folder / "c").mkdir()
    headers = c.generate(icd, folder / "c")
    (folder / "rust").mkdir()
    tools = Toolchain("default")
    crate = tools.library(rust.generate(icd, folder / "rust"), *USED)
    for path, text in packages.files(icd).items():
        (folder / "python" / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / "python" / path).write_text(text, encoding="utf-8")
    includes = [f"-I{headers}", f"-I{ROOT / 'examples'}"]
    in_c = c.compile(
        files["c"], *FLAGS, *c.SANITIZERS, *includes, output=folder / "program"
    )
    path = f"PYTHONPATH={folder / 'python'}"
    commands: dict[str, list[str | Path]] = {
        "c": [in_c],
        "rust": [tools.program(files["rust"], crate, folder / "program-in-rust")],
        "python": ["env", path, sys.executable, "-B", files["python"]],
    }
    return Example(files, headers, crate, folder / "python", commands)


@pytest.fixture(scope="module")
def control(tmp_path_factory) -> Example:
    return built(c.shipped(), CONTROL, tmp_path_factory.mktemp("control"))


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Example:
    icd = load([WHEEL_ICD]).icd
    return built(icd, WHEEL, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(params=["control", "wheel"])
def example(request) -> Example:
    return request.getfixturevalue(request.param)


def outcomes(example: Example, *simulated: str) -> dict[str, tuple[int, str, str]]:
    """Return the exit code and output of each program against a simulated device."""
    results = {}
    with simulator(*simulated, "--tcp", "0") as (place, _):
        port = str(urlsplit(place).port)
        for language, command in example.commands.items():
            done = subprocess.run(
                [*command, port], capture_output=True, text=True, timeout=60
            )
            results[language] = (done.returncode, done.stdout, done.stderr)
    return results


@pytest.mark.parametrize(
    ("options", "expected"),
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
def test_each_language_prints_the_same_for_the_same_node(control, options, expected):
    got = outcomes(control, "--node", "cubeacp", *options)
    assert got == dict.fromkeys(CONTROL, expected)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--set", "Events", "count=7"], (0, "7 events\n", "")),
        (["--fault", "nak=100%:Wrong mode"], (1, "", "refused: Wrong mode\n")),
        (["--fault", "busy=100%"], (1, "", "busy, attempts: 3\n")),
        (["--fault", "silence=100%"], (1, "", "no response, attempts: 3\n")),
        # The response to another telecommand does not confirm this one.
        (["--fault", "foreign=100%"], (1, "", "no response, attempts: 3\n")),
    ],
)
def test_each_language_prints_the_same_outcome_of_a_command(wheel, options, expected):
    got = outcomes(wheel, "--icd", str(WHEEL_ICD), *options)
    assert got == dict.fromkeys(WHEEL, expected)


def test_the_node_stores_the_commanded_values(control):
    for command in control.commands.values():
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
def test_the_example_in_c_has_no_warning(example, compiler):
    includes = [f"-I{example.headers}", f"-I{ROOT / 'examples'}"]
    c.compile(example.files["c"], *FLAGS, *includes, compiler=compiler)


def test_the_example_in_rust_is_tidy(example, tmp_path):
    toolchain, file = Toolchain("default"), example.files["rust"]
    toolchain.formatted(file)
    toolchain.linted(file, tmp_path, "--extern", f"icd={example.crate}")


def test_the_example_in_python_is_typed(example, tmp_path):
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--cache-dir",
        tmp_path,
        example.files["python"],
    ]
    path = {**os.environ, "MYPYPATH": str(example.package)}
    done = subprocess.run(
        command, cwd=tmp_path, env=path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout


def test_the_pages_show_the_examples_unchanged():
    pages = {
        "c": "guides/driver-in-c",
        "rust": "guides/rust",
        "python": "guides/python",
    }
    for language, file in CONTROL.items():
        shown = documents.text(pages[language])
        assert f"```{language}\n{file.read_text(encoding='utf-8')}```\n" in shown
    shown = documents.text("guides/serial-link")
    for language, file in WHEEL.items():
        assert f"```{language}\n{file.read_text(encoding='utf-8')}```\n" in shown
