"""``python traced.py OUT FOLDER MODULE``: runs a module and writes which lines of the
sources of a folder were executed.

A function of which every line was seen is not watched any more, so that this costs
little.
"""

from __future__ import annotations

import atexit
import json
import runpy
import sys
from types import CodeType, FrameType
from typing import Any

_left: dict[CodeType, set[int]] = {}
_seen: dict[str, set[int]] = {}


def lines_of(code: CodeType) -> set[int]:
    """The lines of a piece of code itself, without what is defined in it."""
    return {line for _, _, line in code.co_lines() if line}


def watch(folder: str) -> None:
    """Begins to note lines of the files of the folder."""

    def called(frame: FrameType, event: str, argument: Any) -> Any:
        code = frame.f_code
        if not code.co_filename.startswith(folder):
            return None
        left = _left.get(code)
        if left is None:
            left = _left[code] = lines_of(code)
        if not left:
            return None
        seen = _seen.setdefault(code.co_filename, set())

        def line(frame: FrameType, event: str, argument: Any) -> Any:
            seen.add(frame.f_lineno)
            left.discard(frame.f_lineno)
            return line if left else None

        return line(frame, event, argument)

    sys.settrace(called)


def write(out: str) -> None:
    """The lines of each file."""
    sys.settrace(None)
    with open(out, "w", encoding="utf-8") as file:
        json.dump({name: sorted(lines) for name, lines in _seen.items()}, file)


if __name__ == "__main__":
    out, folder, module = sys.argv[1:4]
    sys.argv[1:] = []
    atexit.register(write, out)
    watch(folder)
    runpy.run_module(module, run_name="__main__", alter_sys=True)
