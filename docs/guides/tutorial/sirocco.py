"""Draws the manual of the Sirocco, a fan that nobody builds: a serial protocol.  python
sirocco.py sirocco.pdf
"""

import sys

from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.platypus import Paragraph, SimpleDocTemplate, Spacer, Table

HEAD = ["Start", "Octets", "Quantity", "Coding", "Per count"]
FRAMES = [
    (
        "Order Set Speed",
        0x11,
        [("0", "2", "Speed", "plain", "0.5 rpm"), ("2", "1", "Ramp", "plain", "0.1 s")],
    ),
    (
        "Report Fan State",
        0x91,
        [
            ("0", "2", "Speed", "plain", "0.5 rpm"),
            ("2", "2", "Current", "twos", "10 mA"),
            ("4", "2", "Bearing Temperature", "twos", "0.01 C"),
        ],
    ),
    (
        "Report Run Time",
        0x92,
        [("0", "4", "Running", "plain", "1 s"), ("4", "2", "Starts", "plain", "")],
    ),
]


def draw(path: str) -> None:
    """Writes the PDF: a section for each frame, whose heading names it and its number."""
    style = getSampleStyleSheet()
    text, small = (
        style["BodyText"],
        style["BodyText"].clone("small", fontSize=8, leading=10),
    )
    story = [Paragraph("Sirocco fan: serial protocol", style["Title"])]
    story.append(
        Paragraph("Numbers of several bytes are sent with the high byte first.", text)
    )
    for index, (name, number, rows) in enumerate(FRAMES, 1):
        length = sum(int(octets) for _, octets, *_ in rows)
        story.append(Paragraph(f"5.{index} {name} [{number:02X}h]", style["Heading2"]))
        story.append(Paragraph(f"Length: {length} bytes.", text))
        cells = [[Paragraph(cell, small) for cell in row] for row in (HEAD, *rows)]
        grid = [("GRID", (0, 0), (-1, -1), 0.5, colors.black)]
        story += [
            Table(cells, colWidths=[40, 40, 120, 60, 80], style=grid),
            Spacer(1, 8),
        ]
    SimpleDocTemplate(path, pagesize=A4, title="Sirocco", invariant=1).build(story)


if __name__ == "__main__":
    draw(sys.argv[1])
