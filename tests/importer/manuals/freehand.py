"""Manuals drawn with fpdf2."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import reportlab
from fpdf import FPDF, FontFace
from fpdf.enums import TableBordersLayout, TableCellFillMode

from tests.importer.manuals.content import (
    FIELD_TITLES,
    Manual,
    MessageTable,
    PlainTable,
    Prose,
)

_FONTS = Path(os.path.dirname(reportlab.__file__), "fonts")


@dataclass(frozen=True)
class FreehandLook:
    """The properties of a layout."""

    page: str | tuple[float, float] = "A4"
    font: str = "Times"  # or "Vera", embedded
    size: float = 9
    borders: str = "ALL"  # of `TableBordersLayout`
    head_fill: tuple[int, int, int] | None = None
    stripes: bool = False
    caption_below: bool = False
    mark: str = ": "
    caption_style: str = "B"
    # degrees that the letters lean, for want of an italic font
    caption_slant: float = 0
    figures: str = "LEFT"
    two_lines: bool = False
    padding: float = 1.0
    line: float = 1.3
    has_two_tables: bool = False  # head and fields as two tables, one below the other
    widths: tuple[int, ...] = (14, 9, 9, 26, 11, 40)
    repeat: bool = True


def draw(manual: Manual, path: Path, look: FreehandLook) -> None:
    """Write the PDF."""
    artist = _Artist(manual, look)
    for part in manual.parts:
        artist.part(part)
    artist.pdf.output(str(path))


class _Page(FPDF):
    heading = ""

    def header(self) -> None:
        self.set_font(self.family, size=8)
        self.cell(0, 6, self.heading, align="R")
        self.ln(12)

    def footer(self) -> None:
        self.set_y(-14)
        self.set_font(self.family, size=8)
        self.cell(0, 6, f"{self.page_no()}", align="C")


class _Artist:
    def __init__(self, manual: Manual, look: FreehandLook) -> None:
        self.look = look
        self.pdf = pdf = _Page(format=look.page)
        pdf.set_title(manual.title)
        pdf.heading = manual.title
        pdf.family = look.font
        if look.font == "Vera":
            for style, name in (
                ("", "Vera"),
                ("B", "VeraBd"),
                ("I", "VeraIt"),
                ("BI", "VeraBI"),
            ):
                pdf.add_font("Vera", style, _FONTS / f"{name}.ttf")
        pdf.set_auto_page_break(True, 20)
        pdf.add_page()

    def font(self, style: str = "", more: float = 0) -> None:
        self.pdf.set_font(self.look.font, style, self.look.size + more)

    def part(self, part) -> None:
        if isinstance(part, Prose):
            self.prose(part)
            return
        if not self.look.caption_below:
            self.keep(30)
            self.caption(part)
        else:
            self.keep(min(60, 12 + 7 * len(part.rows)))
        if isinstance(part, MessageTable):
            self.message(part)
        else:
            self.plain(part)
        if self.look.caption_below:
            self.caption(part)
        self.pdf.ln(5)

    def keep(self, height: float) -> None:
        if self.pdf.will_page_break(height):
            self.pdf.add_page()

    def caption(self, part) -> None:
        self.font(self.look.caption_style)
        with self.pdf.skew(ax=self.look.caption_slant, x=self.pdf.x, y=self.pdf.y):
            self.pdf.multi_cell(
                0,
                5,
                f"Table {part.number}{self.look.mark}{part.title}",
                new_x="LMARGIN",
                new_y="NEXT",
            )
        self.pdf.ln(1)

    def prose(self, part: Prose) -> None:
        if part.style == "heading":
            self.font("B", 5)
            self.pdf.ln(3)
        elif part.style == "code":
            self.pdf.set_font("Courier", size=8)
        else:
            self.font("", 1)
        self.pdf.multi_cell(
            0,
            5,
            part.text,
            new_x="LMARGIN",
            new_y="NEXT",
            border=1 if part.style == "code" else 0,
            align="L",
        )
        self.pdf.ln(3)

    def table(self, widths: tuple[float, ...], head: bool):
        look = self.look
        fill = (
            FontFace(emphasis="BOLD", fill_color=look.head_fill)
            if look.head_fill
            else FontFace(emphasis="BOLD")
        )
        return self.pdf.table(
            col_widths=widths,
            borders_layout=getattr(TableBordersLayout, look.borders),
            headings_style=fill,
            first_row_as_headings=head,
            num_heading_rows=1,
            repeat_headings=1 if look.repeat and head else 0,
            cell_fill_color=(238, 242, 250) if look.stripes else None,
            cell_fill_mode=(
                TableCellFillMode.ROWS if look.stripes else TableCellFillMode.NONE
            ),
            line_height=self.look.size * 0.3528 * look.line,
            padding=look.padding,
            text_align="LEFT",
            width=self.pdf.epw,
        )

    def title(self, text: str) -> str:
        return text.replace(" ", "\n", 1) if self.look.two_lines else text

    def message(self, part: MessageTable) -> None:
        self.font()
        (first, first_value), (second, two) = part.pairs
        strong = FontFace(emphasis="BOLD")
        if self.look.has_two_tables:
            with self.table((20, 12, 34, 34), False) as table:
                row = table.row()
                row.cell(first, style=strong)
                row.cell(first_value)
                row.cell(second, style=strong)
                row.cell(two)
                row = table.row()
                row.cell("Description", style=strong)
                row.cell(part.description, colspan=3)
            if part.rows:
                with self.table(self.look.widths[1:], True) as table:
                    self.fields(table, part, label=False)
            return
        with self.table(self.look.widths, False) as table:
            row = table.row()
            row.cell(first, style=strong)
            row.cell(first_value)
            row.cell(second, colspan=2, style=strong)
            row.cell(two, colspan=2)
            row = table.row()
            row.cell("Description", style=strong)
            row.cell(part.description, colspan=5)
            if part.rows:
                self.fields(table, part, label=True)

    def fields(self, table, part: MessageTable, label: bool) -> None:
        look = self.look
        fill = (
            FontFace(emphasis="BOLD", fill_color=look.head_fill)
            if look.head_fill
            else FontFace(emphasis="BOLD")
        )
        row = table.row()
        if label:
            row.cell(part.label, style=fill)
        for index, text in enumerate(FIELD_TITLES):
            row.cell(
                self.title(text),
                style=fill,
                align=look.figures if index < 2 else "LEFT",
            )
        for cells in part.rows:
            row = table.row()
            if label:
                row.cell("")
            for index, text in enumerate(cells):
                row.cell(text, align=look.figures if index < 2 else "LEFT")

    def plain(self, part: PlainTable) -> None:
        self.font()
        count = len(part.titles)
        widths = {
            2: (40, 60),
            3: (25, 35, 40),
            4: (10, 30, 45, 15),
            5: (9, 9, 27, 40, 15),
        }[count]
        if part.kind == "loggable":
            widths = (45, 20, 35)
        with self.table(widths, True) as table:
            row = table.row()
            for text in part.titles:
                row.cell(self.title(text))
            for cells in part.rows:
                row = table.row()
                if len(cells) == 1:
                    row.cell(cells[0], colspan=count, style=FontFace(emphasis="BOLD"))
                    continue
                for text in cells:
                    row.cell(text)
