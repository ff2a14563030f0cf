"""A layout made by an office suite: heading styles, ruled tables with repeated
headings, ids in the headings.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from html import escape
from pathlib import Path

from tests.importer.manuals.wild import (
    BY_HEADING,
    MESSAGES,
    PROSE,
    Wild,
    rule,
    size,
    unit,
)

HEADS = ["Byte Offset", "Bytes", "Parameter", "Type", "Unit", "Scale"]


def program() -> str | None:
    """Return the path of LibreOffice, or ``None``."""
    return shutil.which("soffice") or shutil.which("libreoffice")


def draw(path: Path) -> None:
    """Write a document and let the office suite convert it to PDF."""
    suite = program()
    assert suite, "the layout needs LibreOffice"
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "manual.fodt")
        source.write_text(_document(), encoding="utf-8")
        command = [
            suite,
            "--headless",
            f"-env:UserInstallation=file://{folder}/user",
            "--convert-to",
            "pdf",
            "--outdir",
            folder,
        ]
        subprocess.run([*command, source], check=True, capture_output=True, timeout=180)
        shutil.copy(Path(folder, "manual.pdf"), path)


def _document() -> str:
    spaces = " ".join(
        f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{what}:1.0"'
        for name, what in (("office", "office"), ("text", "text"), ("table", "table"), ("style", "style"),
                           ("fo", "xsl-fo-compatible"))
    )  # fmt: skip
    styles = "".join(
        f'<style:style style:name="Heading_20_{level}" style:family="paragraph"><style:text-properties fo:font-size="{points}pt" '
        'fo:font-weight="bold"/></style:style>' for level, points in ((1, 18), (2, 14))
    )  # fmt: skip
    body = _heading(1, "Telemetry") + _paragraph(PROSE)
    for message in MESSAGES:
        body += (
            _heading(2, f"{message['name']} (0x{message['id']:02X})")
            + _paragraph(PROSE)
            + _table(message)
        )
        body += _paragraph("")
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><office:document {spaces} office:version="1.3" '
        f'office:mimetype="application/vnd.oasis.opendocument.text"><office:styles>{styles}</office:styles>'
        "<office:automatic-styles>"
        '<style:style style:name="Cell" style:family="table-cell"><style:table-cell-properties '
        'fo:border="0.5pt solid #000000" fo:padding="0.06cm"/></style:style></office:automatic-styles>'
        f"<office:body><office:text>{body}</office:text></office:body></office:document>\n"
    )


def _heading(level: int, text: str) -> str:
    return f'<text:h text:style-name="Heading_20_{level}" text:outline-level="{level}">{escape(text)}</text:h>'


def _paragraph(text: str) -> str:
    return f"<text:p>{escape(text)}</text:p>"


def _table(message: dict) -> str:
    rows = [
        [
            str(field["at"] // 8),
            str(field["bits"] // 8),
            field["name"],
            size(field),
            unit(field),
            field.get("formula", "raw*1").removeprefix("raw*"),
        ]
        for field in message["fields"]
    ]
    head = f"<table:table-header-rows>{_row(HEADS)}</table:table-header-rows>"
    return (
        f'<table:table><table:table-column table:number-columns-repeated="{len(HEADS)}"/>'
        f"{head}{''.join(_row(row) for row in rows)}</table:table>"
    )


def _row(cells: list[str]) -> str:
    row_xml = "".join(
        f'<table:table-cell table:style-name="Cell" office:value-type="string">{_paragraph(cell)}</table:table-cell>'
        for cell in cells
    )
    return f"<table:table-row>{row_xml}</table:table-row>"


OFFICE = {
    "office": Wild(draw, MESSAGES, rule(
        "Byte Offset | Bytes | Parameter", BY_HEADING,
        "Byte Offset: byte, Bytes: bytes, Parameter: name, Type: type, Unit: unit, Scale: scale")),
}  # fmt: skip
