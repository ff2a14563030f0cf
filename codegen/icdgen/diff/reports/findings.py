"""Changes as findings, for the formats that services know."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Finding, Place
from icdgen.diff.accepted import about_stale
from icdgen.diff.change import Change
from icdgen.diff.report import Report


def of_change(change: Change) -> Finding:
    """At its place in the new ICD, or in the old one where it is gone from the new."""
    place = change.place or Place("icd")
    return Finding(change.code, f"{change.layer}: {change.message}", place, " ".join(change.notes), change.severity)


def of_report(report: Report) -> Iterator[Finding]:
    """Open changes, entries that no longer apply, and uses in a user's sources."""
    yield from map(of_change, report.changes)
    yield from map(about_stale, report.stale)
    for use in report.uses or ():
        first = use.changes[0]
        severity = "error" if any(change.severity == "error" for change in use.changes) else "warning"
        place = Place(use.file, use.line, use.column, len(use.name))
        yield Finding(first.code, f"`{use.name}` is touched: {'; '.join(use.messages)}", place, "", severity)
