"""Page of changes since an older release: the report of `icdgen diff`, with links to
the pages of the site.

The report itself is made in `icdgen.diff.report`.
"""

from __future__ import annotations

from icdgen.backends.html.relations import Relations
from icdgen.diff import report
from icdgen.diff.inputs.side import ComparisonSide
from icdgen.diff.reports import html
from icdgen.diff.reports.groups import groups
from icdgen.icd.model import Enum, Message, Node


def values(relations: Relations, previous: ComparisonSide) -> dict[str, object]:
    """Return the values of the page."""
    comparison_report = report.make_report(
        previous, ComparisonSide("this release", relations.icd)
    )
    # `after` is the object of this release: pages exist only for this one.
    sections = [
        (group, _url(relations, group.owner.after))
        for group in groups(comparison_report.changes)
    ]
    return {"sections": sections, **html.shared(comparison_report)}


def _url(relations: Relations, thing: object) -> str:
    """Return the link to an object; empty for a removed object."""
    if isinstance(thing, Message):
        return relations.links.message(thing)
    if isinstance(thing, Enum):
        return relations.links.enum(thing)
    return relations.links.node(thing.name) if isinstance(thing, Node) else ""
