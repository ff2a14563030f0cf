"""Changes as findings, for the formats of services (GitHub and SARIF)."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Finding, Place
from icdgen.diff.accepted import about_stale
from icdgen.diff.change import Change
from icdgen.diff.report import DiffReport


def of_change(change: Change) -> Finding:
    """Return the finding of a change, at its place in the new ICD, otherwise in the old
    ICD.
    """
    place = change.place or Place("icd")
    return Finding(
        change.code,
        f"{change.layer}: {change.message}",
        place,
        " ".join(change.notes),
        change.severity,
    )


def of_report(report: DiffReport) -> Iterator[Finding]:
    """Yield findings about changes, unused entries of accepted changes, and uses in the
    user's sources.
    """
    yield from map(of_change, report.changes)
    yield from map(about_stale, report.stale)
    for use in report.uses or ():
        first = use.changes[0]
        severity = (
            "error"
            if any(change.severity == "error" for change in use.changes)
            else "warning"
        )
        place = Place(use.file, use.line, use.column, len(use.name))
        yield Finding(
            first.code,
            f"`{use.name}` is touched: {'; '.join(use.messages)}",
            place,
            "",
            severity,
        )
