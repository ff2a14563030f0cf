"""Manuals drawn with ReportLab."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from reportlab.lib import colors
from reportlab.lib.enums import TA_CENTER, TA_JUSTIFY, TA_LEFT, TA_RIGHT
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.platypus import (
    KeepTogether,
    Paragraph,
    Preformatted,
    SimpleDocTemplate,
    Spacer,
    Table,
    TableStyle,
)

from tests.importer.manuals.content import (
    FIELD_TITLES,
    Manual,
    MessageTable,
    PlainTable,
    Prose,
)

_ALIGN = {
    "left": TA_LEFT,
    "right": TA_RIGHT,
    "center": TA_CENTER,
    "justify": TA_JUSTIFY,
}


@dataclass(frozen=True)
class PlatypusLook:
    """The properties of a layout."""

    page: tuple[float, float] = A4
    margin: float = 60
    font: str = "Helvetica"
    bold: str = "Helvetica-Bold"
    slanted: str = "Helvetica-Oblique"
    size: float = 9
    rules: str = "grid"  # "grid" | "horizontal" | "frame" | "none"
    head_fill: bool = True
    stripes: bool = False
    caption_below: bool = False
    mark: str = ": "
    word: str = "Table"
    caption_font: str = "slanted"
    caption_center: bool = False
    repeat: bool = True
    figures: str = "left"
    text: str = "left"
    two_lines: bool = False
    middle: bool = False  # cells centred in height, the label of the fields too
    padding: float = 3
    widths: tuple[float, ...] = (0.12, 0.1, 0.09, 0.24, 0.12, 0.33)
    stacked: bool = False  # each label of the head in a row of its own
    ligatures: bool = False


def draw(manual: Manual, path: Path, look: PlatypusLook) -> None:
    """Write the PDF."""
    if look.font == "Vera":
        for name in ("Vera", "VeraBd", "VeraIt"):
            pdfmetrics.registerFont(TTFont(name, f"{name}.ttf"))
    artist = _Artist(look)
    story: list = []
    for part in manual.parts:
        story += artist.part(part)
    document = SimpleDocTemplate(
        str(path), pagesize=look.page, leftMargin=look.margin, rightMargin=look.margin, topMargin=60, bottomMargin=60,
        title=manual.title, invariant=1,
    )  # fmt: skip

    def furniture(canvas, doc) -> None:
        canvas.setFont(look.font, 8)
        canvas.drawString(look.margin, look.page[1] - 36, f"{manual.title}, edition 4")
        canvas.line(
            look.margin,
            look.page[1] - 40,
            look.page[0] - look.margin,
            look.page[1] - 40,
        )
        canvas.drawRightString(look.page[0] - look.margin, 34, f"Page {doc.page}")

    document.build(story, onFirstPage=furniture, onLaterPages=furniture)


class _Artist:
    def __init__(self, look: PlatypusLook) -> None:
        self.look = look
        self.width = look.page[0] - 2 * look.margin
        base = {
            "fontName": look.font,
            "fontSize": look.size,
            "leading": look.size * 1.22,
        }
        self.body = ParagraphStyle(
            "body",
            **base | {"fontSize": look.size + 1, "leading": (look.size + 1) * 1.25},
            spaceAfter=6,
        )
        self.cell = ParagraphStyle("cell", **base, alignment=_ALIGN[look.text])
        self.figure = ParagraphStyle("figure", **base, alignment=_ALIGN[look.figures])
        self.title = ParagraphStyle(
            "title", **base | {"fontName": look.bold}, alignment=_ALIGN["left"]
        )
        self.figure_title = ParagraphStyle(
            "figure title", parent=self.title, alignment=_ALIGN[look.figures]
        )
        font = {"slanted": look.slanted, "bold": look.bold, "plain": look.font}[
            look.caption_font
        ]
        self.caption = ParagraphStyle(
            "caption", **base | {"fontName": font}, spaceBefore=8, spaceAfter=4,
            alignment=TA_CENTER if look.caption_center else TA_LEFT,
        )  # fmt: skip
        self.heading = ParagraphStyle(
            "heading",
            fontName=look.bold,
            fontSize=look.size + 5,
            leading=look.size + 9,
            spaceBefore=10,
            spaceAfter=6,
        )

    def part(self, part) -> list:
        if isinstance(part, Prose):
            return self.prose(part)
        table = (
            self.message(part) if isinstance(part, MessageTable) else self.plain(part)
        )
        caption = Paragraph(
            self.markup(f"{self.look.word} {part.number}{self.look.mark}{part.title}"),
            self.caption,
        )
        small = len(part.rows) < 12
        if self.look.caption_below:
            return (
                [*table, caption, Spacer(1, 8)]
                if not small
                else [KeepTogether([*table, caption]), Spacer(1, 8)]
            )
        caption.keepWithNext = True
        return [caption, *table, Spacer(1, 10)]

    def prose(self, part: Prose) -> list:
        if part.style == "code":
            box = Table(
                [
                    [
                        Preformatted(
                            part.text,
                            ParagraphStyle(
                                "code", fontName="Courier", fontSize=8, leading=10
                            ),
                        )
                    ]
                ]
            )
            box.setStyle(TableStyle([("BOX", (0, 0), (-1, -1), 0.5, colors.grey)]))
            return [box, Spacer(1, 6)]
        return [
            Paragraph(
                self.markup(part.text),
                self.heading if part.style == "heading" else self.body,
            )
        ]

    def markup(self, text: str) -> str:
        if self.look.ligatures:
            text = text.replace("fi", "ﬁ").replace("fl", "ﬂ")
        return escape(text)

    def cells(self, texts: list[str], figures: set[int]) -> list:
        return [
            Paragraph(self.markup(t), self.figure if i in figures else self.cell)
            for i, t in enumerate(texts)
        ]

    def titles(self, texts: list[str], figures: set[int]) -> list:
        flowables = []
        for index, text in enumerate(texts):
            words = self.markup(text)
            if self.look.two_lines and " " in text:
                words = words.replace(" ", "<br/>", 1)
            flowables.append(
                Paragraph(words, self.figure_title if index in figures else self.title)
            )
        return flowables

    def message(self, part: MessageTable) -> list:
        look = self.look
        widths = [w * self.width for w in look.widths]
        rows, style = [], []
        if look.stacked:
            for label, value in part.pairs:
                rows.append(
                    [
                        Paragraph(label, self.title),
                        Paragraph(value, self.cell),
                        *[""] * 4,
                    ]
                )
                style.append(("SPAN", (1, len(rows) - 1), (-1, len(rows) - 1)))
        else:
            (first, first_value), (second, two) = part.pairs
            rows.append([Paragraph(first, self.title), Paragraph(first_value, self.cell), Paragraph(second, self.title), "",
                         Paragraph(two, self.cell), ""])  # fmt: skip
            style += [("SPAN", (2, 0), (3, 0)), ("SPAN", (4, 0), (5, 0))]
        rows.append(
            [
                Paragraph("Description", self.title),
                Paragraph(self.markup(part.description), self.cell),
                *[""] * 4,
            ]
        )
        style.append(("SPAN", (1, len(rows) - 1), (-1, len(rows) - 1)))
        head = len(rows)
        if part.rows:
            label = "" if look.middle else part.label
            rows.append(
                [Paragraph(label, self.title), *self.titles(FIELD_TITLES, {0, 1})]
            )
            middle = len(part.rows) // 2
            for index, row in enumerate(part.rows):
                side = (
                    Paragraph(part.label, self.title)
                    if look.middle and index == middle
                    else ""
                )
                rows.append([side, *self.cells(row, {0, 1})])
            if look.rules == "grid":
                style.append(
                    ("LINEBELOW", (0, head), (0, -2), 0.1, colors.white)
                    if False
                    else ("NOSPLIT", (0, 0), (0, 0))
                )
        table = Table(rows, colWidths=widths, repeatRows=0)
        table.setStyle(
            TableStyle(
                [*self.rules(rows, head if part.rows else None, body_from=1), *style]
            )
        )
        return [table]

    def plain(self, part: PlainTable) -> list:
        count = len(part.titles)
        widths = {
            2: [0.4, 0.6],
            3: [0.25, 0.35, 0.4],
            4: [0.1, 0.3, 0.45, 0.15],
            5: [0.09, 0.09, 0.27, 0.4, 0.15],
        }[count]
        if part.kind == "loggable":
            widths = [0.45, 0.2, 0.35]
        figures = {
            i
            for i, t in enumerate(part.titles)
            if "ID" in t or "Value" in t or "Length" in t
        }
        rows, style = [self.titles(part.titles, figures)], []
        for row in part.rows:
            if len(row) == 1:
                rows.append(
                    [Paragraph(self.markup(row[0]), self.title), *[""] * (count - 1)]
                )
                style.append(("SPAN", (0, len(rows) - 1), (-1, len(rows) - 1)))
            else:
                rows.append(self.cells(row, figures))
        table = Table(
            rows,
            colWidths=[w * self.width for w in widths],
            repeatRows=1 if self.look.repeat else 0,
        )
        table.setStyle(TableStyle([*self.rules(rows, 0), *style]))
        return [table]

    def rules(self, rows: list, head: int | None, body_from: int = 0) -> list[tuple]:
        look = self.look
        style: list[tuple] = [
            ("VALIGN", (0, 0), (-1, -1), "MIDDLE" if look.middle else "TOP"),
            *[
                (f"{side}PADDING", (0, 0), (-1, -1), look.padding)
                for side in ("LEFT", "RIGHT", "TOP", "BOTTOM")
            ],
        ]
        if look.rules == "grid":
            style.append(("GRID", (0, 0), (-1, -1), 0.5, colors.black))
        elif look.rules == "horizontal":
            style.append(("LINEABOVE", (0, 0), (-1, 0), 1, colors.black))
            style.append(("LINEBELOW", (0, 0), (-1, -1), 0.4, colors.black))
        elif look.rules == "frame":
            style.append(("BOX", (0, 0), (-1, -1), 0.8, colors.black))
            style.append(("LINEBEFORE", (1, 0), (-1, -1), 0.4, colors.black))
            if head is not None:
                style.append(("LINEBELOW", (0, head), (-1, head), 0.8, colors.black))
                style.append(("LINEABOVE", (0, head), (-1, head), 0.8, colors.black))
        if look.head_fill and head is not None:
            style.append(
                ("BACKGROUND", (0, head), (-1, head), colors.HexColor("#d9d9d9"))
            )
        if look.stripes:
            style += [
                ("BACKGROUND", (0, i), (-1, i), colors.HexColor("#f0f4ff"))
                for i in range((head or 0) + 2, len(rows), 2)
            ]
        return style
