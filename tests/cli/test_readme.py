"""The README, typed by somebody who has just cloned the repository."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
# What takes minutes or installs something: CI runs the scripts, the tests' environment has the packages. The server of
# the site, whose port may be taken, is tried in tests/site.
ELSEWHERE = ("scripts/", "pip install", "icdgen docs --serve")
SERVES = ("icdgen sim",)  # in a terminal of its own
FINDINGS = ("icdgen diff", "icdgen import")  # whose exit status tells of what was found


def steps() -> Iterator[tuple[str, str]]:
    """Each command without its remark, and what the README shows of its output."""
    for language, block in re.findall(r"^```(console|sh)\n(.*?)^```", README, re.MULTILINE | re.DOTALL):
        lines = block.splitlines() if language == "sh" else re.split(r"^\$ ", block, flags=re.MULTILINE)
        for step in filter(None, lines):
            command, _, shown = step.partition("\n")
            yield re.sub(r"\s+# .*", "", command).strip(), shown.strip()


@pytest.fixture
def ports() -> dict[str, str]:
    """Free ones for those of the README."""
    with socket.create_server(("127.0.0.1", 0)) as one, socket.create_server(("127.0.0.1", 0)) as other:
        return {"4000": str(one.getsockname()[1]), "4001": str(other.getsockname()[1])}


@pytest.fixture(scope="module")
def clone(tmp_path_factory) -> Path:
    """The files of this repository as they are now, in one of two revisions whose branch is main."""
    folder = tmp_path_factory.mktemp("clone")
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file() and not name.startswith(("generated/", "tests/wrong/", "tests/diff/")):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    name = ["-c", "user.name=A", "-c", "user.email=a@b.c"]
    for words in (["init", "-q", "-b", "main"], ["add", "icd"], [*name, "commit", "-qm", "1"], ["add", "."],
                  [*name, "commit", "-qm", "2"]):  # fmt: skip
        subprocess.run(["git", *words], cwd=folder, check=True)
    return folder


def test_every_command_works_as_it_stands_and_shows_what_is_shown(clone, ports, tmp_path):
    programs = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": programs, "HOME": str(tmp_path)}
    servers, folder, done = [], clone, []
    try:
        for step in steps():
            command, shown = (re.sub(r"\b400[01]\b", lambda found: ports[found[0]], text) for text in step)
            if command.startswith(ELSEWHERE):
                continue
            if command.startswith(SERVES):
                server = subprocess.Popen(
                    ["bash", "-c", f"exec {command}"], cwd=folder, env=env, stdout=subprocess.PIPE, text=True
                )
                servers.append(server)
                assert shown in server.stdout.readline()
                continue
            if " && cd " in command:
                command, _, entered = command.partition(" && cd ")
            else:
                entered = ""
            ran = subprocess.run(
                ["bash", "-c", command], cwd=folder, env=env, capture_output=True, text=True, timeout=600
            )
            got = ran.stdout + ran.stderr
            assert ran.returncode in ((0, 1) if command.startswith(FINDINGS) else (0,)), f"{command}\n{got}"
            assert "error: " not in ran.stderr, f"{command}\n{got}"
            assert shown in got, f"{command}\n{got}"
            folder = folder / entered
            done.append(command)
    finally:
        for server in servers:
            server.kill()
            server.communicate()
    assert len(done) > 25
