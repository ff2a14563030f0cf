"""Report for a terminal: the most severe changes first, on one page if possible.

`report` takes a `DiffReport` and returns text, wrapped to ``width`` and with ANSI
colours on request. It lists at most `MOST_FRAMES` incompatible frames for each
question and `MOST_WORDS` changes of text, and omits the explanations of additions.
The parameter ``everything`` (``icdgen diff --all``) includes all content.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator

from icdgen.diff.accepted import about_stale
from icdgen.diff.change import Change
from icdgen.diff.compatibility import DirectionCompatibility
from icdgen.diff.layers import ABOUT, LAYERS, TEXT
from icdgen.diff.report import DiffReport
from icdgen.diff.reports.groups import groups
from icdgen.reports.excerpt import printable, shown
from icdgen.wording import count

RESET = "\x1b[0m"
COLOURS = {
    "head": "\x1b[1m", "place": "\x1b[2m", "error": "\x1b[1;31m", "warning": "\x1b[1;33m", "note": "\x1b[36m", "yes": "\x1b[32m",
    "partly": "\x1b[33m", "no": "\x1b[31m", "wire": "\x1b[1;31m", "meaning": "\x1b[1;35m", "source": "\x1b[1;33m",
    "text": "\x1b[1;36m",
}  # fmt: skip
MOST_WORDS = 10  # maximum number of listed changes of text
MOST_FRAMES = 12  # maximum number of listed frames of a direction
_INDENT = " " * 4

Paint = Callable[[str, str], str]


def report(
    report: DiffReport,
    colour: bool = False,
    width: int | None = None,
    everything: bool = False,
) -> str:
    """Return the report.

    ``width`` wraps explanations; ``everything`` omits nothing.
    """
    paint: Paint = (
        (lambda role, text: f"{COLOURS[role]}{text}{RESET}")
        if colour
        else (lambda role, text: text)
    )
    lines = [
        paint("head", f"{printable(report.old.label)} -> {printable(report.new.label)}")
    ]
    if not report.comparison.changes:
        return "\n".join([*lines, "no change", *_stale(report, paint), ""])
    lines += ["", *_summary(report, paint), ""]
    lines += _wrapped(
        f"version of the generated packages: {report.step.step}. Reason: {report.step.reason}.",
        width,
        "",
    )
    for direction in report.directions:
        lines += ["", *_direction(direction, paint, width, everything)]
    for layer in LAYERS:
        lines += _layer(report, layer, paint, width, everything)
    lines += _uses(report, paint)
    lines += _accepted(report, paint)
    lines += _stale(report, paint)
    return "\n".join([*lines, ""])


def _summary(report: DiffReport, paint: Paint) -> Iterator[str]:
    for layer, number in report.counts().items():
        additions = report.additions(layer)
        extra = f" ({count(additions, 'addition')})" if additions else ""
        label = paint(layer, f"{layer:8}") if number else f"{layer:8}"
        yield f"  {label} {number:4}  {ABOUT[layer]}{extra}"


def _direction(
    direction: DirectionCompatibility, paint: Paint, width: int | None, everything: bool
) -> Iterator[str]:
    good = direction.total - len(direction.frames)
    verdict = paint(direction.verdict, direction.verdict)
    total = (
        f"{good} of {count(direction.total, 'frame')} as before"
        if direction.total
        else "there are none"
    )
    yield f"{paint('head', direction.question)} {verdict}: {total}"
    for line in direction.general:
        yield from _wrapped(shown(line), width, "  ! ")
    most = len(direction.frames) if everything else MOST_FRAMES
    for frame in direction.worst_first[:most]:
        head = f"  {paint(frame.verdict, f'{frame.verdict:6}')} {printable(frame.node)} {shown(frame.message)} ({frame.id})"
        yield f"{head}: {shown('; '.join(frame.reasons))}"
    if len(direction.frames) > most:
        yield f"  ... and {len(direction.frames) - most} more, which --all lists"


def _layer(
    report: DiffReport, layer: str, paint: Paint, width: int | None, everything: bool
) -> Iterator[str]:
    changes = report.of_layer(layer)
    if not changes:
        return
    yield ""
    yield f"{paint(layer, layer)}: {ABOUT[layer]}"
    # Changes of text are numerous and harmless.
    most = len(changes) if everything or layer != TEXT else MOST_WORDS
    for group in groups(changes[:most]):
        yield ""
        yield f"  {paint('head', shown(group.title))} ({group.about}, {printable(group.node)})"
        for change in group.changes:
            yield from _change(change, paint, width, everything or not change.addition)
    if len(changes) > most:
        yield ""
        yield f"  ... and {len(changes) - most} more changes of words, which --all lists"


def _change(
    change: Change, paint: Paint, width: int | None, explained: bool
) -> Iterator[str]:
    label = f"{change.kind}[{change.code}]"
    first, *following_lines = _wrapped(
        shown(change.message), width, _INDENT + " " * (len(label) + 1)
    )
    yield f"{_INDENT}{paint('note' if change.addition else change.severity, label)} {first.lstrip()}"
    yield from following_lines
    for note in change.notes if explained else ():
        yield from _wrapped(shown(note), width, _INDENT * 2)
    places = " -> ".join(map(str, change.places)) or "no file"
    yield f"{_INDENT * 2}{paint('place', printable(places))}"


def _wrapped(text: str, width: int | None, indent: str) -> list[str]:
    if width is None or len(indent) + len(text) <= width:
        return [indent + text]
    return textwrap.wrap(
        text,
        max(width, len(indent) + 30),
        initial_indent=indent,
        subsequent_indent=" " * len(indent),
    )


def _uses(report: DiffReport, paint: Paint) -> Iterator[str]:
    if report.uses is None:
        return
    yield ""
    yield paint("head", "uses in your sources") + (": none" if not report.uses else "")
    shown_before: set[str] = set()
    for use in report.uses:
        place = paint("place", printable(f"{use.file}:{use.line}:{use.column}"))
        yield f"  {place}: {use.name} ({', '.join(use.codes)})"
        yield f"{_INDENT}{shown(use.text.strip())}"
        for message in use.messages:
            if message not in shown_before:  # each message once
                shown_before.add(message)
                yield f"{_INDENT}  {shown(message)}"


def _accepted(report: DiffReport, paint: Paint) -> Iterator[str]:
    if report.accepted:
        yield ""
        yield paint("head", f"accepted: {count(len(report.accepted), 'change')}")
        for change, entry in report.accepted:
            yield f"  {change.code} {shown(change.message)}"
            yield f"{_INDENT}{shown(entry.reason)} ({printable(str(entry.place))})"


def _stale(report: DiffReport, paint: Paint) -> Iterator[str]:
    for entry in report.stale:
        finding = about_stale(entry)
        yield ""
        yield f"{printable(str(finding.place))}: {paint('warning', f'warning[{finding.code}]')}: {shown(finding.message)}"
        yield f"  help: {finding.help}"
