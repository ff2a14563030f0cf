"""Report as Markdown for a pull request.

Names come from the ICDs, so every text passes `escaped`. `report` takes a `DiffReport`
and returns the summary, the compatibility and the changes by layer. No change is
omitted: compatibility, changes of text and accepted changes are folded (``<details>``).
The parameters ``colour``, ``width`` and ``everything`` have no effect.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from icdgen.diff.accepted import about_stale
from icdgen.diff.compatibility import DirectionCompatibility
from icdgen.diff.layers import ABOUT, LAYERS, TEXT
from icdgen.diff.report import DiffReport
from icdgen.diff.reports.groups import groups
from icdgen.reports.excerpt import shown
from icdgen.wording import count

_MARKUP = re.compile(r"([\\`*_{}\[\]<>#|~@])")
_CODE = re.compile(r"`([^`]*)`")


def report(
    report: DiffReport,
    colour: bool = False,
    width: int | None = None,
    everything: bool = False,
) -> str:
    """Return the report in GitHub's Markdown.

    Long parts are folded; no content is omitted.
    """
    lines = [
        f"## ICD changes: {escaped(report.old.label)} → {escaped(report.new.label)}",
        "",
    ]
    if not report.comparison.changes:
        lines += ["No change.", ""]
    else:
        lines += [*_summary(report), ""]
        for layer in LAYERS:
            lines += _layer(report, layer)
    lines += _uses_and_accepted(report)
    return "\n".join(lines).rstrip("\n") + "\n"


def escaped(text: str) -> str:
    """Return the text with escaped Markdown characters.

    Text in back-ticks remains code.
    """
    parts = _CODE.split(shown(text))
    # Even parts are text, odd parts were between back-ticks.
    parts[::2] = [_MARKUP.sub(r"\\\1", words) for words in parts[::2]]
    parts[1::2] = [
        "`" + code.replace("|", "\\|") + "`" if code else "\\`\\`"
        for code in parts[1::2]
    ]
    return "".join(parts)


def _summary(report: DiffReport) -> Iterator[str]:
    yield f"Version of the generated packages: **{report.step.step}** – {escaped(report.step.reason)}."
    yield ""
    yield "| layer | changes | additions | |"
    yield "|---|---:|---:|---|"
    for layer, number in report.counts().items():
        yield f"| **{layer}** | {number} | {report.additions(layer) or ''} | {ABOUT[layer]} |"
    yield ""
    yield "| | | frames as before |"
    yield "|---|---|---|"
    for direction in report.directions:
        yield f"| {direction.question} | **{direction.verdict}** | {direction.total - len(direction.frames)} of {direction.total} |"
    for direction in report.directions:
        yield from _direction(direction)


def _direction(direction: DirectionCompatibility) -> Iterator[str]:
    if direction.frames or direction.general:
        yield ""
        yield f"<details><summary>{direction.question} <b>{direction.verdict}</b></summary>"
        yield ""
        yield from (f"- {escaped(line)}" for line in direction.general)
        for frame in direction.frames:
            reasons = escaped("; ".join(frame.reasons))
            yield f"- **{frame.verdict}** {escaped(frame.node)} {escaped(frame.message)} ({frame.id}): {reasons}"
        yield ""
        yield "</details>"


def _layer(report: DiffReport, layer: str) -> Iterator[str]:
    changes = report.of_layer(layer)
    if not changes:
        return
    if layer == TEXT:
        yield f"<details><summary><b>{layer}</b>: {count(len(changes), 'change')}, {ABOUT[layer]}</summary>"
    else:
        yield f"### {layer}: {ABOUT[layer]}"
    yield ""
    for group in groups(changes):
        yield f"**{escaped(group.title)}** ({escaped(group.about)}, {escaped(group.node)})"
        yield ""
        for change in group.changes:
            places = " → ".join(
                escaped(f"{place.file}:{place.line}") for place in change.places
            )
            yield f"- {change.kind} `{change.code}` {escaped(change.message)} – {places}"
            yield from (f"  - {escaped(note)}" for note in change.notes)
        yield ""
    if layer == TEXT:
        yield "</details>"
        yield ""


def _uses_and_accepted(report: DiffReport) -> Iterator[str]:
    if report.uses is not None:
        yield f"### Uses in your sources: {len(report.uses)}"
        yield ""
        for use in report.uses:
            codes = ", ".join(f"`{code}`" for code in use.codes)
            yield f"- {escaped(f'{use.file}:{use.line}')} `{use.name}` ({codes})"
        yield ""
    if report.accepted:
        yield f"<details><summary>accepted: {count(len(report.accepted), 'change')}</summary>"
        yield ""
        for change, entry in report.accepted:
            yield f"- `{change.code}` {escaped(change.message)} – {escaped(entry.reason)}"
        yield ""
        yield "</details>"
        yield ""
    for entry in report.stale:
        yield f"> **warning** {escaped(about_stale(entry).message)} ({escaped(str(entry.place))})"
