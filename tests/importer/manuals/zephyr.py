"""The manual of a fictional device in the tutorial, with its own terms and layout."""

from __future__ import annotations

import sys
from pathlib import Path

from reportlab.lib import colors
from reportlab.lib.pagesizes import A5
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.platypus import Paragraph, SimpleDocTemplate, Spacer, Table, TableStyle

FIELDS = [
    "First bit",
    "Bit count",
    "Quantity",
    "Kind",
    "Engineering value",
    "In",
    "Remark",
]
MESSAGES = [
    ("Listing 1: Order Fire", 21, 5, [
        ["0", "8", "Safety key", "word", "", "", "the key is 0xA5"],
        ["8", "16", "Duration", "word", "y = N / 1000", "s", "how long the valve stays open"],
        ["24", "16", "Thrust", "word", "y = N * 0.01", "mN", ""],
    ]),
    ("Listing 2: Order Abort", 22, 0, []),
    ("Listing 3: Report Tank", 150, 5, [
        ["0", "3", "Valve state", "choice", "", "", "one of Listing 4"],
        ["3", "1", "Heater on", "switch", "", "", ""],
        ["8", "16", "Pressure", "word", "y = N * 0.1", "kPa", "behind the filter"],
        ["24", "16", "Temperature", "signed", "y = N / 100 - 40", "C", ""],
    ]),
]  # fmt: skip
CODES = (
    "Listing 4: Codes of Valve State",
    [["0", "Shut"], ["1", "Open"], ["2", "Stuck"]],
)


def draw(path: Path) -> None:
    """Write the PDF: A5, no vertical rules, captions below."""
    style = getSampleStyleSheet()
    text, small = (
        style["BodyText"],
        style["BodyText"].clone("small", fontSize=7, leading=9),
    )
    story: list = [
        Paragraph("Zephyr cold-gas thruster: orders and reports", style["Title"])
    ]
    story.append(
        Paragraph(
            "Listing 1 and those after it give the bits of each message, the first bit being the highest.",
            text,
        )
    )
    for caption, opcode, size, rows in MESSAGES:
        head = Table(
            [["Opcode", str(opcode), "Payload bytes", str(size)]],
            colWidths=[50, 60, 80, 40],
        )
        story += [Spacer(1, 14), head]
        if rows:
            cells = [
                [Paragraph(cell, small) for cell in row] for row in [FIELDS, *rows]
            ]
            table = Table(cells, colWidths=[40, 40, 58, 38, 74, 28, 82])
            table.setStyle(
                TableStyle(
                    [
                        ("LINEABOVE", (0, 0), (-1, 1), 0.7, colors.black),
                        ("LINEBELOW", (0, -1), (-1, -1), 0.7, colors.black),
                    ]
                )
            )
            story.append(table)
        story += [Spacer(1, 4), Paragraph(f"<i>{caption}</i>", text)]
    caption, rows = CODES
    table = Table([["Code", "Means"], *rows], colWidths=[50, 100])
    table.setStyle(TableStyle([("LINEBELOW", (0, 0), (-1, 0), 0.7, colors.black)]))
    story += [Spacer(1, 14), table, Spacer(1, 4), Paragraph(f"<i>{caption}</i>", text)]
    SimpleDocTemplate(
        str(path),
        pagesize=A5,
        leftMargin=30,
        rightMargin=30,
        title="Zephyr Manual",
        invariant=1,
    ).build(story)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
