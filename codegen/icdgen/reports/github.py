"""Findings as workflow commands: GitHub shows them beside the lines of a pull request."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from icdgen.diagnostics import Finding
from icdgen.reports.excerpt import printable

COMMANDS = {"error": "error", "warning": "warning", "note": "notice"}


def report(findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False) -> str:
    """One command a line; nothing where there is no finding."""
    return "".join(_one(f) + "\n" for f in findings)


def _one(finding: Finding) -> str:
    place = finding.place
    properties = {
        "title": f"icdgen {finding.code}",
        "file": place.file,
        "line": place.line,
        "endLine": place.line,
        "col": place.column,
        "endColumn": place.column + place.length,
    }
    said = ",".join(f"{key}={_property(str(value))}" for key, value in properties.items())
    text = f"{finding.code}: {finding.message}" + (f"\nhelp: {finding.help}" if finding.help else "")
    text = "\n".join(map(printable, text.split("\n")))
    return f"::{COMMANDS[finding.severity]} {said}::{_data(text)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
