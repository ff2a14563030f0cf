"""The fixture pairs: ``rules/<code>/previous`` and ``current``, and the exact report in
``expected.txt``.
"""

from __future__ import annotations

from contextlib import chdir
from pathlib import Path

from icdgen.diff import inputs, report, reports

FOLDER = Path(__file__).parent / "rules"
CASES = sorted(path for path in FOLDER.iterdir() if path.is_dir())


def compared(case: Path) -> report.DiffReport:
    """What `icdgen diff previous current` finds, run in the case's folder."""
    with chdir(case):
        return report.make_report(*inputs.sides(["previous", "current"], []))


def printed(case: Path) -> str:
    """What it prints, with everything."""
    return reports.get("text")(compared(case), everything=True)
