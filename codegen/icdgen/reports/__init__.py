"""Findings -> text, for people and for machines. A format is one module with a function ``report``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Protocol

from icdgen.diagnostics import Finding


class Report(Protocol):
    """Findings in a format."""

    def __call__(self, findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False) -> str: ...


FORMATS = {
    "text": "icdgen.reports.text",
    "json": "icdgen.reports.json",
    "github": "icdgen.reports.github",
    "sarif": "icdgen.reports.sarif",
}


def get(name: str) -> Report:
    """The function ``report`` of a format. Raises `KeyError` for a name that is not in `FORMATS`."""
    report: Report = import_module(FORMATS[name]).report
    return report


def render(name: str, findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False) -> str:
    """The findings in a format. ``texts`` maps file names to what the files hold; only "text" knows ``colour``.

    Raises `KeyError` for a name that is not in `FORMATS`.
    """
    return get(name)(findings, texts, colour)
