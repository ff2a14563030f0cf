"""Each command of the two pages from a data sheet to running C gives the output that
they show.
"""

from __future__ import annotations

import os
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import documents
from tests.conftest import ROOT

FILES = ROOT / "docs" / "guides" / "tutorial"
PAGES = ["tutorial-sensor", "tutorial-serial"]


def page(name: str) -> str:
    return (ROOT / "docs" / "guides" / f"{name}.md").read_text(encoding="utf-8")


def blocks(name: str, language: str) -> list[str]:
    return documents.blocks(page(name), language)


def steps(name: str) -> Iterator[tuple[str, str]]:
    """Return each command with the output that the page shows."""
    for block in blocks(name, "console"):
        for step in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, shown = step.partition("\n")
            yield command, shown.strip()


@pytest.fixture
def folder(tmp_path) -> Path:
    """Return a clone after the first lines of the first page."""
    (commands,) = blocks(PAGES[0], "sh")
    *_, make, copy, enter = commands.strip().split("\n")
    subprocess.run(
        ["bash", "-ec", f"{make}; {copy}; {enter}; ls port.h"],
        cwd=ROOT,
        check=True,
        env=home(tmp_path),
    )
    return tmp_path / "wind"


@pytest.fixture
def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


def home(path: Path) -> dict[str, str]:
    programs = str(Path(sys.executable).parent)
    return {
        **os.environ,
        "HOME": str(path),
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
    }


@pytest.mark.parametrize("name", PAGES)
def test_every_command_gives_what_the_page_shows(name, folder, free_port):
    simulators = []
    try:
        for command, shown in steps(name):
            command, shown = (
                re.sub(r"\b400[01]\b", str(free_port), text)
                for text in (command, shown)
            )
            if command.startswith("icdgen sim"):  # in a terminal of its own
                simulator = subprocess.Popen(
                    ["bash", "-c", f"exec {command}"],
                    cwd=folder,
                    env=home(folder.parent),
                    stdout=subprocess.PIPE,
                    text=True,
                )
                simulators.append(simulator)
                assert simulator.stdout.readline().strip() == shown
                continue
            ran = subprocess.run(
                ["bash", "-c", command],
                cwd=folder,
                env=home(folder.parent),
                capture_output=True,
                text=True,
                timeout=300,
            )
            got = (ran.stdout + ran.stderr).strip()
            assert got == shown or (not shown and ran.returncode == 0), (
                f"{command}\n{got}"
            )
    finally:
        for simulator in simulators:
            simulator.kill()
            simulator.communicate()


@pytest.mark.parametrize("name", PAGES)
def test_excerpts_on_the_pages_equal_the_files(name, folder):
    for language in ("c", "yaml"):
        for block in blocks(name, language):
            files = [
                path for path in FILES.rglob("*.*") if path.suffix in (".c", ".yaml")
            ]
            is_printed = any(
                block.strip() in path.read_text(encoding="utf-8") for path in files
            )
            assert is_printed or "source: {page: 1}" in block, block


def test_the_excerpt_of_the_icd_is_what_the_import_writes(folder):
    for command, _ in steps(PAGES[1]):
        if command.startswith(("python", "icdgen import sirocco.pdf --profile")):
            subprocess.run(
                ["bash", "-c", command],
                cwd=folder,
                env=home(folder.parent),
                check=True,
                capture_output=True,
            )
    excerpt = next(
        block for block in blocks(PAGES[1], "yaml") if "source: {page: 1}" in block
    )
    assert excerpt in (folder / "icd" / "sirocco.yaml").read_text(encoding="utf-8")


def test_the_extra_installs_the_requirements_of_the_pages():
    import tomllib

    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
        "project"
    ]["optional-dependencies"]
    named = {re.split("[>=<]", requirement)[0] for requirement in extras["tutorial"]}
    imported = {"fpdf": "fpdf2", "reportlab": "reportlab"}
    for script in FILES.glob("*.py"):
        for module in re.findall(
            r"^(?:from|import) (\w+)", script.read_text(encoding="utf-8"), re.MULTILINE
        ):
            assert module in sys.stdlib_module_names or imported[module] in named
    assert "pdfplumber" in named and "pip install '.[tutorial]'" in page(PAGES[0])
