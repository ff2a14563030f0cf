"""Report formats of a comparison, for readers and for programs.

A format is one module with a function ``report``.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

FORMATS = ("text", "markdown", "json", "sarif", "github", "html")


def get(name: str) -> Callable[..., str]:
    """Return the function ``report`` of a format, one of `FORMATS`."""
    report: Callable[..., str] = import_module(f"{__name__}.{name}").report
    return report
