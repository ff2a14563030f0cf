"""Findings as text: the place and message, the line with marks below it, the help, and
the corrected line.

`report` takes findings and the texts of their files. It returns the findings in the
given order and then counts them, with ANSI colours on request. ``excerpt`` cuts lines
and makes the marks; without the text of the file there are none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping

from icdgen.diagnostics import Finding, Lines, Place
from icdgen.reports.excerpt import corrected, excerpt, printable, shown
from icdgen.wording import count

COLOURS = {
    "error": "\x1b[1;31m",
    "warning": "\x1b[1;33m",
    "note": "\x1b[1;36m",
    "place": "\x1b[1m",
    "gutter": "\x1b[34m",
    "fix": "\x1b[1;32m",
}
RESET = "\x1b[0m"


# Function of a role and a text that returns the text in the colour of the role.
Paint = Callable[[str, str], str]


def report(
    findings: Iterable[Finding], texts: Mapping[str, str], colour: bool = False
) -> str:
    """Return the findings in the given order, and a line with their number.

    ``texts`` lacks files that cannot be read.
    """
    findings = list(findings)
    paint: Paint = _painted if colour else _plain
    lines = {file: Lines(text) for file, text in texts.items()}
    parts = (_text(finding, lines, paint) for finding in findings)
    return "".join(part + "\n" for part in parts) + _summary(findings) + "\n"


def _summary(findings: list[Finding]) -> str:
    """Return the numbers of findings and files in words: ``3 errors, 1 warning in 2
    files``.
    """
    counts = Counter(finding.severity for finding in findings)
    if not counts:
        return "no findings"
    numbers = [
        count(counts[severity], severity)
        for severity in ("error", "warning", "note")
        if counts[severity]
    ]
    files = {finding.place.file for finding in findings}
    return f"{', '.join(numbers)} in {count(len(files), 'file')}"


def _text(finding: Finding, texts: Mapping[str, Lines], paint: Paint) -> str:
    """Return the text of a finding: message, line with marks, related line, help and
    corrected line.
    """
    place, related, fix = finding.place, finding.related, finding.fix
    places = [each.place for each in (finding, related, fix) if each is not None]
    rows = _ExcerptLines(max(len(str(each.line)) for each in places), paint)
    heading = paint("place", printable(str(place)))
    kind = paint(finding.severity, f"{finding.severity}[{finding.code}]")
    marks = [(place, "^", finding.severity, "")]
    if related is not None:
        marks.append((related.place, "-", "gutter", shown(related.label)))
    # In the same file, show the excerpts in the order of the lines.
    if related is not None and related.place.file == place.file:
        marks.sort(key=lambda mark: mark[0].line)
    text = f"{heading}: {kind}: {shown(finding.message)}\n"
    for number, (each, mark, role, label) in enumerate(marks):
        lines = texts.get(each.file)
        if each.file != place.file:
            text += f"{rows.indent} {paint('place', printable(str(each)))}\n"
        text += rows.excerpt(
            each,
            excerpt(lines, each, mark) if lines else None,
            role,
            label,
            begin=number == 0,
        )
    if finding.help:
        text += f"{rows.indent} {paint('gutter', '=')} {paint('place', 'help:')} {shown(finding.help)}\n"
    if fix is not None:
        lines = texts.get(fix.place.file)
        text += rows.excerpt(fix.place, corrected(lines, fix) if lines else None, "fix")
    return text


class _ExcerptLines:
    """Excerpts of a finding, with a gutter for the largest line number."""

    def __init__(self, width: int, paint: Paint) -> None:
        self.indent = " " * width
        self._paint = paint

    def excerpt(
        self,
        place: Place,
        content: tuple[str, str] | None,
        role: str,
        label: str = "",
        begin: bool = False,
    ) -> str:
        """Return a line of the source and marks below it, with a label after the marks;
        empty without ``content``.
        """
        if content is None:
            return ""
        line, marks = content
        number = self._paint("gutter", str(place.line).rjust(len(self.indent)))
        bar = self._paint("gutter", "|")
        labelled_marks = f"{marks.strip()} {label}".rstrip()
        below = marks.replace(marks.strip(), self._paint(role, labelled_marks))
        text = f"{self.indent} {bar}\n" if begin else ""
        text += f"{number} {bar} {line}".rstrip() + "\n"
        return text + f"{self.indent} {bar} {below}\n"


def _plain(role: str, text: str) -> str:
    """Return the text without a colour."""
    return text


def _painted(role: str, text: str) -> str:
    """Return the text in the colour of a role, as ANSI escape codes."""
    return f"{COLOURS[role]}{text}{RESET}"
