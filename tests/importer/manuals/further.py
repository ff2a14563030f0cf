"""Layouts for large manuals, in which page breaks split tables in different ways."""

from __future__ import annotations

from functools import partial

from reportlab.lib.pagesizes import LEGAL, LETTER

from tests.importer.manuals import browser, freehand, platypus
from tests.importer.manuals.layouts import Draw

FURTHER: dict[str, Draw] = {
    "letter": partial(
        platypus.draw,
        look=platypus.PlatypusLook(
            page=LETTER, margin=64, font="Vera", bold="VeraBd", slanted="VeraIt", size=8, rules="horizontal", caption_below=True,
            ligatures=True, repeat=False, padding=3,
        ),
    ),
    "legal": partial(
        platypus.draw,
        look=platypus.PlatypusLook(
            page=LEGAL, margin=50, font="Times-Roman", bold="Times-Bold", slanted="Times-Italic", size=9, rules="none",
            stripes=True, repeat=True, stacked=True, text="justify", two_lines=True, mark=" — ",
        ),
    ),
    "open": partial(
        freehand.draw,
        look=freehand.FreehandLook(
            page="Letter", font="Vera", size=7, borders="HORIZONTAL_LINES", caption_below=True, repeat=False, line=1.2,
            widths=(12, 10, 10, 26, 12, 38), mark=". ",
        ),
    ),
    "minimal": partial(
        freehand.draw,
        look=freehand.FreehandLook(
            font="Helvetica", size=8, borders="MINIMAL", caption_style="BI", figures="RIGHT", has_two_tables=True, mark=" - "
        ),
    ),
    "web": partial(browser.draw, look=browser.BrowserLook(font="sans-serif", size=8)),
    "article": partial(
        browser.draw,
        look=browser.BrowserLook(
            page="Letter", borders="ends", caption_below=True, repeat=False, justify=True, mark=". ", tear=False
        ),
    ),
    "columns": partial(browser.draw, look=browser.BrowserLook(page="A4 landscape", borders="columns", two_lines=True, size=9.5)),
    "stripes": partial(
        browser.draw,
        look=browser.BrowserLook(page="A5", size=6.5, borders="none", stripes=True, caption_below=True, font="sans-serif"),
    ),
}  # fmt: skip
