"""The report of an import as text and as JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

from icdgen.diagnostics import Finding
from icdgen.icd.rules.wording import count
from icdgen.importer.document import CERTAIN, DOUBTFUL, LIKELY, Spot, Trouble
from icdgen.importer.run import Result
from icdgen.importer.targets import Target
from icdgen.importer.understand.survey import BACKGROUND, UNKNOWN
from icdgen.importer.words import table_name
from icdgen.reports.excerpt import printable

_COLOURS = {"error": "31;1", "warning": "33;1", "note": "36"}


def where(file: str, spot: Spot) -> str:
    """``manual.pdf, page 12``, ``manual.txt:482``"""
    file = spot.file or file
    text = f"{file}:{spot.line}" if spot.line is not None else file
    return f"{text}, page {spot.page}" if spot.page is not None else text


def report(result: Result, colour: bool = False) -> str:
    """What was found, then everything to look at, then the figures."""
    return "\n".join(findings(result.troubles, result.document.file, colour) + summary(result))


def findings(troubles: Sequence[Trouble], file: str, colour: bool = False) -> list[str]:
    """Everything to look at: a block each, and a line for each note."""
    lines: list[str] = []
    notes: list[Trouble] = []
    for trouble in troubles:
        if trouble.severity == "note":
            notes.append(trouble)
            continue
        lines += [
            _paint(f"{trouble.severity}[{trouble.code}]", trouble.severity, colour) + f": {printable(trouble.message)}",
            f"  --> {printable(where(file, trouble.spot))}",
        ]
        lines += [f"  = rule: {trouble.place}"] if trouble.place else []
        lines += [f"  = help: {printable(trouble.help)}"] if trouble.help else []
        lines.append("")
    if notes:
        note = _paint("note", "note", colour)
        lines += [f"{note}[{t.code}] {t.spot.place or 'the document'}: {printable(t.message)}" for t in notes]
        lines.append("")
    return lines


def summary(result: Result) -> list[str]:
    """The figures: tables by what they are and how surely they were read, then each file."""
    kinds = Counter(one.what for one in result.survey.found)
    order = ["message", "enumeration", "list", "loggable frames", BACKGROUND, UNKNOWN]
    parts = [f"{kinds[kind]} {_many(kind, kinds[kind])}" for kind in order if kinds[kind]]
    pages = f"{result.document.pages:,} pages, " if result.document.pages else ""
    sure = result.sureness()
    return [
        f"{pages}{len(result.survey.found):,} tables" + (": " if parts else "") + ", ".join(parts),
        "read: " + (", ".join(f"{sure[one]} {one}" for one in (CERTAIN, LIKELY, DOUBTFUL) if sure[one]) or "none"),
        severities(result.troubles),
    ]


def severities(troubles: Sequence[Trouble]) -> str:
    """``findings: 2 errors, 1 note``"""
    times = Counter(t.severity for t in troubles)
    found = ", ".join(f"{times[s]} {s}{'s' if times[s] != 1 else ''}" for s in ("error", "warning", "note") if times[s])
    return f"findings: {found or 'none'}"


def _many(kind: str, count: int) -> str:
    if kind in (BACKGROUND, UNKNOWN) or kind.endswith("s") or count == 1:
        return kind
    return kind + "s"


def files(targets: Sequence[Target], dry: bool = False) -> list[str]:
    """What each file holds, and what changed in it; what would, if none was written (``dry``)."""
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
        state = "written" if target.changes is None else "unchanged" if target.same else "updated"
        if dry and state != "unchanged":
            state = f"would be {state}{' with --update' if target.refused else ''}"
        lines.append(f"{target.path}: {state}; {what}")
        lines += [f"  {change}" for change in target.changes or ()]
    return lines


def as_json(result: Result, checked: Sequence[Finding]) -> str:
    """Tables and findings for programs; ``checked`` are the findings of `icdgen check` for the files."""
    found = [
        {
            "table": _table(one.table.number),
            "caption": one.table.caption,
            "page": one.table.page,
            "line": one.table.line,
            "is": one.what,
            "sure": result.sure_of(one.table),
        }
        for one in result.survey.found
    ]
    troubles = [
        {**finding_as_json(t), "table": _table(t.spot.table), "page": t.spot.page, "line": t.spot.line}
        for t in result.troubles
    ]
    written = files_as_json(result.targets)
    return json.dumps(
        {"manual": result.document.file, "pages": result.document.pages, "tables": found, "findings": troubles,
         "files": written, "check": checked_as_json(checked)}, indent=2, ensure_ascii=False,
    )  # fmt: skip


def finding_as_json(one: Trouble) -> dict[str, Any]:
    """A finding without its place."""
    made: dict[str, Any] = {"code": one.code, "severity": one.severity, "message": one.message, "help": one.help}
    return made | ({"rule": str(one.place)} if one.place else {})


def checked_as_json(checked: Sequence[Finding]) -> list[dict[str, Any]]:
    """Findings of `icdgen check` for the written files."""
    return [
        {"code": f.code, "severity": f.severity, "message": f.message, "help": f.help, "file": f.place.file, "line": f.place.line}
        for f in checked
    ]  # fmt: skip


def files_as_json(targets: Sequence[Target]) -> list[dict[str, Any]]:
    """What was written, with the changes of what was updated."""
    return [{"file": str(one.path), "changes": one.changes} for one in targets]


def _table(number: int | None) -> int | str | None:
    """A table's number for programs; that of a chapter's table is a text, ``4-12``."""
    name = table_name(number) if number is not None else ""
    return int(name) if name.isdigit() else name or None


def refused_as_json(manual: str, findings: list[Finding]) -> str:
    """The same form for a manual, a profile or an ICD that could not be read."""
    troubles = [
        {"code": f.code, "severity": f.severity, "message": f.message, "help": f.help, "file": f.place.file,
         "table": None, "page": None, "line": f.place.line}
        for f in findings
    ]  # fmt: skip
    made = {"manual": manual, "pages": None, "tables": [], "findings": troubles, "files": [], "check": []}
    return json.dumps(made, indent=2, ensure_ascii=False)


def _paint(text: str, severity: str, colour: bool) -> str:
    return f"\x1b[{_COLOURS[severity]}m{text}\x1b[0m" if colour else text
