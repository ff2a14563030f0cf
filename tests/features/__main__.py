"""``python -m tests.features`` measures the outputs and writes
docs/reference/features.md.

It prints each output that lacks a feature without a reason, or has one in spite of a
reason; the exit status is 1 if there is one.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.features.data import features
from tests.features.measure import row
from tests.features.page import PAGE, page


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        rows = {
            feature.name: (feature, row(feature, Path(folder)))
            for feature in features()
        }
    text, errors = page(rows), 0
    if not PAGE.exists() or PAGE.read_text("utf-8") != text:
        PAGE.write_text(text, "utf-8")
        print("written: docs/reference/features.md")
    for name, (feature, cells) in rows.items():
        for output, cell in cells.items():
            if cell.has == (output in feature.without):
                errors += 1
                print(
                    f"{name}: {output} {'has it now' if cell.has else f'lacks it, without a reason {cell.reason}'}"
                )
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
