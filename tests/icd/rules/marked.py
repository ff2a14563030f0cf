"""Findings of one rule with the text that each of them marks."""

from __future__ import annotations

from pathlib import Path

from icdgen.diagnostics import Finding
from tests.icd.files import HEAD, findings


def findings_of(folder: Path, text: str, code: str) -> list[Finding]:
    """Return the findings of a rule in the text, in the order of the file."""
    return [finding for finding in findings(folder, text) if finding.code == code]


def marked_text(text: str, finding: Finding) -> str:
    """Return the part of the text that a finding marks."""
    lines = (text if text.startswith("icdgen:") else HEAD + text).splitlines()
    start = finding.place.column - 1
    return lines[finding.place.line - 1][start : start + finding.place.length]


def reported(folder: Path, text: str, code: str) -> list[tuple[str, str]]:
    """Return (marked text, message) for each finding of a rule in ``demo.yaml``."""
    return [
        (marked_text(text, finding), finding.message)
        for finding in findings_of(folder, text, code)
    ]


def reported_by_line(
    folder: Path, text: str, code: str, first: str
) -> dict[int, list[tuple[str, str]]]:
    """Return (marked text, message) of the findings of a rule by line, counted from 0
    at the line that contains ``first``. Lines without a finding are left out.
    """
    start = (HEAD + text).splitlines()
    (begin,) = (number for number, line in enumerate(start, 1) if first in line)
    by_line: dict[int, list[tuple[str, str]]] = {}
    for finding in findings_of(folder, text, code):
        row = by_line.setdefault(finding.place.line - begin, [])
        row.append((marked_text(text, finding), finding.message))
    return by_line
