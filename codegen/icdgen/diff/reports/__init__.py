"""A comparison -> text, for people and for machines. A format is one module with a function ``report``."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

FORMATS = {
    "text": "icdgen.diff.reports.text",
    "markdown": "icdgen.diff.reports.markdown",
    "json": "icdgen.diff.reports.json",
    "sarif": "icdgen.diff.reports.sarif",
    "github": "icdgen.diff.reports.github",
    "html": "icdgen.diff.reports.html",
}


def get(name: str) -> Callable[..., str]:
    """The function ``report`` of a format. Raises `KeyError` for a name that is not in `FORMATS`."""
    report: Callable[..., str] = import_module(FORMATS[name]).report
    return report
