"""Findings for people: the place, what is wrong, the line with a caret under it, and what to do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping

from icdgen.diagnostics import Finding
from icdgen.reports.excerpt import Lines, excerpt, printable, shown

COLOURS = {
    "error": "\x1b[1;31m",
    "warning": "\x1b[1;33m",
    "note": "\x1b[1;36m",
    "place": "\x1b[1m",
    "gutter": "\x1b[34m",
}
RESET = "\x1b[0m"


Paint = Callable[[str, str], str]
"""Puts a text in the colour of its role, which comes first."""


def report(findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False) -> str:
    """The findings in the order given, and a line that counts them."""
    findings = list(findings)
    paint: Paint = _painted if colour else _plain
    lines = {file: Lines(text) for file, text in texts.items()}  # but for those that could not be read
    parts = (_one(finding, lines.get(finding.place.file), paint) for finding in findings)
    return "".join(part + "\n" for part in parts) + _summary(findings) + "\n"


def _summary(findings: list[Finding]) -> str:
    """``3 errors, 1 warning in 2 files``"""
    counts = Counter(f.severity for f in findings)
    if not counts:
        return "no findings"
    said = [_count(counts[s], s) for s in ("error", "warning", "note") if counts[s]]
    return f"{', '.join(said)} in {_count(len({f.place.file for f in findings}), 'file')}"


def _one(finding: Finding, lines: Lines | None, paint: Paint) -> str:
    place = paint("place", printable(str(finding.place)))
    kind = paint(finding.severity, f"{finding.severity}[{finding.code}]")
    text = f"{place}: {kind}: {shown(finding.message)}\n"
    found = excerpt(lines, finding.place) if lines is not None else None
    indent = " " * len(str(finding.place.line))
    if found is not None:
        line, caret = found
        number, bar = paint("gutter", str(finding.place.line)), paint("gutter", "|")
        under = caret.replace(caret.strip(), paint(finding.severity, caret.strip()))
        text += f"{indent} {bar}\n{number} {bar} {line}".rstrip() + f"\n{indent} {bar} {under}\n"
    if finding.help:
        text += f"{indent} {paint('gutter', '=')} {paint('place', 'help:')} {shown(finding.help)}\n"
    return text


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}" + ("" if number == 1 else "s")


def _plain(role: str, text: str) -> str:
    return text


def _painted(role: str, text: str) -> str:
    return f"{COLOURS[role]}{text}{RESET}"
