"""Draw a PDF from headings, paragraphs and tables in the styles of several vendors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.platypus import (
    PageBreak,
    Paragraph,
    SimpleDocTemplate,
    Spacer,
    Table,
    TableStyle,
)

STYLES = getSampleStyleSheet()
GRID = ("GRID", (0, 0), (-1, -1), 0.5, colors.black)
ACROSS = [
    ("LINEABOVE", (0, 0), (-1, 0), 1, colors.black),
    ("LINEBELOW", (0, 0), (-1, -1), 0.5, colors.black),
]


def heading(text: str, level: int = 1) -> Paragraph:
    """A section heading."""
    return Paragraph(text, STYLES[f"Heading{level}"])


def text(words: str) -> Paragraph:
    """A paragraph of running text."""
    return Paragraph(words, STYLES["BodyText"])


def table(
    rows: Sequence[Sequence[str]],
    spans: Sequence[tuple] = (),
    widths: Sequence[float] | None = None,
) -> Table:
    """A ruled table; ``spans``: (first column, first row, last column, last row) of
    merged cells.
    """
    style = [
        GRID,
        ("VALIGN", (0, 0), (-1, -1), "MIDDLE"),
        ("FONTSIZE", (0, 0), (-1, -1), 8),
    ]
    style += [("SPAN", span[:2], span[2:]) for span in spans]
    return Table(
        [list(row) for row in rows],
        colWidths=widths,
        repeatRows=0,
        style=TableStyle(style),
    )


def open_table(
    rows: Sequence[Sequence[str]], widths: Sequence[float] | None = None
) -> Table:
    """A table with horizontal rules only."""
    return Table(
        [list(row) for row in rows],
        colWidths=widths,
        style=TableStyle([*ACROSS, ("FONTSIZE", (0, 0), (-1, -1), 8)]),
    )


PROSE = "The module answers each request within ten milliseconds and sends nothing that it is not asked for. "


def draw(path: Path, parts: Sequence) -> Path:
    """Write the PDF, which starts with some prose. A part ``None`` starts a new page."""
    flow: list = [text(PROSE * 6), text(PROSE * 4)]
    for part in parts:
        flow += [PageBreak()] if part is None else [part, Spacer(1, 6)]
    SimpleDocTemplate(str(path), pagesize=A4, title="").build(flow)
    return path
