"""Long commands show their progress on a terminal, and print nothing into a pipe."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

from icdgen.commands import progress
from tests.conftest import ROOT

RUN = """
import sys
from icdgen.cli import main
from icdgen.commands import progress
progress.DELAY = {}
sys.exit(main(sys.argv[1:]))
"""
ICD = str(ROOT / "icd" / "cubewheel.yaml")
COMMANDS = {
    "docs": (["docs", ICD, "--out", "site"], "documentation"),
    "vectors": (["--lang", "vectors", "--out", "vectors", ICD], "vectors"),
    "import": (["import", "demo.dbc"], "reading demo.dbc"),
}


def on_terminal(arguments: list[str], folder, delay: float) -> tuple[int, str]:
    """Run with standard error on a terminal; return the exit status and the output on
    the terminal.
    """
    pty = pytest.importorskip("pty")
    reading, terminal = pty.openpty()
    command = [sys.executable, "-c", RUN.format(delay), *arguments]
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=os.environ | {"TERM": "xterm"},  # a dumb terminal gets no bars
        stdout=subprocess.DEVNULL,
        stderr=terminal,
    )
    os.close(terminal)
    received = b""
    try:
        while part := os.read(reading, 4096):
            received += part
    except OSError:
        pass  # Linux reports the end of a terminal as an error
    os.close(reading)
    return process.wait(), re.sub("\x1b\\[[0-9;?]*[A-Za-z]", "", received.decode())


@pytest.fixture
def bars(monkeypatch) -> list:
    """Record the progress bars that are created."""
    created = []
    kind = progress._Bar
    monkeypatch.setattr(
        progress,
        "_Bar",
        lambda *arguments: created.append(kind(*arguments)) or created[-1],
    )
    return created


@pytest.fixture
def folder(tmp_path):
    database = 'VERSION ""\n\nBU_: A\n\nBO_ 1 State: 1 A\n SG_ Mode : 0|8@1+ (1,0) [0|255] "" A\n'
    (tmp_path / "demo.dbc").write_text(database)
    return tmp_path


@pytest.mark.pty
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_that_takes_long_shows_on_a_terminal_what_it_does(name, folder):
    arguments, text = COMMANDS[name]
    status, shown = on_terminal(arguments, folder, delay=0)
    assert (status, text in shown) == (0, True), shown


@pytest.mark.pty
def test_a_command_that_ends_soon_shows_nothing(folder):
    assert on_terminal(COMMANDS["vectors"][0], folder, delay=60) == (0, "")


@pytest.mark.parametrize("name", COMMANDS)
def test_nothing_is_printed_if_standard_error_is_a_pipe(name, folder):
    command = [sys.executable, "-c", RUN.format(0), *COMMANDS[name][0]]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert result.returncode == 0
    assert "reading" not in result.stderr and "files" not in result.stderr


def test_the_pages_of_a_manual_are_counted(bars):
    with progress.pages("reading") as count:
        count(3, 12, 5)
    assert bars[0].values == {"completed": 3, "total": 12, "tables": 5}


def test_the_bytes_of_a_log_add_up(bars):
    with progress.bytes_of("log", 100) as count:
        count(30)
        count(20)
    assert bars[0].values == {"total": 100, "completed": 50}
