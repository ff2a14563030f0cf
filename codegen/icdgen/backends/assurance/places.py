"""How files and lines are named in the papers: not by where they lie on somebody's machine."""

from __future__ import annotations

import os
from collections.abc import Iterable

from icdgen.backends.assurance.paper import ranges
from icdgen.backends.assurance.trace import Noticed
from icdgen.diagnostics import Place


class Files:
    """The files that the ICDs were read from, by their paths below the folder that holds them all."""

    def __init__(self, files: Iterable[str]) -> None:
        folders = {os.path.dirname(os.path.abspath(file)) for file in files}
        self._top = os.path.commonpath(folders) if folders else ""

    def name(self, file: str) -> str:
        return os.path.relpath(os.path.abspath(file), self._top).replace(os.sep, "/") if file else ""

    def line(self, place: Place) -> str:
        """``errata/demo.yaml:12``; nothing of what was not read from a file."""
        return f"{self.name(place.file)}:{place.line}" if place.file else ""


def vectors(noticed: Noticed) -> list[str]:
    """Files of vectors and lines of these: ``demo.json 31-38 40``."""
    return [f"{node}.json {ranges(numbers)}" for node, numbers in noticed.items()]
