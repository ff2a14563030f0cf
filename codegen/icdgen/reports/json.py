"""Findings as one JSON object, a stable format for programs."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping

from icdgen.diagnostics import Finding


def report(
    findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False
) -> str:
    """Return ``{"findings": [{"code", "severity", "message", ...}], "counts": {"error":
    2, ...}}``.
    """
    findings = list(findings)
    counts = Counter(finding.severity for finding in findings)
    document = {
        "findings": list(map(_object, findings)),
        "counts": {
            severity: counts[severity] for severity in ("error", "warning", "note")
        },
    }
    return json.dumps(document, indent=2) + "\n"


def _object(finding: Finding) -> dict[str, object]:
    """Return a finding as values for JSON."""
    place = finding.place
    result: dict[str, object] = {
        "code": finding.code,
        "severity": finding.severity,
        "message": finding.message,
        "help": finding.help,
        "file": place.file,
        "line": place.line,
        "column": place.column,
        "length": place.length,
    }
    if finding.fix is not None:
        result["fix"] = finding.fix.place._asdict() | {"text": finding.fix.text}
    if finding.related is not None:
        result["related"] = finding.related.place._asdict() | {
            "label": finding.related.label
        }
    return result
