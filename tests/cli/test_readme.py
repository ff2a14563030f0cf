"""The commands of the README work in a fresh clone of the repository."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from scripts.page_commands import MARK, script, steps
from tests import documents
from tests.c import harness as c
from tests.conftest import ROOT
from tests.python import packages
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain

README = (ROOT / "README.md").read_text(encoding="utf-8")
SUITE = "scripts/test"  # this test is a part of the suite
FRAME = bytes.fromhex("020166 08e81c")  # 21.5 C
_BYTES = ", ".join(f"0x{byte:02x}" for byte in FRAME)

C = f"""
%s
#include <stdio.h>

static bool show(const uint8_t *data, size_t length)
{{
    %s
    (void)printf("%%.2f\\n", temperature);
    return true;
}}

int main(void)
{{
    const uint8_t data[] = {{{_BYTES}}};
    return show(data, sizeof data) ? 0 : 1;
}}
"""
RUST = f"""
fn main() -> Result<(), icd::Error> {{
    let data = &[{_BYTES}][..];
    %s
    println!("{{temperature}}");
    Ok(())
}}
"""


@pytest.fixture(scope="module")
def clone(tmp_path_factory) -> Path:
    """Copy the files of this repository, except files that only tests use."""
    folder = tmp_path_factory.mktemp("clone")
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file() and not name.startswith(("generated/", "tests/")):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


@pytest.fixture
def free_port() -> str:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return str(server.getsockname()[1])


def test_every_command_runs_in_order_in_one_shell_and_prints_what_is_shown(
    clone, free_port, tmp_path
):
    typed = [
        step
        for step in steps(README.replace("4000", free_port))
        if not step.command.startswith(SUITE)
    ]
    ran = subprocess.run(
        ["bash", "-c", script([step.command for step in typed])],
        cwd=clone,
        env=_environment(tmp_path),
        capture_output=True,
        text=True,
        timeout=600,
    )
    outputs = re.split(rf"^{MARK} \d+\n", ran.stdout, flags=re.MULTILINE)[1:]
    assert ran.returncode == 0, (
        f"{typed[len(outputs) - 1].command}\n{ran.stdout}\n{ran.stderr}"
    )
    assert len(outputs) == len(typed) + 1 and len(typed) > 10
    missing = [
        step
        for step, output in zip(typed, outputs, strict=False)
        if step.shown not in output
    ]
    assert missing == [], ran.stdout


def _environment(home: Path) -> dict[str, str]:
    """Return the environment of a user with an empty home, without the virtual
    environment of the tests.
    """
    own = Path(sys.prefix) / "bin"
    path = os.pathsep.join(
        part for part in os.environ["PATH"].split(os.pathsep) if Path(part) != own
    )
    tools = {
        name.upper() + "_HOME": str(Path.home() / f".{name}")
        for name in ("cargo", "rustup")
    }
    return {**tools, **os.environ, "HOME": str(home), "PATH": path}


@pytest.fixture(scope="module")
def battery(tmp_path_factory) -> Path:
    """Return the first ICD of the README."""
    folder = tmp_path_factory.mktemp("battery")
    subprocess.run(
        [sys.executable, "-m", "icdgen", "init", "battery"],
        cwd=folder,
        check=True,
        capture_output=True,
    )
    return folder / "icd" / "battery.yaml"


def snippet(language: str) -> str:
    """Return the first block of a language."""
    return documents.blocks(README, language)[0]


def test_the_message_shown_is_that_of_the_first_icd(battery):
    assert snippet("yaml") in battery.read_text("utf-8")


def test_the_c_shown_reads_the_message(battery, tmp_path):
    headers = c.generate(c.read_unchecked(battery), tmp_path / "c")
    source = tmp_path / "program.c"
    include, _, body = snippet("c").partition("\n")
    source.write_text(C % (include, body))
    program = c.compile(
        source, "-std=c99", *c.WARNINGS, f"-I{headers}", output=tmp_path / "program"
    )
    assert subprocess.run([program], capture_output=True, text=True).stdout == "21.50\n"


def test_the_python_shown_reads_the_message(battery, tmp_path):
    package = packages.write(packages.read(battery), tmp_path, "readme_messages")
    values = {"data": FRAME}
    package.module()
    exec(snippet("python").replace("from battery.", "from readme_messages."), values)
    assert values["temperature"] == 21.5


def test_the_rust_shown_reads_the_message(battery, tmp_path):
    library = rust.generate(rust.read_unchecked(battery), tmp_path)
    toolchain = Toolchain("default")
    source = tmp_path / "program.rs"
    source.write_text(RUST % snippet("rust").replace("use battery::", "use icd::"))
    program = toolchain.program(
        source, toolchain.library(library, *USED), tmp_path / "program"
    )
    assert subprocess.run([program], capture_output=True, text=True).stdout == "21.5\n"
