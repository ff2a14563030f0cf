"""Layouts that were added after the importer supported the first ones: two by Typst,
one by a browser.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.importer.manuals.wild import (
    MESSAGES,
    PROSE,
    REGISTERS,
    Wild,
    registers_rule,
    rule,
    unit,
    web,
)


def typst(path: Path, text: str) -> None:
    """Typeset a text in Typst's markup."""
    import typst

    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "manual.typ")
        source.write_text(text, encoding="utf-8")
        typst.compile(source, output=path)


def _cells(rows: list[list[str]]) -> str:
    return ",\n".join(", ".join(f"[{cell}]" for cell in row) for row in rows)


def _rows(message: dict) -> list[list[str]]:
    html = []
    for field in message["fields"]:
        kind = {"uint": "uint", "int": "int"}[field["type"]] + str(field["bits"])
        factor = field.get("formula", "raw*1").removeprefix("raw*")
        html.append(
            [
                str(field["at"] // 8),
                str(field["bits"] // 8),
                field["name"],
                kind,
                unit(field),
                factor,
            ]
        )
    return html


HEADS = ["Offset (bytes)", "Size (bytes)", "Signal", "Type", "Unit", "Scale"]


def article(path: Path) -> None:
    """Draw an article: numbered sections, three rules per table, captions below, ids in
    the prose.
    """
    text = '#set page("a4", numbering: "1")\n#set text(size: 10pt)\n#set heading(numbering: "1.1")\n#set par(justify: true)\n'
    text += f"= Introduction\n{PROSE}\n= Telemetry\n"
    for message in MESSAGES:
        text += f"== {message['name']}\nMessage ID: 0x{message['id']:02X}. {PROSE}\n"
        text += (
            f"#figure(caption: [{message['name']}], table(columns: 6, stroke: none, align: left, table.hline(),\n"
            f"table.header({_cells([HEADS])}), table.hline(stroke: 0.5pt),\n{_cells(_rows(message))}, table.hline()))\n"
        )
    typst(path, text)


def two_columns(path: Path) -> None:
    """Draw two columns of text per page, ruled tables, captions with the id above them."""
    text = '#set page("us-letter", columns: 2, margin: 1.4cm)\n#set text(size: 8pt)\n#show figure.caption: strong\n'
    text += (
        "#set figure.caption(position: top)\n#set table(stroke: 0.5pt, inset: 3pt)\n"
    )
    text += f"= Telemetry\n{' '.join([PROSE] * 6)}\n\n"
    for message in MESSAGES:
        text += f"{' '.join([PROSE] * 9)}\n\n"
        text += (
            f"#figure(caption: [{message['name']} (0x{message['id']:02X})], table(columns: 6, align: left,\n"
            f"{_cells([['Byte Offset', 'Bytes', 'Field', 'Type', 'Unit', 'Factor'], *_rows(message)])}))\n"
        )
    typst(path, text)


def sheet(path: Path) -> None:
    """Draw a data sheet of registers: access in the heading, reset values, descending
    bits, reserved registers included.
    """
    body = "<h1>Registers</h1>"
    for message in REGISTERS:
        access = "R/W" if message["kind"] == "configuration" else "read-only"
        address = message.get("id", message.get("set_id"))
        rows, bit = "", 7
        while bit >= 0:
            field = next(
                (f for f in message["fields"] if f["at"] + f["bits"] - 1 == bit), None
            )
            low = field["at"] if field else bit
            where = f"{bit}" if low == bit else f"{bit}:{low}"
            rows += f"<tr><td>{where}<td>{field['name'] if field else 'Reserved'}<td>0<td>See the text above</tr>"
            bit = low - 1
        body += f"<h2>Register {message['name']} (address 0x{address:02X}, {access})</h2><p>{PROSE}</p>"
        body += (
            f"<table><tr><th>Bits<th>Field<th>Reset<th>Description</tr>{rows}</table>"
        )
    web(
        path,
        "body {font: 10pt sans-serif} table {border-collapse: collapse; width: 100%} th {background: #333; color: #fff; "
        "text-align: left} td {border-bottom: 1px solid #ccc} td, th {padding: 3px 8px}",
        body,
    )


TYPESET = {
    "article": Wild(article, MESSAGES, rule(
        "Offset (bytes) | Size (bytes)", "heading: '^[\\d.]+ {message}$', before: '^Message ID: {id}[.]'",
        "Offset (bytes): byte, Size (bytes): bytes, Signal: name, Type: type, Unit: unit, Scale: scale")),
    "two columns": Wild(two_columns, MESSAGES, rule(
        "Byte Offset | Bytes | Field", r"caption: '^{message} \({id}\)$'",
        "Byte Offset: byte, Bytes: bytes, Field: name, Type: type, Unit: unit, Factor: scale")),
    "sheet": Wild(sheet, REGISTERS, registers_rule(
        "Bits | Field | Reset", r"length: 1, heading: '^Register {message} \(address {id}, {kind:R/W|read-only}\)$'",
        r"Bits: '^{bit}(?::{last_bit})?$', Field: name, Reset: default, Description: text", "width: unit")),
}  # fmt: skip
