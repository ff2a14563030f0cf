"""The layouts. No two have the same engine, page size, font, rules and captions."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from reportlab.lib.pagesizes import A4, LETTER, landscape

from tests.importer.manuals import freehand, platypus
from tests.importer.manuals.content import Manual

Draw = Callable[[Manual, Path], None]

LAYOUTS: dict[str, Draw] = {
    "ruled": partial(platypus.draw, look=platypus.PlatypusLook()),
    "booktabs": partial(
        platypus.draw,
        look=platypus.PlatypusLook(
            page=LETTER, margin=54, font="Times-Roman", bold="Times-Bold", slanted="Times-Italic", size=10, rules="horizontal",
            head_fill=False, caption_below=True, mark=" – ", caption_center=True, figures="right", text="justify",
            widths=(0.13, 0.08, 0.08, 0.23, 0.11, 0.37),
        ),
    ),
    "shaded": partial(
        freehand.draw,
        look=freehand.FreehandLook(
            font="Vera", size=7.5, borders="NONE", head_fill=(210, 216, 228), two_lines=True, figures="CENTER", padding=1.2,
        ),
    ),
    "bare": partial(
        freehand.draw,
        look=freehand.FreehandLook(
            page="Letter", font="Helvetica", size=8.5, borders="NONE", mark=". ", caption_style="I", figures="RIGHT",
            padding=1.0, line=1.25, has_two_tables=True, widths=(14, 10, 10, 28, 12, 40),
        ),
    ),
    "framed": partial(
        platypus.draw,
        look=platypus.PlatypusLook(
            page=landscape(A4), margin=80, font="Courier", bold="Courier-Bold", slanted="Courier-Oblique", size=8, rules="frame",
            caption_below=True, caption_font="bold", middle=True, two_lines=True, figures="center", repeat=False, stacked=True,
            padding=5, widths=(0.14, 0.1, 0.1, 0.22, 0.1, 0.34),
        ),
    ),
    "striped": partial(
        freehand.draw,
        look=freehand.FreehandLook(
            font="Times", size=10, borders="NONE", stripes=True, head_fill=(200, 200, 200), caption_below=True, mark=" - ",
            caption_style="BI", repeat=False, padding=0.8, widths=(16, 10, 10, 26, 12, 40),
        ),
    ),
    # Added after the importer read the layouts above without a difference.
    "small": partial(
        freehand.draw,
        look=freehand.FreehandLook(
            page=(148, 210), font="Vera", size=6.5, borders="HORIZONTAL_LINES", mark=" — ", caption_style="I", figures="RIGHT",
            two_lines=True, padding=1.4, widths=(18, 12, 12, 24, 12, 32),
        ),
    ),
    "ligatures": partial(
        platypus.draw,
        look=platypus.PlatypusLook(
            page=landscape(LETTER), margin=50, font="Vera", bold="VeraBd", slanted="VeraIt", size=8.5, caption_below=True,
            mark=" | ", word="Tab.", caption_font="bold", caption_center=True, figures="right", middle=True, stacked=True,
            repeat=False, ligatures=True, padding=4,
        ),
    ),
}  # fmt: skip
