"""The report as one self-contained page: what changed, for whom it matters, and both bit layouts above each other."""

from __future__ import annotations

import re
from typing import NamedTuple

from icdgen import __version__, shipped
from icdgen.diff.accepted import about_stale
from icdgen.diff.change import Change
from icdgen.diff.compatibility import Direction
from icdgen.diff.layers import ABOUT, LAYERS, TEXT
from icdgen.diff.pairs import FieldPair, MessagePair
from icdgen.diff.report import Report
from icdgen.diff.reports.drawing import Drawing, Row, draw
from icdgen.diff.reports.groups import Group, groups, notes
from icdgen.diff.uses import Use
from icdgen.reports.excerpt import printable

_CODE = re.compile(r"`([^`]*)`")

LEGEND = (
    ("same", "as before"),
    ("moved", "lies elsewhere"),
    ("wire", "read otherwise"),
    ("gone", "gone"),
    ("come", "new"),
    ("meaning", "another sense"),
    ("name", "another name"),
)


class Line(NamedTuple):
    """A change as the page shows it. Texts are lists of (words, whether they are code)."""

    code: str
    layer: str
    kind: str
    message: list[tuple[str, bool]]
    notes: list[list[tuple[str, bool]]]
    place: str


class Section(NamedTuple):
    """A message, an enumeration or a node."""

    title: str
    about: str
    anchor: str
    layers: str
    lines: list[Line]
    drawing: Drawing | None


def report(report: Report, colour: bool = False, width: int | None = None, everything: bool = False) -> str:
    """The page."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([shipped.templates() / "diff", shipped.templates() / "html"]),
        autoescape=True,
        finalize=lambda value: printable(value) if type(value) is str else value,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    counts = report.counts()
    found = groups(report.changes)
    loud = [group for group in found if any(change.layer != TEXT for change in group.changes)]
    quiet = [group for group in found if all(change.layer == TEXT for change in group.changes)]
    return environment.get_template("page.html.j2").render(
        version=__version__,
        old=report.old.label,
        new=report.new.label,
        step=report.step,
        reason=coded(report.step.reason),
        layers=[(layer, counts[layer], ABOUT[layer]) for layer in LAYERS],
        directions=[(one, [coded(line) for line in one.general], _frames(one)) for one in report.directions],
        sections=[_section(group, number) for number, group in enumerate(loud)],
        words_only=[_section(group, len(loud) + number) for number, group in enumerate(quiet)],
        legend=LEGEND,
        uses=None if report.uses is None else [_use(use) for use in report.uses],
        accepted=[(_line(change), coded(entry.reason), str(entry.place)) for change, entry in report.accepted],
        stale=[(coded(about_stale(entry).message), str(entry.place)) for entry in report.stale],
    )


def coded(text: str) -> list[tuple[str, bool]]:
    """The text split at its back-ticks: words, and whether they are code."""
    return [(part, bool(number % 2)) for number, part in enumerate(_CODE.split(text)) if part]


def _frames(one: Direction) -> list[tuple[object, ...]]:
    rank = {"no": 0, "partly": 1}
    frames = sorted(one.frames, key=lambda frame: rank[frame.verdict])
    return [(f.verdict, f.node, f.message, f.id, coded("; ".join(f.reasons))) for f in frames]


def _section(group: Group, number: int) -> Section:
    layers = [layer for layer in LAYERS if any(change.layer == layer for change in group.changes)]
    lines = [_line(change) for change in group.changes]
    about = f"{group.about}, {group.node}" if group.about != "node" else "node"
    return Section(group.title, about, f"s{number}", " ".join(layers), lines, layouts(group))


def layouts(group: Group) -> Drawing | None:
    """Both layouts of a message, where any bit of them changed its place or its sense."""
    owner = group.owner
    if not isinstance(owner, MessagePair):
        return None
    of_fields = [change for change in group.changes if isinstance(change.pair, FieldPair)]
    made = draw(owner, of_fields)
    return made if any(isinstance(part, Row) and part.is_new for part in made.parts) else None


def _line(change: Change) -> Line:
    kind = "addition" if change.addition else change.severity
    where = [str(place) for place in (change.old, change.new) if place is not None]
    said = [coded(note) for note in notes(change)]
    return Line(change.code, change.layer, kind, coded(change.message), said, " → ".join(where))


def _use(use: Use) -> tuple[object, ...]:
    codes = ", ".join(dict.fromkeys(change.code for change in use.changes))
    said = [coded(message) for message in dict.fromkeys(change.message for change in use.changes)]
    return f"{use.file}:{use.line}:{use.column}", use.text.strip(), use.name, codes, said
