"""What a finding is. How findings are printed is in ``reports``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Place(NamedTuple):
    """A stretch of a source line. ``line`` and ``column`` count from 1; ``length`` is in characters, at least 1."""

    file: str
    line: int = 1
    column: int = 1
    length: int = 1

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class Finding(NamedTuple):
    """One thing that is wrong with the input, where it is and what to do about it."""

    code: str
    message: str
    place: Place
    help: str = ""
    severity: str = "error"  # "error" | "warning" | "note"


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
