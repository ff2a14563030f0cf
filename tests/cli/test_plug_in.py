"""A failing backend of another package is named with its entry point, without a
traceback.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

BACKEND = """\
from pathlib import PurePosixPath


class Backend:
    name = "other"
    reserved = frozenset()

    def files(self, icd, render):
        yield PurePosixPath("first.txt"), "first"
        {statement}

    def identifiers(self, icd):
        return iter(())
"""


def run(folder: Path, demo: Path, source: str) -> subprocess.CompletedProcess[str]:
    (folder / "other_backend.py").write_text(source)
    info = folder / "icdgen_other-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: icdgen-other\nVersion: 1.0\n"
    )
    (info / "entry_points.txt").write_text(
        "[icdgen.backends]\nother = other_backend:Backend\n"
    )
    command = [
        sys.executable,
        "-m",
        "icdgen",
        "--lang",
        "other",
        "--out",
        str(folder / "out"),
        str(demo),
    ]
    return subprocess.run(
        command,
        env={**os.environ, "PYTHONPATH": str(folder)},
        cwd=folder,
        capture_output=True,
        text=True,
    )


def test_a_backend_of_another_package_generates(tmp_path, demo):
    result = run(
        tmp_path,
        demo,
        BACKEND.format(statement="yield PurePosixPath('a/b.txt'), icd.nodes[0].name"),
    )
    assert (result.returncode, result.stderr) == (0, "")
    assert (tmp_path / "out/a/b.txt").read_text() == "demo"


@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ("raise KeyError('speed')", "failed: KeyError: 'speed'"),
        ("yield 'a.txt', 'text'", "failed: TypeError: `files` gives pairs"),
        ("yield None", "failed: TypeError: "),
        ("render('absent.j2')", ""),
    ],
)
def test_a_failing_backend_is_named_and_nothing_is_written(
    tmp_path, demo, statement, expected
):
    result = run(tmp_path, demo, BACKEND.format(statement=statement))
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert expected in result.stderr
    if expected:
        assert (
            "the backend `other` of icdgen-other (entry point `other_backend:Backend`)"
            in result.stderr
        )
        assert "report it to its makers" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "source", ["import no_such_module\n", "class Backend:\n    pass\n", "Backend = 1\n"]
)
def test_a_backend_that_cannot_be_loaded_is_named(tmp_path, demo, source):
    result = run(tmp_path, demo, source)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert "entry point `other_backend:Backend`) cannot be loaded: " in result.stderr
