"""Report as workflow commands, which GitHub displays in a pull request."""

from __future__ import annotations

from icdgen import reports
from icdgen.diff.report import DiffReport
from icdgen.diff.reports.findings import of_report


def report(
    report: DiffReport,
    colour: bool = False,
    width: int | None = None,
    everything: bool = False,
) -> str:
    """Return one command for each change."""
    return reports.get("github")(of_report(report), {})
