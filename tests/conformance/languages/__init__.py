"""The languages that the conformance run drives: one module each, which offers ``LANGUAGES``.

A further language brings a module here and a testee in ``testees/``; nothing else is touched.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

TESTEE, SELFTEST, REFERENCE = "testee", "selftest", "reference"


@dataclass(frozen=True)
class Language:
    """How to get at one language's code. ``build`` is given the folder that holds one folder of generated files for each
    backend and an empty folder to work in; it returns the command line that starts the testee (or the self-test)."""

    name: str
    backends: tuple[str, ...]
    tools: tuple[str, ...]  # programs that must be there
    build: Callable[[Path, Path], list[str]]
    kind: str = TESTEE

    def missing(self) -> list[str]:
        """The programs that are not there, or are a version manager's word that they are not."""
        return [tool for tool in self.tools if not _works(tool)]


def _works(tool: str) -> bool:
    return shutil.which(tool) is not None and subprocess.run([tool, "--version"], capture_output=True).returncode == 0


def all_languages() -> dict[str, Language]:
    """Every language by name, in the order of their modules."""
    found: dict[str, Language] = {}
    for info in sorted(iter_modules(__path__), key=lambda i: i.name):
        for language in import_module(f"{__name__}.{info.name}").LANGUAGES:
            found[language.name] = language
    return found
