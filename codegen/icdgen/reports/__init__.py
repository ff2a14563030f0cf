"""Findings -> text, for people and for machines. A format is one module with a function ``report``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module

from icdgen.diagnostics import Finding

Report = Callable[[Iterable[Finding], Mapping[str, str], bool], str]

FORMATS = {
    "text": "icdgen.reports.text",
    "json": "icdgen.reports.json",
    "github": "icdgen.reports.github",
    "sarif": "icdgen.reports.sarif",
}


def get(name: str) -> Report:
    """The function ``report`` of a format. Raises `KeyError` for a name that is not in `FORMATS`."""
    return import_module(FORMATS[name]).report


def render(name: str, findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False) -> str:
    """The findings in a format. ``texts`` maps file names to what the files hold; only "text" knows ``colour``.

    Raises `KeyError` for a name that is not in `FORMATS`.
    """
    return get(name)(findings, texts, colour)
