"""Report about imported definitions, as text and as JSON.

`report` (text) and `as_json` take the `ReadDefinitions` of `icdgen.definitions.run`.
They contain the findings, the number of imported messages and the identifiers that were
replaced, in the text at most 20 of them. ``icdgen import`` prints the report.
`import_results/report.py` has the parts that imports of documents share.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from icdgen.definitions.run import ReadDefinitions
from icdgen.diagnostics import Finding
from icdgen.import_results import report as shared
from icdgen.import_results.targets import Target
from icdgen.reports.excerpt import printable

_LISTED = 20  # identifiers that are shown; all are in the JSON, and in the ICD


def report(reads: Sequence[ReadDefinitions], colour: bool = False) -> str:
    """Return the findings of each definition, followed by its statistics and the
    renamed identifiers.
    """
    shown = [read for read in reads if len(reads) == 1 or _has_content(read)]
    blocks = ["\n".join(_lines(read, colour)) for read in shown]
    if unshown := [
        printable(read.definitions.file) for read in reads if read not in shown
    ]:
        names = ", ".join(unshown[:_LISTED]) + (
            f" and {len(unshown) - _LISTED} more" if len(unshown) > _LISTED else ""
        )
        blocks.append(
            f"without messages of {'its' if len(unshown) == 1 else 'their'} own: {names}"
        )
    return "\n\n".join(blocks)


def _has_content(read: ReadDefinitions) -> bool:
    """Return whether a definition has messages, or findings about them."""
    definitions = read.definitions
    return bool(read.trees or definitions.total or definitions.import_findings)


def _lines(read: ReadDefinitions, colour: bool) -> list[str]:
    definitions = read.definitions
    return [
        *shared.findings(definitions.import_findings, definitions.file, colour),
        *map(printable, _summary(read)),
    ]


def _summary(read: ReadDefinitions) -> list[str]:
    names, definitions = read.identifiers, read.definitions
    lines = [
        f"{definitions.files}: {read.kind}, {read.imported} of {definitions.total} messages imported",
        shared.severities(definitions.import_findings),
    ]
    if names:
        many = f"{len(names)} names that are not valid identifiers got one"
        what = (
            many if len(names) > 1 else "1 name that is not a valid identifier got one"
        )
        lines += [f"{what}:", *(f"  {name}" for name in names[:_LISTED])]
        lines += [f"  and {len(names) - _LISTED} more"] if len(names) > _LISTED else []
    return lines


def as_json(
    reads: Sequence[ReadDefinitions],
    targets: Sequence[Target],
    checked: Sequence[Finding],
) -> str:
    """Return the report as JSON.

    ``checked`` are the findings of `icdgen check` for the generated files.

    The keys of a single definition are at the top level. Several definitions form a
    list under the key `definitions`.
    """
    listed = [_as_item(read) for read in reads]
    head = listed[0] if len(listed) == 1 else {"definitions": listed}
    tail = {
        "files": shared.files_as_json(targets),
        "check": shared.checked_as_json(checked),
    }
    return json.dumps({**head, **tail}, indent=2, ensure_ascii=False)


def _as_item(read: ReadDefinitions) -> dict[str, Any]:
    definitions = read.definitions
    findings = []
    for finding in definitions.import_findings:
        place = {"file": finding.spot.file} if finding.spot.file else {}
        findings.append(
            {**shared.finding_as_json(finding), **place, "line": finding.spot.line}
        )
    return {"definition": definitions.file, "kind": read.kind, "messages": definitions.total, "held": read.imported,
            "findings": findings, "identifiers": read.identifiers}  # fmt: skip
