"""The example pairs of the rules: ``rules/<code>/previous`` and ``current``, and the
exact report in ``expected.txt``.
"""

from __future__ import annotations

from contextlib import chdir
from pathlib import Path

from icdgen.diff import inputs, report, reports

FOLDER = Path(__file__).parent / "rules"
CASES = sorted(path for path in FOLDER.iterdir() if path.is_dir())


def compared(case: Path) -> report.DiffReport:
    """Return the comparison of `icdgen diff previous current` in the folder of the
    case.
    """
    with chdir(case):
        return report.make_report(*inputs.sides(["previous", "current"], []))


def printed(case: Path) -> str:
    """Return the complete output of `icdgen diff`."""
    return reports.get("text")(compared(case), everything=True)
