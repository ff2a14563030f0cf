"""The languages of the conformance run.

Each module offers ``LANGUAGES``. To add a language, add a module here and a testee in
``testees/``; nothing else changes. Other packages register an entry point of the group
``icdgen.conformance`` that refers to such a list.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from pkgutil import iter_modules

GROUP = "icdgen.conformance"

TESTEE, SELFTEST, REFERENCE = "testee", "selftest", "reference"


@dataclass(frozen=True)
class Language:
    """How to build one language's code. ``build`` gets the folder with one folder of
    generated files per backend, and an empty folder to work in. It returns the command
    line that starts the testee or self-test.
    """

    name: str
    backends: tuple[str, ...]
    tools: tuple[
        str, ...
    ]  # programs that must be there; with a space in it, the command that says the version, as "go version"
    build: Callable[[Path, Path], list[str]]
    kind: str = TESTEE
    # Whether the program is asked by way of the front; else it answers requests in
    # JSON.
    front: bool = True

    def missing(self) -> list[str]:
        """Return the required programs that are not installed. A stub of a version
        manager counts as not installed.
        """
        return [tool.split()[0] for tool in self.tools if version(tool) is None]


@cache
def version(tool: str) -> str | None:
    """Return the path of a tool and its version, or ``None`` if it is missing or does
    not work.
    """
    program, *words = tool.split()
    path = shutil.which(program)
    if path is None:
        return None
    done = subprocess.run(
        [path, *(words or ["--version"])], capture_output=True, text=True
    )
    return path + done.stdout if done.returncode == 0 else None


def all_languages() -> dict[str, Language]:
    """Return every language by name, in the order of their modules, followed by
    languages of other packages.
    """
    languages: dict[str, Language] = {}
    for info in sorted(iter_modules(__path__), key=lambda i: i.name):
        for language in import_module(f"{__name__}.{info.name}").LANGUAGES:
            languages[language.name] = language
    for point in entry_points(group=GROUP):
        for language in point.load():
            languages.setdefault(language.name, language)
    return languages
