"""Findings, and the source text to which they refer. Package ``reports`` prints them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")  # what YAML counts as the end of a line


class Place(NamedTuple):
    """A stretch of a source line. ``line`` and ``column`` count from 1; ``length`` is in characters, at least 1."""

    file: str
    line: int = 1
    column: int = 1
    length: int = 1

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class Lines:
    """The lines of a source text, split when a line is first requested."""

    def __init__(self, text: str) -> None:
        self._text = text.removeprefix("\ufeff")
        self._lines: list[str] | None = None

    def __getitem__(self, number: int) -> str | None:
        """Line ``number``, counted from 1; None if the text has no such line."""
        if self._lines is None:
            self._lines = _BREAK.split(self._text)
        return self._lines[number - 1] if 1 <= number <= len(self._lines) else None

    def marked(self, place: Place) -> str:
        """Return the text at a place; empty if there is no such line."""
        return (self[place.line] or "")[place.column - 1 : place.column - 1 + place.length]


class Fix(NamedTuple):
    """A correction: ``text`` replaces what the source has at ``place``."""

    place: Place
    text: str


class Related(NamedTuple):
    """Another place that a finding is about, such as the first of two equal names, and what stands there."""

    place: Place
    label: str


class Finding(NamedTuple):
    """One thing that is wrong with the input, where it is and what to do about it."""

    code: str
    message: str
    place: Place
    help: str = ""
    severity: str = "error"  # "error" | "warning" | "note"
    fix: Fix | None = None  # where the correction is known
    related: Related | None = None


class Findings(Exception):
    """Raised where work cannot go on because of what is wrong in the input; carries everything found so far."""

    def __init__(self, findings: list[Finding]) -> None:
        super().__init__(f"{len(findings)} finding(s)")
        self.findings = findings


def has_errors(findings: Iterable[Finding]) -> bool:
    """Whether one of the findings is an error."""
    return any(finding.severity == "error" for finding in findings)


def in_order(findings: list[Finding]) -> list[Finding]:
    """Sorted by place, so that a reader works through a file from top to bottom; duplicates dropped."""
    return sorted(set(findings), key=lambda f: (f.place, f.code, f.message))
