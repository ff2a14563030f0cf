"""Fixture that runs the command line in this process, in the folder of a user."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from icdgen import cli


@dataclass
class Result:
    status: int
    out: str
    err: str


@pytest.fixture
def icdgen(tmp_path, monkeypatch, capsys):
    """Return a function ``icdgen("check", "x.yaml")`` -> `Result`. The current folder
    is ``tmp_path``.
    """
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Result:
        capsys.readouterr()
        with pytest.raises(SystemExit) as exit:
            cli.main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Result(exit.value.code, captured.out, captured.err)

    return run
