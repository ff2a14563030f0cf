"""Report as one self-contained HTML page: changes, compatibility, and both bit layouts.

The page is ``templates/diff/page.html.j2``; the site of an ICD shows the same content
with the variables of `shared`.
"""

from __future__ import annotations

import re

from icdgen import __version__, shipped
from icdgen.diff.accepted import about_stale
from icdgen.diff.layers import ABOUT, TEXT
from icdgen.diff.pairs import MessagePair
from icdgen.diff.report import DiffReport
from icdgen.diff.reports.drawing import ComparedDrawing, draw
from icdgen.diff.reports.groups import ChangeGroup, groups
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


def report(
    report: DiffReport,
    colour: bool = False,
    width: int | None = None,
    everything: bool = False,
) -> str:
    """Return the page."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(
            [shipped.templates() / "diff", shipped.templates() / "html"]
        ),
        autoescape=True,
        # Names come from the ICD: control characters must not reach the page.
        finalize=lambda value: printable(value) if type(value) is str else value,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    change_groups = groups(report.changes)
    return environment.get_template("page.html.j2").render(
        version=__version__,
        sections=[group for group in change_groups if group.layers != [TEXT]],
        words_only=[group for group in change_groups if group.layers == [TEXT]],
        stale=[about_stale(entry) for entry in report.stale],
        **shared(report),
    )


def shared(report: DiffReport) -> dict[str, object]:
    """Return the template variables that this page and the page of the site share."""
    return {
        "report": report,
        "about": ABOUT,
        "legend": LEGEND,
        "coded": coded,
        "layouts_of": layouts,
    }


def coded(text: str) -> list[tuple[str, bool]]:
    """Return the parts of a text with back-ticks: text, and whether it is code."""
    return [
        (part, bool(number % 2))
        for number, part in enumerate(_CODE.split(text))
        if part
    ]


def layouts(group: ChangeGroup) -> ComparedDrawing | None:
    """Return both layouts of a message, if any of its bits changed position or meaning;
    None otherwise.
    """
    return (
        draw(group.owner, group.changes)
        if isinstance(group.owner, MessagePair)
        else None
    )
