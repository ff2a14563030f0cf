"""Report of an import as text and as JSON.

`report` and `as_json` take the `Result` of `icdgen.importer.run` and return text;
`commands/import_.py` prints it. `refused_as_json` reports in the same form why nothing
can be imported. `summary` is also part of the web page (`html`).
`import_results/report.py` has the parts that imports of definitions share.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

from icdgen.diagnostics import Finding
from icdgen.import_results import report as shared
from icdgen.import_results.findings import CERTAIN, DOUBTFUL, LIKELY, ImportFinding
from icdgen.importer.document import SourceTable
from icdgen.importer.model import BACKGROUND, UNKNOWN
from icdgen.importer.run import Result
from icdgen.importer.words import table_name
from icdgen.wording import count


def report(result: Result, colour: bool = False) -> str:
    """Print the findings and the summary of an import."""
    return "\n".join(
        shared.findings(result.import_findings, result.document.file, colour)
        + summary(result)
    )


def summary(result: Result) -> list[str]:
    """Return the numbers of tables by kind and certainty, then a line for each file."""
    kinds = Counter(entry.what for entry in result.survey.results)
    parts = []
    for kind in ("message", "enumeration", "list"):
        if kinds[kind]:
            parts.append(count(kinds[kind], kind))
    for kind in ("loggable frames", BACKGROUND, UNKNOWN):  # without a plural
        if kinds[kind]:
            parts.append(f"{kinds[kind]} {kind}")
    pages = f"{count(result.document.pages, 'page')}, " if result.document.pages else ""
    sure = result.sureness()
    return [
        f"{pages}{count(len(result.tables), 'table')}"
        + (": " if parts else "")
        + ", ".join(parts),
        "read: "
        + (
            ", ".join(
                f"{sure[certainty]} {certainty}"
                for certainty in (CERTAIN, LIKELY, DOUBTFUL)
                if sure[certainty]
            )
            or "none"
        ),
        shared.severities(result.import_findings),
    ]


def as_json(result: Result, checked: Sequence[Finding]) -> str:
    """Return tables and findings as JSON.

    ``checked`` are the findings of `icdgen check` for the files.
    """
    entries = [
        _table_as_json(entry.table, entry.what, result.sure_of(entry.table))
        for entry in result.survey.results
    ]
    import_findings = [_finding_as_json(finding) for finding in result.import_findings]
    written = shared.files_as_json(result.targets)
    return json.dumps(
        {"manual": result.document.file, "pages": result.document.pages, "tables": entries, "findings": import_findings,
         "files": written, "check": shared.checked_as_json(checked)}, indent=2, ensure_ascii=False,
    )  # fmt: skip


def _table_as_json(table: SourceTable, what: str, sure: str) -> dict[str, Any]:
    return {
        "table": _table(table.label),
        "caption": table.caption,
        "page": table.page,
        "line": table.line,
        "is": what,
        "sure": sure,
    }


def _finding_as_json(finding: ImportFinding) -> dict[str, Any]:
    spot = finding.spot
    place = {"table": _table(spot.table), "page": spot.page, "line": spot.line}
    return {**shared.finding_as_json(finding), **place}


def _table(number: int | None) -> int | str | None:
    """Return the number of a table; that of a chapter's table is a text, ``4-12``."""
    name = table_name(number) if number is not None else ""
    return int(name) if name.isdigit() else name or None


def refused_as_json(manual: str, findings: list[Finding]) -> str:
    """Return the JSON report of a manual, a profile or an ICD that cannot be read."""
    import_findings = [
        {"code": f.code, "severity": f.severity, "message": f.message, "help": f.help, "file": f.place.file,
         "table": None, "page": None, "line": f.place.line}
        for f in findings
    ]  # fmt: skip
    report = {
        "manual": manual,
        "pages": None,
        "tables": [],
        "findings": import_findings,
        "files": [],
        "check": [],
    }
    return json.dumps(report, indent=2, ensure_ascii=False)
