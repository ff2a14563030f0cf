"""Rewrite the expected reports: ``python -m tests.wrong.update``. Read the difference
before committing it.
"""

from __future__ import annotations

from tests.wrong.cases import CASES, name, report


def main() -> None:
    for case in CASES:
        expected, now = case.with_suffix(".txt"), report(case)
        if not expected.exists() or expected.read_text(encoding="utf-8") != now:
            expected.write_text(now, encoding="utf-8")
            print(name(case))


if __name__ == "__main__":
    main()
