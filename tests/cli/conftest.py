"""Runs the command line in this process, as a user would from a folder of theirs."""

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
    """``icdgen("check", "x.yaml")`` -> `Result`; the current folder is ``tmp_path``."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Result:
        capsys.readouterr()
        with pytest.raises(SystemExit) as exit:
            cli.main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Result(exit.value.code, captured.out, captured.err)

    return run
