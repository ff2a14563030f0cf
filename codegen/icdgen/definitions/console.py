"""The report of a definition that was read, as text and as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence

from icdgen.definitions.run import Read
from icdgen.diagnostics import Finding
from icdgen.importer import console
from icdgen.reports.excerpt import printable

_LISTED = 20  # identifiers that are shown; all are in the JSON, and in the ICD


def report(read: Read, colour: bool = False) -> str:
    """Everything to look at, then the figures and the names that got identifiers."""
    found = read.definitions
    return "\n".join([*console.findings(found.troubles, found.file, colour), *map(printable, _summary(read))])


def _summary(read: Read) -> list[str]:
    names, found = read.identifiers, read.definitions
    lines = [
        f"{found.file}: {read.kind}, {read.held} of {found.total} messages held",
        console.severities(found.troubles),
    ]
    if names:
        many = f"{len(names)} names that are no identifiers got one"
        what = many if len(names) > 1 else "1 name that is no identifier got one"
        lines += [f"{what}:", *(f"  {one}" for one in names[:_LISTED])]
        lines += [f"  and {len(names) - _LISTED} more"] if len(names) > _LISTED else []
    return lines


def as_json(read: Read, checked: Sequence[Finding]) -> str:
    """The report for programs; ``checked`` are the findings of `icdgen check` for the files."""
    found = read.definitions
    findings = [{**console.finding_as_json(one), "line": one.spot.line} for one in found.troubles]
    written, remarks = console.files_as_json(read.targets), console.checked_as_json(checked)
    return json.dumps(
        {"definition": found.file, "kind": read.kind, "messages": found.total, "held": read.held, "findings": findings,
         "identifiers": read.identifiers, "files": written, "check": remarks}, indent=2, ensure_ascii=False,
    )  # fmt: skip
