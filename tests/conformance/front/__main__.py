"""Run a testee: the front with the program of a language.

Usage: ``python __main__.py PLAN COMMAND [WORD ...]``. Reads requests from standard
input, one JSON object per line, and writes one answer per line.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

if not __package__:
    sys.path.insert(0, str(Path(__file__).parents[3]))
    sys.path.remove(str(Path(__file__).parent))

from tests.conformance.front import Front
from tests.conformance.front.program import Died, Program


def main() -> int:
    program = Program(sys.argv[2:])
    front = Front(
        json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")), program.ask
    )
    try:
        for line in sys.stdin.buffer:
            sys.stdout.write(json.dumps(front.answer(line.rstrip(b"\r\n"))) + "\n")
            sys.stdout.flush()
    except Died:
        return program.close() or 1
    return program.close()


if __name__ == "__main__":
    sys.exit(main())
