"""The report as Markdown, for a pull request."""

from __future__ import annotations

import re
from collections.abc import Iterator

from icdgen.diff.accepted import about_stale
from icdgen.diff.compatibility import Direction
from icdgen.diff.layers import ABOUT, LAYERS, TEXT
from icdgen.diff.report import Report
from icdgen.diff.reports.groups import groups
from icdgen.icd.rules.wording import count
from icdgen.reports.excerpt import shown

_MARKUP = re.compile(r"([\\`*_{}\[\]<>#|~@])")
_CODE = re.compile(r"`([^`]*)`")


def report(report: Report, colour: bool = False, width: int | None = None, everything: bool = False) -> str:
    """GitHub's Markdown. What is long is folded, nothing is left out."""
    lines = [f"## ICD changes: {said(report.old.label)} → {said(report.new.label)}", ""]
    if not report.comparison.changes:
        lines += ["No change.", ""]
    else:
        lines += [*_summary(report), ""]
        for layer in LAYERS:
            lines += _layer(report, layer)
    lines += _rest(report)
    return "\n".join(lines).rstrip("\n") + "\n"


def said(text: str) -> str:
    """The text with nothing in it that Markdown would act upon; what stands in back-ticks stays code."""
    parts = _CODE.split(shown(text))
    parts[::2] = [_MARKUP.sub(r"\\\1", words) for words in parts[::2]]
    parts[1::2] = ["`" + code.replace("|", "\\|") + "`" if code else "\\`\\`" for code in parts[1::2]]
    return "".join(parts)


def _summary(report: Report) -> Iterator[str]:
    yield f"Version of the generated packages: **{report.step.step}** – {said(report.step.reason)}."
    yield ""
    yield "| layer | changes | additions | |"
    yield "|---|---:|---:|---|"
    for layer, number in report.counts().items():
        yield f"| **{layer}** | {number} | {report.additions(layer) or ''} | {ABOUT[layer]} |"
    yield ""
    yield "| | | frames as before |"
    yield "|---|---|---|"
    for one in report.directions:
        yield f"| {one.question} | **{one.verdict}** | {one.total - len(one.frames)} of {one.total} |"
    for one in report.directions:
        yield from _direction(one)


def _direction(one: Direction) -> Iterator[str]:
    if one.frames or one.general:
        yield ""
        yield f"<details><summary>{one.question} <b>{one.verdict}</b></summary>"
        yield ""
        yield from (f"- {said(line)}" for line in one.general)
        for frame in one.frames:
            reasons = said("; ".join(frame.reasons))
            yield f"- **{frame.verdict}** {said(frame.node)} {said(frame.message)} ({frame.id}): {reasons}"
        yield ""
        yield "</details>"


def _layer(report: Report, layer: str) -> Iterator[str]:
    changes = report.of_layer(layer)
    if not changes:
        return
    if layer == TEXT:
        yield f"<details><summary><b>{layer}</b>: {count(len(changes), 'change')}, {ABOUT[layer]}</summary>"
    else:
        yield f"### {layer}: {ABOUT[layer]}"
    yield ""
    for group in groups(changes):
        yield f"**{said(group.title)}** ({said(group.about)}, {said(group.node)})"
        yield ""
        for change in group.changes:
            places = " → ".join(said(f"{place.file}:{place.line}") for place in change.places)
            yield f"- {change.kind} `{change.code}` {said(change.message)} – {places}"
            yield from (f"  - {said(note)}" for note in change.notes)
        yield ""
    if layer == TEXT:
        yield "</details>"
        yield ""


def _rest(report: Report) -> Iterator[str]:
    if report.uses is not None:
        yield f"### Uses in your sources: {len(report.uses)}"
        yield ""
        for use in report.uses:
            codes = ", ".join(f"`{code}`" for code in use.codes)
            yield f"- {said(f'{use.file}:{use.line}')} `{use.name}` ({codes})"
        yield ""
    if report.accepted:
        yield f"<details><summary>accepted: {count(len(report.accepted), 'change')}</summary>"
        yield ""
        for change, entry in report.accepted:
            yield f"- `{change.code}` {said(change.message)} – {said(entry.reason)}"
        yield ""
        yield "</details>"
        yield ""
    for entry in report.stale:
        yield f"> **warning** {said(about_stale(entry).message)} ({said(str(entry.place))})"
