"""Draw the complete manual of the shipped ICDs in each layout, import it and count the
differences.

Run ``python -m tests.importer.whole [LAYOUT ...]``. It takes minutes; without names it
tests the eight layouts of `further.py`.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from tests.importer.compare import differences
from tests.importer.conftest import imported
from tests.importer.manuals import content
from tests.importer.manuals.further import FURTHER
from tests.importer.manuals.layouts import LAYOUTS
from tests.importer.test_layouts import TITLES


def main() -> int:
    """Print one line per layout with its differences below. Returns 1 if there are any."""
    failed = False
    for name in sys.argv[1:] or FURTHER:
        manual = content.manual(
            content.shipped("common", "bootloader", "cubeacp"), TITLES
        )
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "manual.pdf")
            (FURTHER | LAYOUTS)[name](manual, path)
            start = time.process_time()
            result, got = imported(path)
        took = time.process_time() - start
        texts = [
            line
            for node, tree in manual.trees.items()
            for line in differences(tree, got.get(node, {}))
        ]
        print(
            f"{name}: {len(texts)} differences, {result.document.pages} pages, {took:.0f} s, {dict(result.sureness())}"
        )
        print(
            *(f"    {line}" for line in texts),
            sep="\n",
            end="\n" * bool(texts),
            flush=True,
        )
        failed = failed or bool(texts)
    return failed


if __name__ == "__main__":
    sys.exit(main())
