"""Manuals made by a browser: HTML printed to PDF."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from html import escape
from pathlib import Path

from tests.importer.manuals.content import (
    FIELD_TITLES,
    Manual,
    MessageTable,
    PlainTable,
    Prose,
)


@dataclass(frozen=True)
class BrowserLook:
    """The properties of a layout."""

    page: str = "A4"
    font: str = "serif"
    size: float = 9
    borders: str = "grid"  # "grid" | "rows" | "columns" | "ends" | "none"
    caption_below: bool = False
    mark: str = ": "
    repeat: bool = True  # the headings on each page
    stripes: bool = False
    justify: bool = False  # hyphenated
    two_lines: bool = False
    tear: bool = True  # rows over page breaks


_BORDERS = {
    "grid": "td, th { border: 0.6pt solid #222; }",
    "rows": "tr { border-bottom: 0.5pt solid #555; } thead tr:last-child { border-top: 1pt solid #000; }",
    "columns": "td, th { border-left: 0.5pt solid #444; border-right: 0.5pt solid #444; } table { border: 0.8pt solid #000; }",
    "ends": "table { border-top: 1pt solid #000; border-bottom: 1pt solid #000; } thead { border-bottom: 0.6pt solid #000; }",
    "none": "",
}


def program() -> str | None:
    """Return the path of the browser, or ``None``."""
    return next(
        (
            path
            for name in ("chromium", "chromium-browser", "google-chrome")
            if (path := shutil.which(name))
        ),
        None,
    )


def draw(manual: Manual, path: Path, look: BrowserLook) -> None:
    """Write the PDF."""
    with tempfile.TemporaryDirectory() as folder:
        print_page(html(manual, look), path, Path(folder))


def print_page(text: str, path: Path, folder: Path) -> None:
    """Print a page of HTML. ``folder`` is for temporary files of the browser."""
    browser = program()
    assert browser, "the tests need Chromium"
    page = folder / "page.html"
    page.write_text(text, encoding="utf-8")
    command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer", f"--user-data-dir={folder}/u",
               f"--print-to-pdf={path}", page.as_uri()]  # fmt: skip
    subprocess.run(command, check=True, capture_output=True, timeout=120)


def html(manual: Manual, look: BrowserLook) -> str:
    """Return the page that is printed."""
    side = "justify" if look.justify else "left"
    under = ("1mm", "6mm", "before") if look.caption_below else ("5mm", "1mm", "after")
    style = f"""
    @page {{ size: {look.page}; margin: 20mm 18mm; }}
    body {{ font: {look.size}pt/1.25 {look.font}; {"text-align: justify; hyphens: auto;" if look.justify else ""} }}
    table {{ border-collapse: collapse; width: 100%; margin: 0 0 {under[0]}; text-align: {side}; }}
    td, th {{ padding: 1.2mm 1.6mm; vertical-align: top; text-align: inherit; overflow-wrap: normal; }}
    th {{ font-weight: bold; text-align: left; hyphens: manual; overflow-wrap: normal; }}
    thead {{ display: {"table-header-group" if look.repeat else "table-row-group"}; }}
    tr {{ break-inside: {"auto" if look.tear else "avoid"}; }}
    p.caption {{ font-style: italic; margin: 1mm 0 {under[1]}; break-{under[2]}: avoid; }}
    h2 {{ font-size: {look.size + 5}pt; }} pre {{ border: 0.5pt solid #999; }}
    {"tbody tr:nth-child(even) { background: #eef2fa; }" if look.stripes else ""}
    {_BORDERS[look.borders]}"""
    parts = "\n".join(_part(part, look) for part in manual.parts)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(manual.title)}</title>'
        f"<style>{style}</style></head><body>\n{parts}\n</body></html>\n"
    )


def _part(part: object, look: BrowserLook) -> str:
    if isinstance(part, Prose):
        tag = {"heading": "h2", "code": "pre"}.get(part.style, "p")
        return f"<{tag}>{escape(part.text)}</{tag}>"
    assert isinstance(part, MessageTable | PlainTable)
    caption = f'<p class="caption">{escape(f"Table {part.number}{look.mark}{part.title}")}</p>'
    table = (
        _message(part, look) if isinstance(part, MessageTable) else _plain(part, look)
    )
    return table + caption if look.caption_below else caption + table


def _title(text: str, look: BrowserLook) -> str:
    html = escape(text)
    return html.replace(" ", "<br>", 1) if look.two_lines else html


def _message(part: MessageTable, look: BrowserLook) -> str:
    (first, first_value), (second, two) = part.pairs
    head = (
        f"<tr><th>{first}</th><td>{first_value}</td><th colspan=2>{second}</th><td colspan=2>{two}</td></tr>"
        f"<tr><th>Description</th><td colspan=5>{escape(part.description)}</td></tr>"
    )
    if not part.rows:
        return (
            f"<table>{_columns((12, 10, 9, 24, 11, 34))}<tbody>{head}</tbody></table>"
        )
    titles = "".join(f"<th>{_title(text, look)}</th>" for text in ["", *FIELD_TITLES])
    rows = "".join(
        "<tr><td></td>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>"
        for row in part.rows
    )
    inner = f"<thead><tr>{titles}</tr></thead><tbody>{rows}</tbody>"
    # Only the headings repeat, so the rows above them are a separate table.
    if look.repeat:
        above = f'<table style="margin: 0">{_columns((12, 10, 9, 24, 11, 34))}<tbody>{head}</tbody></table>'
        return f"{above}<table>{_columns((12, 10, 9, 24, 11, 34))}{inner}</table>"
    body = f"<tbody>{head}<tr>{titles}</tr>{rows}</tbody>"
    return f"<table>{_columns((12, 10, 9, 24, 11, 34))}{body}</table>"


def _plain(part: PlainTable, look: BrowserLook) -> str:
    count = len(part.titles)
    widths = {2: (40, 60), 3: (25, 35, 40), 4: (10, 30, 45, 15), 5: (9, 9, 27, 40, 15)}[
        count
    ]
    if part.kind == "loggable":
        widths = (45, 20, 35)
    titles = "".join(f"<th>{_title(text, look)}</th>" for text in part.titles)
    rows = ""
    for row in part.rows:
        if len(row) == 1:
            rows += f"<tr><th colspan={count}>{escape(row[0])}</th></tr>"
        else:
            rows += (
                "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>"
            )
    return f"<table>{_columns(widths)}<thead><tr>{titles}</tr></thead><tbody>{rows}</tbody></table>"


def _columns(widths: tuple[int, ...]) -> str:
    return (
        "<colgroup>"
        + "".join(f'<col style="width: {w}%">' for w in widths)
        + "</colgroup>"
    )
