"""A generation writes all its output and ends like any other Python program."""

from __future__ import annotations

import subprocess
import sys

import pytest

START = """
import atexit, sys
{before}
sys.argv = ["icdgen", "--lang", "{lang}", "--out", sys.argv[1]]
from icdgen.__main__ import main
main()
"""


def ended(tmp_path, before="", lang="c"):
    """Return status, output and errors of a generation."""
    line = [
        sys.executable,
        "-c",
        START.format(before=before, lang=lang),
        str(tmp_path / "out"),
    ]
    done = subprocess.run(line, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def test_a_generation_ends_with_all_its_output(tmp_path):
    status, out, errors = ended(tmp_path)
    assert (status, errors) == (0, "") and "files written (c)" in out
    assert (tmp_path / "out" / "icdgen.h").read_text().endswith("\n")


def test_the_status_of_misuse_stays(tmp_path):
    status, _, errors = ended(tmp_path, lang="klingon")
    assert status == 2 and "there is no backend `klingon`" in errors


@pytest.mark.parametrize(
    "before",
    [
        "atexit.register(print, 'the end')",
        "sys.setprofile(lambda *any: None)",
        "sys.settrace(lambda *any: None)",
    ],
)
def test_who_has_something_to_do_at_the_end_does_it(tmp_path, before):
    status, out, errors = ended(tmp_path, before)
    assert (status, errors) == (0, "") and "files written (c)" in out
    assert out.endswith("the end\n") == ("atexit" in before)
