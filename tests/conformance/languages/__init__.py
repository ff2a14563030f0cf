"""The languages that the conformance run drives: one module each, which offers
``LANGUAGES``.

A further language brings a module here and a testee in ``testees/``; nothing else is
touched. One of another package brings an entry point of the group
``icdgen.conformance`` that leads to such a list.
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
    """How to get at one language's code.

    ``build`` is given the folder that holds one folder of generated files for each
    backend and an empty folder to work in; it returns the command line that starts the
    testee (or the self-test).
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
        """The programs that are not there, or are a version manager's word that they
        are not.
        """
        return [tool.split()[0] for tool in self.tools if version(tool) is None]


@cache
def version(tool: str) -> str | None:
    """Where the tool lies and what it says of its version; None if it is not there or
    does not work.
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
    """Every language by name, in the order of their modules, then those of other
    packages.
    """
    found: dict[str, Language] = {}
    for info in sorted(iter_modules(__path__), key=lambda i: i.name):
        for language in import_module(f"{__name__}.{info.name}").LANGUAGES:
            found[language.name] = language
    for point in entry_points(group=GROUP):
        for language in point.load():
            found.setdefault(language.name, language)
    return found
