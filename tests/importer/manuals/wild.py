"""Documents in the style of vendors of sensors and modems, each with its ICD and the
profile that it needs.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path

import fpdf
from reportlab.lib import colors
from reportlab.lib.pagesizes import A4, LETTER
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.platypus import Paragraph, SimpleDocTemplate, Spacer, Table, TableStyle

from tests.importer.manuals import browser

TYPES = {"uint": "unsigned", "int": "signed"}


def field(at: int, bits: int, name: str, kind: str = "uint", **facts: str) -> dict:
    return {"at": at, "bits": bits, "name": name, "type": kind, **facts}


MESSAGES = [
    {"name": "Motor State", "id": 0x21, "kind": "telemetry", "length": 9, "fields": [
        field(0, 8, "Mode"), field(8, 16, "Speed", unit="rpm"), field(24, 16, "Current", "int", unit="mA", formula="raw*10"),
        field(40, 32, "Uptime", unit="ms")]},
    {"name": "Temperatures", "id": 0x22, "kind": "telemetry", "length": 6, "fields": [
        field(0, 16, "Winding", "int", unit="C", formula="raw*0.01"),
        field(16, 16, "Bridge", "int", unit="C", formula="raw*0.01"),
        field(32, 16, "Supply", unit="mV")]},
    {"name": "Limits", "id": 0x7F, "kind": "telemetry", "length": 5, "fields": [
        field(0, 8, "Profile"), field(8, 32, "Energy", unit="J")]},
]  # fmt: skip
REGISTERS = [
    {"name": "CTRL_A", "set_id": 0x20, "get_id": 0x20, "kind": "configuration", "length": 1, "fields": [
        field(0, 1, "EN", "bool"), field(1, 1, "BOOT", "bool"), field(3, 2, "MODE"), field(5, 3, "ODR")]},
    {"name": "STATUS", "id": 0x27, "kind": "telemetry", "length": 1, "fields": [
        field(0, 1, "READY", "bool"), field(7, 1, "OVR", "bool")]},
    {"name": "OUT_X", "id": 0x28, "kind": "telemetry", "length": 1, "fields": [field(0, 8, "X")]},
]  # fmt: skip
FRAMES = [
    {"name": "Power", "id": 0x31, "kind": "telemetry", "length": 8, "fields": [
        field(0, 16, "Voltage"), field(16, 16, "Current"), field(32, 8, "Load"), field(40, 24, "Energy")]},
    {"name": "Drive", "id": 0x32, "kind": "telemetry", "length": 8, "fields": [
        field(0, 32, "Position"), field(32, 16, "Torque"), field(48, 8, "Gear"), field(56, 8, "Faults")]},
]  # fmt: skip
PROSE = "The host asks for it by its number; the module answers within ten milliseconds, and never without being asked."


@dataclass(frozen=True)
class Wild:
    """A layout: the function that draws it, the ICD that it shows, and the rules that
    read it.
    """

    draw: Callable[[Path], None]
    messages: list[dict]
    profile: str


def size(field: dict) -> str:
    """Return the type with its width as data sheets print it."""
    return {
        "uint": {8: "U8", 16: "U16", 32: "U32"},
        "int": {8: "S8", 16: "S16", 32: "S32"},
    }[field["type"]][field["bits"]]


def unit(field: dict) -> str:
    """Return the printed unit."""
    return {"C": "degC"}.get(field.get("unit", "-"), field.get("unit", "-"))


def _scaled(field: dict) -> str:
    factor = field.get("formula", "").removeprefix("raw*")
    return f"{factor} {unit(field).strip('-')}".strip() or "-"


def platypus(
    path: Path, page: tuple[float, float], story: list, rules: str = "grid"
) -> None:
    style = getSampleStyleSheet()
    small = style["BodyText"].clone("small", fontSize=8, leading=10)
    flowables: list = []
    for part in story:
        if isinstance(part, str):
            heading = part.startswith("# ")
            flowables.append(
                Paragraph(
                    escape(part.removeprefix("# ")),
                    style["Heading2"] if heading else style["BodyText"],
                )
            )
            continue
        rows, spans, widths = part
        table = Table(
            [[Paragraph(escape(cell), small) for cell in row] for row in rows],
            colWidths=widths,
        )
        grid = [("GRID", (0, 0), (-1, -1), 0.5, colors.black)]
        ends = [
            ("LINEABOVE", (0, 0), (-1, 1), 0.8, colors.black),
            ("LINEBELOW", (0, -1), (-1, -1), 0.8, colors.black),
        ]
        table.setStyle(TableStyle([*(grid if rules == "grid" else ends), *spans]))
        flowables += [table, Spacer(1, 10)]
    SimpleDocTemplate(
        str(path), pagesize=page, title="Motor controller", invariant=1
    ).build(flowables)


def web(path: Path, style: str, body: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        browser.print_page(
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Motor controller</title><style>{style}</style>'
            f"</head><body>{body}</body></html>", path, Path(folder),
        )  # fmt: skip


def sections(path: Path) -> None:
    """Draw ids in section headings, offsets and sizes in bytes, and a column for the
    factor.
    """
    story: list = ["# 4 Telemetry", PROSE]
    for index, message in enumerate(MESSAGES, 1):
        rows = [["Offset", "Size", "Field", "Type", "Unit", "Scale"]]
        for field in message["fields"]:
            factor = field.get("formula", "raw*1").removeprefix("raw*")
            rows.append(
                [
                    str(field["at"] // 8),
                    str(field["bits"] // 8),
                    field["name"],
                    size(field),
                    unit(field),
                    factor,
                ]
            )
        story += [
            f"# 4.{index} {message['name']} (0x{message['id']:02X})",
            PROSE,
            (rows, [], [45, 40, 110, 60, 60, 60]),
        ]
    platypus(path, A4, story)


def prose(path: Path) -> None:
    """Draw ids in the prose, no offsets, C types, no vertical rules."""
    body = "<h1>Housekeeping</h1>"
    for message in MESSAGES:
        rows = "".join(
            f"<tr><td>{field['name']}<td>{field['type']}{field['bits']}_t<td>{_scaled(field)}</tr>"
            for field in message["fields"]
        )
        body += f"<h2>{message['name']}</h2><p>Message ID: {message['id']}. {PROSE}</p>"
        body += f"<table><tr><th>Field<th>Type<th>Unit</tr>{rows}</table>"
    web(
        path,
        "table {border-collapse: collapse; width: 70%} tr {border-bottom: 1px solid #777} td, th {text-align: left}",
        body,
    )


def registers(path: Path) -> None:
    """Draw a register map whose cells span the bits of a field."""
    pdf = fpdf.FPDF(format="A4")
    pdf.add_page()
    pdf.set_font("Helvetica", size=9)
    pdf.cell(0, 10, "7 Register map", new_x="LMARGIN", new_y="NEXT")
    with pdf.table(col_widths=(16, 20, 12, *(9,) * 8)) as table:
        table.row(["Addr", "Register", "R/W", *(str(bit) for bit in range(7, -1, -1))])
        for message in REGISTERS:
            row = table.row()
            row.cell(f"0x{message.get('id', message.get('set_id')):02X}")
            row.cell(message["name"])
            row.cell("R/W" if message["kind"] == "configuration" else "R")
            bit = 7
            while bit >= 0:
                field = next(
                    (f for f in message["fields"] if f["at"] + f["bits"] - 1 == bit),
                    None,
                )
                row.cell(
                    field["name"] if field else "-",
                    colspan=field["bits"] if field else 1,
                )
                bit -= field["bits"] if field else 1
    pdf.output(str(path))


def bit_tables(path: Path) -> None:
    """Draw a table for each register, with descending bits, address and access in the
    heading.
    """
    story: list = ["# Registers", PROSE]
    for message in REGISTERS:
        rows = [["Bits", "Name", "Description"]]
        for field in sorted(message["fields"], key=lambda f: -f["at"]):
            high = field["at"] + field["bits"] - 1
            rows.append(
                [
                    str(high) if field["bits"] == 1 else f"{high}:{field['at']}",
                    field["name"],
                    "see the text",
                ]
            )
        access = "R/W" if message["kind"] == "configuration" else "read-only"
        story += [
            f"# {message['name']} (0x{message.get('id', message.get('set_id')):02X}), {access}",
            (rows, [], [50, 90, 200]),
        ]
    platypus(path, LETTER, story)


def ranges(path: Path) -> None:
    """Draw bytes as ranges, unit and factor in one cell, ids in captions without
    numbers.
    """
    body = "<h1>Telemetry</h1>"
    for message in MESSAGES:
        rows = ""
        for field in message["fields"]:
            first, last = field["at"] // 8, (field["at"] + field["bits"]) // 8 - 1
            where = f"{first}" if first == last else f"{first}-{last}"
            rows += f"<tr><td>{where}<td>{field['name']}<td>{TYPES[field['type']]}<td>{_scaled(field)}</tr>"
        body += f"<p>{PROSE}</p><p><b>{message['name']}: 0x{message['id']:04X}</b></p>"
        body += f"<table><tr><th>Byte<th>Parameter<th>Format<th>Unit</tr>{rows}</table>"
    web(
        path,
        "table {border-collapse: collapse} td, th {border: 1px solid #333; padding: 3px 9px; text-align: left}",
        body,
    )


def two_heads(path: Path) -> None:
    """Draw a heading over two columns, the byte and the bit in it."""
    story: list = ["# Telemetry", PROSE]
    for message in MESSAGES:
        rows = [
            ["Position", "", "Length (bits)", "Name", "Type", "Unit"],
            ["Byte", "Bit", "", "", "", ""],
        ]
        for field in message["fields"]:
            rows.append(
                [
                    str(field["at"] // 8),
                    "0",
                    str(field["bits"]),
                    field["name"],
                    size(field),
                    _scaled(field),
                ]
            )
        spans = [
            ("SPAN", (0, 0), (1, 0)),
            *(("SPAN", (i, 0), (i, 1)) for i in range(2, 6)),
        ]
        story += [
            f"# {message['name']} (0x{message['id']:02X})",
            (rows, spans, [40, 40, 70, 110, 60, 70]),
        ]
    platypus(path, A4, story)


NODE = "profile: 1\nnode: {byte_order: little, bit_order: lsb0}\n"
WORDS = "types: {unsigned: {type: uint}, signed: {type: int}}\n"


def rule(head: str, message: str, columns: str, *more: str) -> str:
    """Return a profile with one rule for tables of messages."""
    lines = [
        f"tables: {{head: {head}}}",
        f"message: {{{message}, kind: telemetry}}",
        f"columns: {{{columns}}}",
        *more,
    ]
    return f"{NODE}rules:\n  - " + "\n    ".join(lines) + "\n"


BY_HEADING = r"heading: '^(?:[\d.]+ )?{message} (?:\(|- ){id}\)?$'"
FACTOR = r"['^{scale}(?: {unit:\S+})?$', '^{unit:[^0-9]+}$']"


def registers_rule(head: str, message: str, columns: str, *more: str) -> str:
    """Return a profile with one rule for registers whose access gives their kind."""
    kinds = "map: {kind: {R: telemetry, read-only: telemetry, R/W: configuration}}"
    flags = "set: [{where: {name: '^(EN|BOOT|READY|OVR)$'}, type: bool}]"
    lines = [f"tables: {{head: {head}}}", "what: registers", f"message: {{{message}}}", f"columns: {{{columns}}}", kinds,
             "each: {type: uint}", flags, *more]  # fmt: skip
    return f"{NODE}reserved: ['-']\nrules:\n  - " + "\n    ".join(lines) + "\n"


WILD = {
    "sections": Wild(sections, MESSAGES, rule(
        "Offset | Size | Field", BY_HEADING, "Offset: byte, Size: bytes, Field: name, Type: type, Unit: unit, Scale: scale")),
    "prose": Wild(prose, MESSAGES, rule(
        "Field | Type | Unit", "heading: '^{message}$', before: '^Message ID: {id}'", f"Field: name, Type: type, Unit: {FACTOR}")),
    "registers": Wild(registers, REGISTERS, registers_rule(
        "Addr | Register | R/W | 7", "length: 1", 'Addr: id, Register: message, R/W: kind, "*": name', "melt: '^{bit}$'")),
    "bit tables": Wild(bit_tables, REGISTERS, registers_rule(
        "Bits | Name | Description", r"length: 1, heading: '^{message} \({id}\), {kind:R/W|read-only}$'",
        r"Bits: '^{bit}(?::{last_bit})?$', Name: name, Description: text", "width: unit")),
    "ranges": Wild(ranges, MESSAGES, rule(
        "Byte | Parameter | Format", "before: '^{message}: {id}$'",
        f"Byte: '^{{byte}}(?:-{{last_byte}})?$', Parameter: name, Format: type, Unit: {FACTOR}", "width: unit") + WORDS),
    "two heads": Wild(two_heads, MESSAGES, rule(
        "Position | Length (bits)", BY_HEADING,
        f"Position Byte: byte, Position Bit: bit, Length (bits): bits, Name: name, Type: type, Unit: {FACTOR}", "head_rows: 2")),
}  # fmt: skip


# Added after the importer read the documents above without a difference.


def bare(path: Path) -> None:
    """Draw tables without any rules, ids in headings without numbers, positions in
    bytes.
    """
    pdf = fpdf.FPDF(format="Letter")
    pdf.add_page()
    pdf.set_font("Times", "B", 16)
    pdf.cell(0, 10, "Telemetry", new_x="LMARGIN", new_y="NEXT")
    for message in MESSAGES:
        pdf.set_font("Times", "B", 12)
        pdf.cell(
            0,
            9,
            f"{message['name']} - 0x{message['id']:02X}",
            new_x="LMARGIN",
            new_y="NEXT",
        )
        pdf.set_font("Times", size=10)
        pdf.multi_cell(0, 5, PROSE, new_x="LMARGIN", new_y="NEXT")
        pdf.ln(2)
        with pdf.table(borders_layout="NONE", col_widths=(15, 15, 30, 20, 20)) as table:
            table.row(["Start Byte", "Bytes", "Signal", "Data Type", "Scaling"])
            for field in message["fields"]:
                table.row(
                    [
                        str(field["at"] // 8),
                        str(field["bits"] // 8),
                        field["name"],
                        size(field),
                        _scaled(field),
                    ]
                )
        pdf.ln(4)
    pdf.output(str(path))


def frames(path: Path) -> None:
    """Draw frames of eight bytes as columns, a table for each."""
    body = "<h1>Telemetry</h1>"
    for message in FRAMES:
        cells = "".join(
            f"<td colspan={field['bits'] // 8}>{field['name']}</td>"
            for field in message["fields"]
        )
        body += f"<h2>{message['name']} (0x{message['id']:02X})</h2><p>{PROSE}</p><table><tr>"
        body += (
            "".join(f"<th>Byte{n}</th>" for n in range(8))
            + f"</tr><tr>{cells}</tr></table>"
        )
    web(
        path,
        "table {border-collapse: collapse; width: 100%} td, th {border: 1px solid #333; padding: 4px}",
        body,
    )


def lined(path: Path) -> None:
    """Draw rules above and below only, ids in the labelled prose, widths in words."""
    story: list = ["# 3 Telemetry"]
    for index, message in enumerate(MESSAGES, 1):
        rows = [["Byte Offset", "Size", "Parameter", "Encoding", "Conversion"]]
        for field in message["fields"]:
            count = field["bits"] // 8
            words = f"{count} byte{'s' if count > 1 else ''}"
            rows.append(
                [
                    str(field["at"] // 8),
                    words,
                    field["name"],
                    TYPES[field["type"]],
                    _scaled(field),
                ]
            )
        story += [
            f"# 3.{index} {message['name']}",
            f"Telemetry ID {message['id']}. {PROSE}",
            (rows, [], [70, 60, 110, 80, 80]),
        ]
    platypus(path, LETTER, story, "ends")


def beside(path: Path) -> None:
    """Draw two tables side by side with different heights, their headings in one line
    above them.
    """
    style = getSampleStyleSheet()

    def cell(message: dict) -> list:
        rows = [["Offset", "Size", "Field", "Type", "Unit"]]
        for field in message["fields"]:
            rows.append(
                [
                    str(field["at"] // 8),
                    str(field["bits"] // 8),
                    field["name"],
                    size(field),
                    _scaled(field),
                ]
            )
        table = Table(
            rows,
            colWidths=[38, 32, 58, 36, 64],
            style=[("GRID", (0, 0), (-1, -1), 0.5, colors.black)],
        )
        return [
            Paragraph(
                f"<b>{message['name']} (0x{message['id']:02X})</b>", style["BodyText"]
            ),
            table,
        ]

    first, second, third = (cell(message) for message in MESSAGES)
    rows = [
        Table(
            [[first, second]],
            colWidths=[250, 250],
            style=[("VALIGN", (0, 0), (-1, -1), "TOP")],
        ),
        *third,
    ]
    story = [
        Paragraph("4 Telemetry", style["Heading2"]),
        Paragraph(PROSE, style["BodyText"]),
        *rows,
    ]
    SimpleDocTemplate(
        str(path), pagesize=A4, leftMargin=45, rightMargin=45, invariant=1
    ).build(story)


def byte_lines(path: Path) -> None:
    """Draw frames as lines, one per field, without any table."""
    pdf = fpdf.FPDF(format="A4")
    pdf.add_page()
    pdf.set_font("Helvetica", "B", 15)
    pdf.cell(0, 12, "Telemetry", new_x="LMARGIN", new_y="NEXT")
    for message in FRAMES:
        pdf.set_font("Helvetica", "B", 11)
        pdf.cell(
            0,
            10,
            f"{message['name']} (0x{message['id']:02X})",
            new_x="LMARGIN",
            new_y="NEXT",
        )
        pdf.set_font("Helvetica", size=9)
        for field in message["fields"]:
            first, last = field["at"] // 8, (field["at"] + field["bits"]) // 8 - 1
            where = f"Byte{first}" if first == last else f"Byte{first}~Byte{last}"
            pdf.cell(0, 6, f"{where}: {field['name']}", new_x="LMARGIN", new_y="NEXT")
        pdf.ln(4)
    pdf.output(str(path))


WILD |= {
    "beside": Wild(beside, MESSAGES, rule(
        "Offset | Size | Field", f"before: {BY_HEADING.partition(' ')[2]}",
        f"Offset: byte, Size: bytes, Field: name, Type: type, Unit: {FACTOR}")),
    "byte lines": Wild(byte_lines, FRAMES, rule(
        "Byte | Name", BY_HEADING, "Byte: '^{byte}(?:-{last_byte})?$', Name: name", "width: unit", "each: {type: uint}")),
}  # fmt: skip


UNSEEN = {
    "bare": Wild(bare, MESSAGES, rule(
        "Start Byte | Bytes | Signal", BY_HEADING,
        f"Start Byte: byte, Bytes: bytes, Signal: name, Data Type: type, Scaling: {FACTOR}")),
    "frames": Wild(frames, FRAMES, rule(
        "Byte0 | Byte1", BY_HEADING, '"*": name', "melt: '^Byte{byte}$'", "each: {type: uint}")),
    "lined": Wild(lined, MESSAGES, rule(
        "Byte Offset | Size | Parameter", "heading: '^[\\d.]+ {message}$', before: '^Telemetry ID {id}[.]'",
        f"Byte Offset: byte, Size: '^{{bytes}} bytes?$', Parameter: name, Encoding: type, Conversion: {FACTOR}") + WORDS),
}  # fmt: skip
