"""Rewrite the expected reports: ``python -m tests.diff.update``. Read the difference
before committing it.
"""

from __future__ import annotations

from tests.diff.cases import CASES, printed


def main() -> None:
    for case in CASES:
        expected, now = case / "expected.txt", printed(case)
        if not expected.exists() or expected.read_text(encoding="utf-8") != now:
            expected.write_text(now, encoding="utf-8")
            print(case.name)


if __name__ == "__main__":
    main()
