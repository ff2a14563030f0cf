"""Rewrite the expected outputs: ``python -m tests.fmt.update``. Read the difference
before committing it.
"""

from __future__ import annotations

from icdgen.icd.fmt import format_text
from tests.fmt.test_layout import CASES, expected


def update() -> None:
    """Format every ``*.in.yaml`` of this folder into its ``*.out.yaml``."""
    for case in CASES:
        text = format_text(case.read_bytes().decode("utf-8"), case.name)
        expected(case).write_bytes(text.encode("utf-8"))


if __name__ == "__main__":
    update()
