"""Findings of one rule, with the text of the file that each of them marks."""

from __future__ import annotations

from pathlib import Path

from icdgen.diagnostics import Lines
from icdgen.frozen import NamedTuple
from tests.icd.files import loaded


class Reported(NamedTuple):
    """A finding, with line and marked text in place of line and column."""

    line: int
    marked: str
    message: str
    help: str


def reported(folder: Path, text: str, code: str) -> list[Reported]:
    """Return the findings of a rule, in the order of the file."""
    result = loaded(folder, text)
    return [
        Reported(
            finding.place.line,
            Lines(result.texts[finding.place.file]).marked(finding.place),
            finding.message,
            finding.help,
        )
        for finding in result.findings
        if finding.code == code
    ]


def messages(folder: Path, text: str, code: str) -> list[str]:
    """Return the messages of the findings of a rule, in the order of the file."""
    return [each.message for each in reported(folder, text, code)]
