"""Report as SARIF 2.1.0: changes at their new place, with the old place as related
location; accepted changes are suppressed.
"""

from __future__ import annotations

import json
from typing import Any

from icdgen.diff import rule
from icdgen.diff.change import Change
from icdgen.diff.compare import RULES
from icdgen.diff.report import DiffReport
from icdgen.diff.reports.findings import of_change, of_report
from icdgen.reports import sarif


def report(
    report: DiffReport,
    colour: bool = False,
    width: int | None = None,
    everything: bool = False,
) -> str:
    """Return one run of the tool with the applicable rules."""
    findings = list(of_report(report))
    accepted = [of_change(change) for change, _ in report.accepted]
    document = sarif.document([*findings, *accepted], _rule)
    results = document["runs"][0]["results"]
    for result, change in zip(results, report.changes, strict=False):
        _add_properties(result, change)
    for result, (change, entry) in zip(
        results[len(findings) :], report.accepted, strict=True
    ):
        _add_properties(result, change)
        # SARIF 2.1.0, 3.35: services hide suppressed results.
        result["suppressions"] = [
            {"kind": "external", "status": "accepted", "justification": entry.reason}
        ]
    return json.dumps(document, indent=2) + "\n"


def _rule(code: str) -> dict[str, Any]:
    rule_of_code = RULES.get(code)
    if rule_of_code is None:
        return {
            "id": code,
            "shortDescription": {"text": "an accepted change that does not happen"},
        }
    return sarif.described(code, rule_of_code, rule.explain(code))


def _add_properties(result: dict[str, Any], change: Change) -> None:
    result["properties"] = {
        "layer": change.layer,
        "addition": change.addition,
        "sure": round(change.confidence, 3),
    }
    if change.old is not None and change.new is not None:
        where = {
            "id": 1,
            "physicalLocation": sarif.physical(change.old),
            "message": {"text": "as it was"},
        }
        result["relatedLocations"] = [where]
