"""Help and errors are whole, however narrow the terminal."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("width", [40, 80, 200])
def test_no_summary_of_a_command_is_cut_off(width):
    result = subprocess.run(
        [sys.executable, "-m", "icdgen", "--help"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "COLUMNS": str(width)},
    )
    text = " ".join(result.stdout.partition("Commands:")[2].partition("Languages:")[0].split())
    assert "..." not in text
    for words in (
        "those of icdgen.toml, else those shipped.",
        "on the wire, in meaning, in generated names, in words only.",
    ):
        assert words in text


def test_each_line_of_several_errors_says_that_it_is_one(icdgen):
    result = icdgen("encode", "cubeacp", "Set Wheel Speed", "x=1", "y=999999", "w=2")
    errors = [line for line in result.err.splitlines() if not line.startswith("  help:")]
    assert result.status == 2 and len(errors) == 2, result.err
    assert all(line.startswith("icdgen: error: ") for line in errors)
