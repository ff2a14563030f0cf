"""A comparison -> text, for people and for machines. A format is one module with a function ``report``."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

FORMATS = ("text", "markdown", "json", "sarif", "github", "html")


def get(name: str) -> Callable[..., str]:
    """The function ``report`` of a format, which is one of `FORMATS`."""
    report: Callable[..., str] = import_module(f"{__name__}.{name}").report
    return report
