"""Report as one JSON object, a stable format for programs; ``diff.schema.json`` defines
it.

`report` returns a `DiffReport` as text and `document` returns it as a tree. All changes
are included, also accepted ones, with their reason. The parameters ``colour``,
``width`` and ``everything`` exist in all formats and have no effect here.
"""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path

from icdgen.diagnostics import Place
from icdgen.diff.accepted import Acceptance
from icdgen.diff.change import Change
from icdgen.diff.compatibility import DirectionCompatibility
from icdgen.diff.generated import Name
from icdgen.diff.report import DiffReport

FORMAT = 1
SCHEMA = Path(__file__).parent.parent.with_name("diff.schema.json")


def report(
    report: DiffReport,
    colour: bool = False,
    width: int | None = None,
    everything: bool = False,
) -> str:
    """Return all changes as JSON, accepted changes included."""
    return json.dumps(document(report), indent=1) + "\n"


def document(report: DiffReport) -> dict[str, object]:
    """Return the report as a tree for `json.dumps`."""
    reasons = {id(change): entry.reason for change, entry in report.accepted}
    generated = report.comparison.context.generated
    result: dict[str, object] = {
        "format": FORMAT,
        "old": report.old.label,
        "new": report.new.label,
        "version": report.step._asdict(),
        "counts": report.counts(),
        "compatibility": [_direction(direction) for direction in report.directions],
        "changes": [
            _change(c, reasons.get(id(c)), generated.old(c.pair))
            for c in report.comparison.changes
        ],
        "stale": [_stale(entry) for entry in report.stale],
    }
    if report.uses is not None:
        numbers = {
            id(change): number
            for number, change in enumerate(report.comparison.changes)
        }
        result["uses"] = [
            use._asdict() | {"changes": sorted(numbers[id(c)] for c in use.changes)}
            for use in report.uses
        ]
    return result


def _direction(direction: DirectionCompatibility) -> dict[str, object]:
    return {
        "key": direction.key,
        "question": direction.question,
        "verdict": direction.verdict,
        "frames_total": direction.total,
        "general": direction.general,
        "frames": [frame._asdict() for frame in direction.frames],
    }


def _change(
    change: Change, reason: str | None, names: tuple[Name, ...]
) -> dict[str, object]:
    names_by_language = {
        language: [name.text for name in group]
        for language, group in groupby(names, lambda name: name.language)
    }
    row: dict[str, object] = {
        "code": change.code,
        "layer": change.layer,
        "severity": change.severity,
        "addition": change.addition,
        "breaking": change.breaks,
        "message": change.message,
        "where": {key: value for key, value in change.where._asdict().items() if value},
        "was": change.was,
        "now": change.now,
        "old": _place(change.old),
        "new": _place(change.new),
        "details": change.details,
        # Three digits are enough to compare matches.
        "sure": round(change.confidence, 3),
        "errata": change.errata,
        "generated": names_by_language,
    }
    return row if reason is None else row | {"accepted": reason}


def _place(place: Place | None) -> dict[str, object] | None:
    return place._asdict() if place is not None else None


def _stale(entry: Acceptance) -> dict[str, object]:
    return {
        "code": entry.code,
        **entry.criteria,
        "reason": entry.reason,
        "place": _place(entry.place),
    }
