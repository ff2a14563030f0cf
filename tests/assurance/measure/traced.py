"""``python traced.py OUT FOLDER MODULE``: runs a module and writes the executed lines
of the sources of a folder.

A function of which every line was executed is not traced any more, so that the overhead
is small.
"""

from __future__ import annotations

import atexit
import json
import runpy
import sys
from types import CodeType, FrameType
from typing import Any

_unseen: dict[CodeType, set[int]] = {}
_seen: dict[str, set[int]] = {}


def lines_of(code: CodeType) -> set[int]:
    """Return the lines of a code object itself, without nested functions."""
    return {line for _, _, line in code.co_lines() if line}


def watch(folder: str) -> None:
    """Start to record executed lines of the files of the folder."""

    def called(frame: FrameType, event: str, argument: Any) -> Any:
        code = frame.f_code
        if not code.co_filename.startswith(folder):
            return None
        unseen = _unseen.get(code)
        if unseen is None:
            unseen = _unseen[code] = lines_of(code)
        if not unseen:
            return None
        seen = _seen.setdefault(code.co_filename, set())

        def line(frame: FrameType, event: str, argument: Any) -> Any:
            seen.add(frame.f_lineno)
            unseen.discard(frame.f_lineno)
            # Returning None ends the trace of this function.
            return line if unseen else None

        return line(frame, event, argument)

    sys.settrace(called)


def write(out: str) -> None:
    """Write the executed lines of each file."""
    sys.settrace(None)
    with open(out, "w", encoding="utf-8") as file:
        json.dump({name: sorted(lines) for name, lines in _seen.items()}, file)


if __name__ == "__main__":
    out, folder, module = sys.argv[1:4]
    sys.argv[1:] = []
    atexit.register(write, out)
    watch(folder)
    runpy.run_module(module, run_name="__main__", alter_sys=True)
