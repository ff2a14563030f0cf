"""Draws the data sheet of the Mistral, a wind sensor that nobody builds: a register
map.  python mistral.py mistral.pdf
"""

import sys

from fpdf import FPDF

# Address, register, access, and what stands in bits 7 to 0: text, and over how many
# bits.
REGISTERS = [
    ("0x0F", "DEVICE_ID", "R", [("ID", 8)]),
    ("0x10", "CONTROL", "R/W", [("RUN", 1), ("HEAT", 1), ("-", 3), ("RATE", 3)]),
    ("0x20", "STATUS", "R", [("READY", 1), ("-", 5), ("HOT", 1), ("FAULT", 1)]),
    ("0x21", "SPEED", "R", [("SPEED", 8)]),
    ("0x22", "TEMPERATURE", "R", [("TEMPERATURE", 8)]),
]
ABOUT = [
    ("SPEED", "Wind speed in steps of 0.5 m/s."),
    ("TEMPERATURE", "Of the housing in degC, two's complement."),
    (
        "RUN",
        "1: measure. HEAT: 1: heat the housing. RATE: measurements a second, 0 to 7.",
    ),
]


def draw(path: str) -> None:
    """Writes the PDF: a page with the map, and a list of what the bits mean."""
    pdf = FPDF(format="A4")
    pdf.add_page()
    line = {"new_x": "LMARGIN", "new_y": "NEXT"}
    pdf.set_font("Helvetica", "B", 16)
    pdf.cell(0, 12, "Mistral wind sensor", **line)
    pdf.set_font("Helvetica", size=9)
    pdf.multi_cell(
        0,
        5,
        "The registers are read and written over the serial line of the interface board.",
        **line,
    )
    pdf.cell(0, 10, "3 Register map", **line)
    with pdf.table(col_widths=(16, 30, 12, *(12,) * 8)) as table:
        table.row(["Addr", "Register", "R/W", *(str(bit) for bit in range(7, -1, -1))])
        for address, name, access, bits in REGISTERS:
            row = table.row([address, name, access])
            for text, width in bits:
                row.cell(text, colspan=width)
    pdf.ln(6)
    for name, text in ABOUT:
        pdf.multi_cell(0, 5, f"{name}: {text}", **line)
    pdf.output(path)


if __name__ == "__main__":
    draw(sys.argv[1])
