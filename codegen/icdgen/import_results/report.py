"""Reports of an import of a manual or of definitions, as text and for JSON.

`importer/console.py` and `definitions/console.py` use these parts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from icdgen.diagnostics import Finding
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.import_results.targets import Target
from icdgen.reports.excerpt import printable
from icdgen.wording import count

_COLOURS = {"error": "31;1", "warning": "33;1", "note": "36"}


def where(file: str, spot: SourcePlace) -> str:
    """Return a place such as ``manual.pdf, page 12`` or ``manual.txt:482``."""
    file = spot.file or file
    text = f"{file}:{spot.line}" if spot.line is not None else file
    return f"{text}, page {spot.page}" if spot.page is not None else text


def findings(
    import_findings: Sequence[ImportFinding], file: str, colour: bool = False
) -> list[str]:
    """Return a block for each error and warning, then a line for each note."""
    lines: list[str] = []
    notes: list[ImportFinding] = []
    for import_finding in import_findings:
        if import_finding.severity == "note":
            notes.append(import_finding)
            continue
        lines += [
            _paint(
                f"{import_finding.severity}[{import_finding.code}]",
                import_finding.severity,
                colour,
            )
            + f": {printable(import_finding.message)}",
            f"  --> {printable(where(file, import_finding.spot))}",
        ]
        lines += [f"  = rule: {import_finding.place}"] if import_finding.place else []
        lines += (
            [f"  = help: {printable(import_finding.help)}"]
            if import_finding.help
            else []
        )
        lines.append("")
    if notes:
        note = _paint("note", "note", colour)
        lines += [
            f"{note}[{t.code}] {printable(t.spot.place or 'the document')}: {printable(t.message)}"
            for t in notes
        ]
        lines.append("")
    return lines


def severities(import_findings: Sequence[ImportFinding]) -> str:
    """Return the numbers of findings, such as ``findings: 2 errors, 1 note``."""
    times = Counter(t.severity for t in import_findings)
    counts = ", ".join(
        count(times[s], s) for s in ("error", "warning", "note") if times[s]
    )
    return f"findings: {counts or 'none'}"


def files(targets: Sequence[Target], dry: bool = False) -> list[str]:
    """Return the content of each file and its changes.

    With ``dry``, return the changes that writing would make.
    """
    lines = []
    for target in targets:
        tree = target.tree
        messages, enums = tree.get("messages", []), tree.get("enums", [])
        fields = sum(len(m.get("fields", ())) for m in messages)
        members = sum(len(e["members"]) for e in enums)
        what = (
            f"{count(len(messages), 'message')} with {count(fields, 'field')}, "
            f"{count(len(enums), 'enumeration')} with {count(members, 'member')}"
        )
        if target.changes is None:
            state = "written"
        else:
            state = "unchanged" if target.same else "updated"
        if dry and state != "unchanged":
            state = f"would be {state}{' with --update' if target.refused else ''}"
        lines.append(f"{target.path}: {state}; {what}")
        lines += [f"  {change}" for change in target.changes or ()]
    return lines


def finding_as_json(import_finding: ImportFinding) -> dict[str, Any]:
    """Return a finding without its place."""
    item: dict[str, Any] = {
        key: getattr(import_finding, key)
        for key in ("code", "severity", "message", "help")
    }
    return item | ({"rule": str(import_finding.place)} if import_finding.place else {})


def checked_as_json(checked: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return the findings of `icdgen check` for the written files."""
    return [
        {"code": f.code, "severity": f.severity, "message": f.message, "help": f.help, "file": f.place.file, "line": f.place.line}
        for f in checked
    ]  # fmt: skip


def files_as_json(targets: Sequence[Target]) -> list[dict[str, Any]]:
    """Return the written files, with the changes of updated ones."""
    return [{"file": str(target.path), "changes": target.changes} for target in targets]


def _paint(text: str, severity: str, colour: bool) -> str:
    return f"\x1b[{_COLOURS[severity]}m{text}\x1b[0m" if colour else text
