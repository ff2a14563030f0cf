"""``python -m tests.xtce [ICD ...]`` generates XTCE, imports it again and compares the
models.

Without arguments it takes the ICDs of `sets`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.xtce.meaning import NOT_COMPARED
from tests.xtce.readback import Comparison, compare
from tests.xtce.sets import sets


def main(arguments: list[str]) -> int:
    total = Comparison()
    with tempfile.TemporaryDirectory() as folder:
        icds_by_set = (
            {"given": list(map(Path, arguments))} if arguments else sets(Path(folder))
        )
        for number, (name, icds) in enumerate(icds_by_set.items()):
            comparison = Comparison()
            (out := Path(folder, f"out{number}")).mkdir()
            compare(icds, out, comparison)
            print(f"{name:<12} {comparison.nodes:4} files {comparison.messages:6} messages {comparison.fields:7} fields"
                  f" {len(comparison.differences):4} differences {len(comparison.notes):4} notes")  # fmt: skip
            print(
                "".join(f"    {difference}\n" for difference in comparison.differences),
                end="",
            )
            total.differences += comparison.differences
    print("\nnot compared, because XTCE cannot represent it:")
    print("".join(f"  - {text}\n" for text in NOT_COMPARED.values()), end="")
    return 1 if total.differences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
