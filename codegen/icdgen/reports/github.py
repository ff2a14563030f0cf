"""Findings as workflow commands, which GitHub shows at the lines of a pull request.

The runner of GitHub Actions reads them from the output of a step.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from icdgen.diagnostics import Finding
from icdgen.reports.excerpt import printable

COMMANDS = {"error": "error", "warning": "warning", "note": "notice"}


def report(
    findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False
) -> str:
    """Return one command per line; an empty text without findings."""
    return "".join(_command(finding) + "\n" for finding in findings)


def _command(finding: Finding) -> str:
    """Return the workflow command of a finding."""
    place = finding.place
    properties = {
        "title": f"icdgen {finding.code}",
        "file": place.file,
        "line": place.line,
        "endLine": place.line,
        "col": place.column,
        "endColumn": place.column + place.length,
    }
    parameters = ",".join(
        f"{key}={_property(str(value))}" for key, value in properties.items()
    )
    text = f"{finding.code}: {finding.message}" + (
        f"\nhelp: {finding.help}" if finding.help else ""
    )
    # Only the line breaks of the text itself remain; others could inject a command.
    text = "\n".join(map(printable, text.split("\n")))
    return f"::{COMMANDS[finding.severity]} {parameters}::{_data(text)}"


def _data(text: str) -> str:
    """Return the message of a command, escaped as in the toolkit of GitHub Actions."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """Return the value of a property, which also escapes the separators of properties."""
    return _data(text).replace(":", "%3A").replace(",", "%2C")
