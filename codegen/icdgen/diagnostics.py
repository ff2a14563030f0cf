"""Findings and their places in source texts.

The package ``icdgen.reports`` formats them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from icdgen.frozen import NamedTuple

# Line breaks of YAML 1.1, section 4.2, which PyYAML implements.
_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")


class Place(NamedTuple):
    """A range of a source line.

    ``line`` and ``column`` count from 1; ``length`` is in characters, at least 1.
    """

    file: str
    line: int = 1
    column: int = 1
    length: int = 1

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class Lines:
    """Lines of a source text, which is split on the first access."""

    def __init__(self, text: str) -> None:
        self._text = text.removeprefix("\ufeff")
        self._lines: list[str] | None = None

    def __getitem__(self, number: int) -> str | None:
        """Return line ``number``, counted from 1; None if the text has no such line."""
        if self._lines is None:
            self._lines = _BREAK.split(self._text)
        return self._lines[number - 1] if 1 <= number <= len(self._lines) else None

    def marked(self, place: Place) -> str:
        """Return the text at a place; empty if there is no such line."""
        return (self[place.line] or "")[
            place.column - 1 : place.column - 1 + place.length
        ]


class Fix(NamedTuple):
    """A correction: ``text`` replaces the text at ``place``."""

    place: Place
    text: str


class Remedy(NamedTuple):
    """Help for a mistake; ``fix`` is the correct key or value as YAML, if it is known."""

    help: str
    fix: str = ""


class Related(NamedTuple):
    """A second place of a finding, such as the first of two equal names, with a label."""

    place: Place
    label: str


class Finding(NamedTuple):
    """A fault of the input: what is wrong, where, and what to do."""

    code: str
    message: str
    place: Place
    help: str = ""
    severity: str = "error"  # "error" | "warning" | "note"
    fix: Fix | None = None  # None if the correction is unknown
    related: Related | None = None


class Findings(Exception):
    """The input has errors with which work cannot continue. Has all findings so far."""

    def __init__(self, findings: list[Finding]) -> None:
        super().__init__(f"{len(findings)} finding(s)")
        self.findings = findings


def has_errors(findings: Iterable[Finding]) -> bool:
    """Return whether one of the findings is an error."""
    return any(finding.severity == "error" for finding in findings)


def in_order(findings: list[Finding]) -> list[Finding]:
    """Return the findings sorted by place, without duplicates."""
    return sorted(
        set(findings),
        key=lambda finding: (finding.place, finding.code, finding.message),
    )
