"""Report of an import as a web page: the picture of each doubtful table next to its
cells as they were read.

`commands/import_.py` writes it for the option `--report`. The page has no other files.
"""

from __future__ import annotations

import base64
import html
import io
from collections import Counter
from collections.abc import Iterator

from icdgen.import_results.findings import CERTAIN, ImportFinding
from icdgen.importer.document import PageBox, SourceCell, SourceTable
from icdgen.importer.model import TableResult
from icdgen.importer.run import Result

RESOLUTION = 110
MARGIN = 6.0
CAPTION = 26.0  # points above and below a table in which its caption stands
MOST_PIXELS = 3_000_000  # of a picture: some pages are posters
MOST = 250  # pictures; a report with more would be too large to open

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 1500px; padding: 0 1rem; color: #1c2330; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin: 2.2rem 0 .4rem; border-top: 1px solid #ccd; padding-top: 1rem; }
table { border-collapse: collapse; font-size: 13px; } td, th { border: 1px solid #cbd2de; padding: 2px 6px; text-align: left;
vertical-align: top; } th { background: #eef1f6; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1.2rem; align-items: start; } .pair > div { overflow-x: auto; }
img { max-width: 100%; border: 1px solid #cbd2de; display: block; margin-bottom: .5rem; }
.error { color: #b00020; } .warning { color: #8a5300; } .note { color: #3a5a80; } .torn td { background: #fff5d6; }
.sure { font-weight: normal; color: #667; } li { margin: .15rem 0; } code { background: #f0f2f6; padding: 0 .2em; }
@media (max-width: 900px) { .pair { grid-template-columns: 1fr; } }
@media (prefers-color-scheme: dark) { body { background: #14181f; color: #dde3ec; } th { background: #232a36; }
td, th, img { border-color: #3a4352; } code { background: #232a36; } .torn td { background: #3b3413; }
.error { color: #ff8a8a; } .warning { color: #ffc46b; } .note { color: #8fbbee; } }
"""


def report(result: Result) -> str:
    """Return the page, with styles and pictures in the same file."""
    from icdgen.importer import console

    name = html.escape(result.document.file)
    about: dict[int | None, list[ImportFinding]] = {}
    for import_finding in result.import_findings:
        for order in dict.fromkeys(
            spot.order for spot in (import_finding.spot, *import_finding.also)
        ):
            about.setdefault(order, []).append(import_finding)
    doubtful = [
        entry
        for entry in result.survey.results
        if result.sure_of(entry.table) != CERTAIN
    ]
    certain = [
        entry
        for entry in result.survey.results
        if result.sure_of(entry.table) == CERTAIN
    ]
    parts = [
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>Import of {name}</title>',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<style>{_STYLE}</style></head><body>\n<h1>Import of {name}</h1>",
        *(f"<p>{html.escape(line)}</p>" for line in console.summary(result)),
    ]
    errors = [t for t in result.import_findings if t.severity == "error"]
    if errors:
        title = "To do first: what is missing from the ICD, or may be wrong in it"
        parts += [f"<h2>{title}</h2>", _list(errors, linked=True)]
    loose = [t for t in about.get(None, []) if t.severity != "error"]
    if loose:
        parts += ["<h2>About the document</h2>", _list(loose)]
    doubtful.sort(key=lambda entry: _stake(about.get(entry.table.spot.order, [])))
    with _Pictures(result) as pictures:
        for entry in doubtful:
            parts += _table(
                entry, result, about.get(entry.table.spot.order, []), pictures
            )
    noted = [t for entry in certain for t in about.get(entry.table.spot.order, [])]
    if noted:
        parts += [
            "<h2>Notes about tables that were read without doubt</h2>",
            _list(noted),
        ]
    return "\n".join(parts) + "\n</body></html>\n"


def _stake(import_findings: list[ImportFinding]) -> tuple[int, int]:
    """Return the sort key of a table: most errors first, then most warnings."""
    counts = Counter(t.severity for t in import_findings)
    return -counts["error"], -counts["warning"]


def _list(import_findings: list[ImportFinding], linked: bool = False) -> str:
    items = []
    for t in import_findings:
        place = f" ({t.spot.place})" if t.spot.place else ""
        help = f" <i>{html.escape(t.help)}.</i>" if t.help else ""
        if linked and t.spot.order is not None:
            place += f' <a href="#table-{t.spot.order}">table</a>'
        items.append(
            f'<li class="{t.severity}"><b>{t.severity}</b> {t.code}{place}: {html.escape(t.message)}{help}</li>'
        )
    return "<ul>" + "\n".join(items) + "</ul>"


def _table(
    entry: TableResult,
    result: Result,
    import_findings: list[ImportFinding],
    pictures: _Pictures,
) -> Iterator[str]:
    table = entry.table
    title = html.escape(table.title[:1].upper() + table.title[1:])
    yield f'<h2 id="table-{table.spot.order}">{title} <span class="sure">{entry.what}, {result.sure_of(table)}</span></h2>'
    yield _list(import_findings)
    images = "".join(pictures.images_of(table))
    rows = ("<tr>" + "".join(map(_cell, row.cells)) + "</tr>" for row in table.rows)
    read = "<table>" + "\n".join(rows) + "</table>"
    yield (
        f'<div class="pair"><div>{images}</div><div>{read}</div></div>'
        if images
        else f"<div>{read}</div>"
    )


def _cell(cell: SourceCell) -> str:
    spans = "".join(
        f' {key}="{n}"'
        for key, n in (("colspan", cell.columns), ("rowspan", cell.rows))
        if n > 1
    )
    return f"<td{spans}>{html.escape(cell.text)}</td>"


class _Pictures:
    """Pictures of tables, cut out of the pages of a PDF; none for other documents."""

    def __init__(self, result: Result) -> None:
        self.result, self.file, self.left = result, None, MOST
        self.pages: dict[int, object] = {}

    def __enter__(self) -> _Pictures:
        if any(entry.table.boxes for entry in self.result.survey.results):
            import pypdfium2  # type: ignore[import-untyped]

            try:
                self.file = pypdfium2.PdfDocument(self.result.document.file)
            except pypdfium2.PdfiumError:
                # PDFium is stricter with broken files than the reader of text.
                self.file = None
        return self

    def __exit__(self, *_: object) -> None:
        if self.file is not None:
            self.file.close()

    def images_of(self, table: SourceTable) -> Iterator[str]:
        for box in table.boxes:
            if self.file is None or self.left <= 0:
                return
            self.left -= 1
            page = self.file[box.page - 1]
            crop = _crop(box, *page.get_size())
            if crop is None:
                yield f"<p>page {box.page}: the table lies outside the visible page</p>"
                continue
            scale = min(
                RESOLUTION / 72, (MOST_PIXELS / (box.width * box.height + 1)) ** 0.5
            )
            image = (
                page.render(scale=scale, crop=crop)
                .to_pil()
                .convert("P", palette=1, colors=32)
            )
            data = io.BytesIO()
            image.save(data, "PNG", optimize=True)
            encoded = base64.b64encode(data.getvalue()).decode("ascii")
            yield f'<img alt="page {box.page}" title="page {box.page}" src="data:image/png;base64,{encoded}">'


def _crop(
    box: PageBox, width: float, height: float
) -> tuple[float, float, float, float] | None:
    """Return the margins to cut off on the left, below, on the right and above.

    Returns None if the whole page would be cut off.
    """
    x0, x1 = max(0.0, box.x0 - MARGIN), min(width, box.x1 + MARGIN)
    top, bottom = max(0.0, box.top - CAPTION), min(height, box.bottom + CAPTION)
    if x1 - x0 < 2 or bottom - top < 2:
        return None
    return x0, height - bottom, width - x1, top
