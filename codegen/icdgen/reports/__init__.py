"""Formats of findings, for people and for programs.

Each format is a module with a function ``report``: findings and the texts of their
files go in, the report comes out as text. `get` returns the function of a format.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Protocol

from icdgen.diagnostics import Finding


class ReportFunction(Protocol):
    """Function that returns findings in a format."""

    def __call__(
        self,
        findings: Iterable[Finding],
        texts: Mapping[str, str],
        colour: bool = False,
    ) -> str: ...


FORMATS = ("text", "json", "github", "sarif")


def get(name: str) -> ReportFunction:
    """Return the function ``report`` of a format in `FORMATS`."""
    report: ReportFunction = import_module(f"{__name__}.{name}").report
    return report
