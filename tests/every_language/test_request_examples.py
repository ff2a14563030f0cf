"""The guides show examples that request telemetry, and the examples run.

Each example requests telemetry of a simulated node.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests import documents
from tests.c import harness as c
from tests.conftest import ROOT
from tests.rust import harness as rust
from tests.sim.device import simulator

EXAMPLES = ROOT / "examples"


def test_each_guide_shows_its_example():
    _, of_c = (EXAMPLES / "request.c").read_text("utf-8").split("*/\n", 1)
    assert of_c in documents.text("guides/driver-in-c")
    _, of_python = (EXAMPLES / "talk.py").read_text("utf-8").split("\n\n", 1)
    assert f"```python\n{of_python}```\n" in documents.text("guides/python")
    source = EXAMPLES / "rust" / "src" / "bin" / "request.rs"
    _, of_rust = source.read_text("utf-8").split("\n", 1)
    assert f"```rust\n{of_rust}```\n" in documents.text("guides/rust")


def write_with_port(source: Path, port: str, target: Path) -> None:
    """Write an example with the port of the simulator instead of that of the guide."""
    code = source.read_text("utf-8")
    assert "4000" in code
    target.write_text(code.replace("4000", port), encoding="utf-8")


def run_c(port: str, folder: Path) -> subprocess.CompletedProcess:
    headers = c.generate(c.shipped(), folder)
    program = c.compile(
        EXAMPLES / "request.c",
        "-std=c99",
        "-D_POSIX_C_SOURCE=200809L",
        *c.WARNINGS,
        *c.SANITIZERS,
        f"-I{headers}",
        output=folder / "request",
    )
    return subprocess.run([program, port], capture_output=True, text=True, timeout=60)


def run_python(port: str, folder: Path) -> subprocess.CompletedProcess:
    write_with_port(EXAMPLES / "talk.py", port, folder / "talk.py")
    package = ROOT / "generated" / "python"
    environment = {"PATH": os.environ["PATH"], "PYTHONPATH": str(package)}
    return subprocess.run(
        [sys.executable, "-B", folder / "talk.py"],
        capture_output=True,
        text=True,
        timeout=60,
        env=environment,  # without icdgen on the path
    )


def run_rust(port: str, folder: Path) -> subprocess.CompletedProcess:
    project = folder / "examples" / "rust"
    ignored = shutil.ignore_patterns("target")
    shutil.copytree(EXAMPLES / "rust", project, ignore=ignored)
    rust.generate(rust.shipped(), folder / "build" / "quickstart")
    source = project / "src" / "bin" / "request.rs"
    write_with_port(source, port, source)
    environment = {
        **os.environ,
        "CARGO_HOME": str(folder / "home"),
        "CARGO_TARGET_DIR": str(folder / "target"),
        "RUSTFLAGS": "-D warnings",
    }
    return subprocess.run(
        ["cargo", "run", "--quiet", "--offline", "--bin", "request"],
        cwd=project,
        env=environment,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize(
    "run",
    [
        pytest.param(run_c, marks=pytest.mark.needs("gcc")),
        run_python,
        pytest.param(run_rust, marks=pytest.mark.needs("cargo")),
    ],
)
def test_the_example_prints_the_telemetry_of_the_simulator(run, tmp_path):
    values = ("--set", "Estimated Attitude Angles", "roll=-12.34")
    with simulator("--node", "cubeacp", "--tcp", "0", *values) as (address, _):
        done = run(str(urlsplit(address).port), tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "roll -12.34 deg\n", "")
