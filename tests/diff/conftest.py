"""Two releases of a small ICD, side by side."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen import cli
from tests.cli.conftest import Result
from tests.conftest import DEMO

LATER = DEMO.replace("formula: raw*0.01", "formula: raw*0.001", 1).replace("id: 20", "id: 21")


@pytest.fixture
def releases(tmp_path) -> tuple[Path, Path]:
    """Folders ``old`` and ``new``: a factor and an id differ."""
    for name, text in (("old", DEMO), ("new", LATER)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "demo.yaml").write_text(text, encoding="utf-8")
    return tmp_path / "old", tmp_path / "new"


@pytest.fixture
def icdgen(tmp_path, monkeypatch, capsys):
    """``icdgen("diff", "old", "new")`` -> `Result`; the current folder is ``tmp_path``."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Result:
        capsys.readouterr()
        with pytest.raises(SystemExit) as exit:
            cli.main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Result(exit.value.code, captured.out, captured.err)

    return run
