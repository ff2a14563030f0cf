"""Files of the runtime. Each is assembled from several files of the repository.

``runtime/c`` is developed and tested as many small files. A generated package has one
header per purpose: `assemble_file` puts the files that it includes in place of their
``#include`` lines.
"""

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


def assemble_file(
    file: str, render: Renderer, replaced: Mapping[str, str] = MappingProxyType({})
) -> str:
    """Return the text of a file with its parts.

    ``replaced`` are parts that depend on the ICD; the runtime has samples of them.
    """

    def part(include: re.Match[str]) -> str:
        name = include["file"]
        text = replaced[name] if name in replaced else render.source(name)
        # The assembled file has a guard of its own, and the headers that a part
        # includes are in it already.
        guarded = _GUARDED.fullmatch(text)
        return guarded["body"] if guarded else text

    return _PART.sub(part, render.source(file))
