"""``python -m tests.xtce [ICD ...]``: XTCE of ICDs read back and compared; without
arguments of many, see `sets`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.xtce.meaning import NOT_SAID
from tests.xtce.readback import Compared, compare
from tests.xtce.sets import sets


def main(arguments: list[str]) -> int:
    whole = Compared()
    with tempfile.TemporaryDirectory() as folder:
        made = (
            {"given": list(map(Path, arguments))} if arguments else sets(Path(folder))
        )
        for number, (name, icds) in enumerate(made.items()):
            found = Compared()
            (out := Path(folder, f"out{number}")).mkdir()
            compare(icds, out, found)
            print(f"{name:<12} {found.nodes:4} files {found.messages:6} messages {found.fields:7} fields"
                  f" {len(found.differences):4} differences {len(found.notes):4} notes")  # fmt: skip
            print("".join(f"    {one}\n" for one in found.differences), end="")
            whole.differences += found.differences
    print("\nnot compared, as XTCE has no word for it:")
    print("".join(f"  - {text}\n" for text in NOT_SAID.values()), end="")
    return 1 if whole.differences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
