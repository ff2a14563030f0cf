"""Where the shipped templates, runtimes and ICDs lie: in the wheel under ``icdgen/data``, in a checkout at its top."""

from __future__ import annotations

from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent


@cache
def _root() -> Path:
    data = PACKAGE / "data"
    return data if data.is_dir() else PACKAGE.parent.parent


def templates() -> Path:
    """Folder of the shipped templates, one folder a backend."""
    return _root() / "templates"


def runtimes() -> Path:
    """Folder of what generated code runs on, one folder a backend."""
    return _root() / "runtime"


def icds() -> Path:
    """Folder of the shipped ICDs."""
    return _root() / "icd"
