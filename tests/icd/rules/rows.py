"""Findings of a rule about a small ICD, as rows of text, for the tests of rules."""

from __future__ import annotations

import re
from contextlib import chdir
from pathlib import Path

from icdgen.icd.load import load
from tests.icd.files import write

_FILE = re.compile(r"^# ([a-z_]+\.yaml)\n", re.MULTILINE)


def rows(folder: Path, text: str, code: str) -> list[str]:
    """Return ``line:column message`` of each finding with a code, in order.

    The name of the file precedes the place if it is not ``demo.yaml``. ``text`` is that
    of `tests.icd.files.write`. Names in generated code are not checked, which is
    faster.
    """
    write(folder, text)
    with chdir(folder):
        loaded = load([Path("demo.yaml"), *map(Path, _FILE.findall(text))])
    return [
        f"{place.file}:".removeprefix("demo.yaml:")
        + f"{place.line}:{place.column} {finding.message}"
        for finding in loaded.findings
        if finding.code == code and (place := finding.place)
    ]


def messages(folder: Path, text: str, code: str) -> list[str]:
    """Return the messages of the findings with a code, in order."""
    return [row.partition(" ")[2] for row in rows(folder, text, code)]
