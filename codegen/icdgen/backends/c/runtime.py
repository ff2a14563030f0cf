"""The files of the runtime, each as one: in the runtime they are made of parts, which a user need not see."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from icdgen.render import Renderer

_PART = re.compile(r'^#include "(?P<file>\w+/\w+\.[ch])"\n', re.MULTILINE)
_GUARDED = re.compile(
    r"\s*#ifndef (?P<guard>\w+_[CH])\n#define (?P=guard)\n\n"
    r"(?:(?:#include \"[^\n]*\n)+\n)?(?P<body>.*)\n#endif /\* (?P=guard) \*/\s*",
    re.DOTALL,
)


def whole(file: str, render: Renderer, made: Mapping[str, str] = MappingProxyType({})) -> str:
    """The text of a file with its parts in place. ``made`` are those that come from the ICD, instead of the runtime's samples."""

    def part(include: re.Match[str]) -> str:
        name = include["file"]
        text = made[name] if name in made else render.source(name)
        guarded = _GUARDED.fullmatch(text)
        return guarded["body"] if guarded else text

    return _PART.sub(part, render.source(file))
