"""Measure the reading of tables in a long data sheet, compared with pdfminer, which
reads the characters of its pages.

Usage::

    python bench/import_registers.py [PDF] [--pages 110] [--jobs 2]

Without a PDF, a data sheet is drawn: a register map and a bit table on each page, with
text between them.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

PARTS = ("pdfminer", "tables")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pdf", type=Path, nargs="?")
    parser.add_argument("--pages", type=int, default=110)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--part", choices=PARTS, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.part:
        measure(options.pdf, options.part, options.jobs)
        return
    with tempfile.TemporaryDirectory() as folder:
        pdf = options.pdf or draw(Path(folder, "registers.pdf"), options.pages)
        seconds = {}
        # Separate processes, so that no part finds modules loaded by another
        for part in PARTS:
            command = [
                sys.executable,
                __file__,
                str(pdf),
                "--part",
                part,
                "--jobs",
                str(options.jobs),
            ]
            seconds[part] = float(
                subprocess.run(
                    command, capture_output=True, text=True, check=True
                ).stdout
            )
            print(f"{part}: {seconds[part]:.1f} s of processor time")
    print(f"ratio: {seconds['tables'] / seconds['pdfminer']:.2f}")


def measure(pdf: Path, part: str, jobs: int) -> None:
    """Print the processor time of one part, child processes included."""
    if part == "pdfminer":
        from pdfminer.high_level import extract_pages

        for _ in extract_pages(pdf):
            pass
    else:
        from icdgen.importer import profile, sources

        sources.read(pdf, profile.load(), jobs=jobs)
    used = [
        resource.getrusage(who)
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    ]
    print(sum(usage.ru_utime + usage.ru_stime for usage in used))


def draw(path: Path, pages: int) -> Path:
    """Draw a data sheet and return its path."""
    from reportlab.lib import colors
    from reportlab.lib.styles import getSampleStyleSheet
    from reportlab.platypus import PageBreak, Paragraph, SimpleDocTemplate, Table

    style = getSampleStyleSheet()
    grid = [
        ("GRID", (0, 0), (-1, -1), 0.5, colors.black),
        ("FONTSIZE", (0, 0), (-1, -1), 7),
    ]
    text = (
        "The register is written over the serial interface; the value is taken over with the next sample. "
        * 6
    )
    story: list[object] = []
    for page in range(pages):
        registers = [
            ["Addr", "Name", "Access", *(str(bit) for bit in range(7, -1, -1))]
        ]
        registers += [
            [
                f"0x{16 * page + row & 0xFFF:03X}",
                f"REG_{page}_{row}",
                "RW",
                *(f"b{bit}" for bit in range(8)),
            ]
            for row in range(12)
        ]
        bits = [["Bit", "Name", "Reset", "Access", "Description"]]
        bits += [
            [f"{bit}", f"FLAG_{bit}", "0", "RW", "Enables the output of the block"]
            for bit in range(7, -1, -1)
        ]
        story += [
            Paragraph(f"{page + 1} Block {page}", style["Heading2"]),
            Paragraph(text, style["BodyText"]),
        ]
        story += [
            Table(registers, style=grid),
            Paragraph(text, style["BodyText"]),
            Table(bits, style=grid),
            PageBreak(),
        ]
    SimpleDocTemplate(str(path)).build(story)
    return path


if __name__ == "__main__":
    main()
