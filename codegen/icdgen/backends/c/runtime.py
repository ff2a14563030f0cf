"""The headers of the runtime, each in one file: what they include of the runtime's parts stands in its place."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import PurePosixPath

from icdgen.render import Renderer

_INCLUDE = re.compile(r'^#include "(?P<file>[^"]+)"\n', re.MULTILINE)


def header(file: str, made: Mapping[str, str], render: Renderer) -> str:
    """The text of a header of the runtime. ``made`` are parts that come from the ICD, by the path of the part they replace."""
    parts = frozenset(name for name in render.runtime_files() if "/" in name)

    def text(file: str) -> str:
        folder = PurePosixPath(file).parent

        def part(include: re.Match[str]) -> str:
            name = str(folder / include["file"])
            if name not in parts:
                return include[0]
            return made[name] if name in made else text(name)

        return _INCLUDE.sub(part, render.source(file))

    return text(file)
