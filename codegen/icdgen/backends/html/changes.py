"""The page that says what changed since an older release: `icdgen diff`, with links to the pages of the site."""

from __future__ import annotations

from icdgen.backends.html.relations import Relations
from icdgen.diff import report
from icdgen.diff.change import Change
from icdgen.diff.inputs.side import Side
from icdgen.diff.layers import ABOUT, LAYERS
from icdgen.diff.reports.groups import Group, groups, notes
from icdgen.diff.reports.html import LEGEND, coded, layouts
from icdgen.icd.model import Enum, Message, Node


def values(relations: Relations, previous: Side) -> dict[str, object]:
    """Values of the page."""
    made = report.make(previous, Side("this release", relations.icd))
    counts = made.counts()
    return {
        "old": previous.label,
        "step": made.step.step,
        "reason": coded(made.step.reason),
        "layers": [(layer, counts[layer], ABOUT[layer]) for layer in LAYERS],
        "directions": [
            (one.question, one.verdict, [coded(line) for line in one.general], len(one.frames), one.total)
            for one in made.directions
        ],
        "legend": LEGEND,
        "sections": [_section(relations, group) for group in groups(made.changes)],
    }


def _section(relations: Relations, group: Group) -> dict[str, object]:
    return {
        "title": group.title,
        "about": group.about if group.about == "node" else f"{group.about} · {group.node}",
        "url": _url(relations, group.owner.new),
        "drawing": layouts(group),
        "lines": [_line(change) for change in group.changes],
    }


def _url(relations: Relations, thing: object) -> str:
    """Where it stands; empty for what is gone."""
    if isinstance(thing, Message):
        return relations.links.message(thing)
    if isinstance(thing, Enum):
        return relations.links.enum(thing)
    return relations.links.node(thing.name) if isinstance(thing, Node) else ""


def _line(change: Change) -> dict[str, object]:
    return {
        "layer": change.layer,
        "kind": "addition" if change.addition else change.severity,
        "code": change.code,
        "words": coded(change.message),
        "was": change.was,
        "now": change.now,
        "notes": [coded(note) for note in notes(change)],
    }
