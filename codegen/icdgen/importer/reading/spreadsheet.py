"""Spreadsheets -> documents: CSV with the standard library, XLSX with openpyxl.

A sheet is a section; rows without any text separate its tables. A row of one cell above
a table is a text before it. Merged cells are cells that span rows and columns.
"""

from __future__ import annotations

import csv
import datetime
import io
import zipfile
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.document import (
    Block,
    Document,
    Heading,
    SourceCell,
    SourceRow,
    SourceTable,
    TextBlock,
)
from icdgen.importer.reading.utf8 import utf8_text

CODE = "IMP002"
# Of a sheet: sheets that are formatted to their end have a million rows.
MOST_ROWS, MOST_COLUMNS = 100_000, 1_000
# Number of the row, counted from 1, and the cells that begin in it.
Cells = list[tuple[int, list[SourceCell]]]


def read_csv(path: Path) -> Document:
    """Return the document of a CSV file.

    Raises `Findings` if it is not UTF-8 or no CSV.
    """
    name = str(path)
    text = utf8_text(path, "save it as CSV in UTF-8")
    # Spreadsheet programs write semicolons where the comma is the decimal point. Commas
    # of descriptions can be more, but do not stand in each line.
    lines = text[:10_000].splitlines()
    delimiter = max(
        ",;\t|",
        key=lambda mark: (sum(mark in line for line in lines), text.count(mark)),
    )
    rows: Cells = []
    reader = csv.reader(io.StringIO(text), delimiter=delimiter, strict=True)
    try:
        start = 1
        for row in reader:
            rows.append(
                (
                    start,
                    [SourceCell(cell.strip().replace("\r\n", "\n")) for cell in row],
                )
            )
            # A row has several lines if a quoted cell contains line ends.
            start = reader.line_num + 1
    except csv.Error as error:
        message = f"this CSV cannot be parsed: {error}"
        # A quote that is not closed extends to the end of the file.
        is_open = str(error) == "unexpected end of data"
        raise Findings(
            [
                Finding(
                    CODE,
                    message,
                    Place(name, start if is_open else reader.line_num),
                    "check the quotes in this line",
                )
            ]
        ) from None
    document = Document(name)
    document.blocks = _blocks(rows, "")
    return document


def read_xlsx(path: Path) -> Document:
    """Return the document of a workbook.

    Raises `Findings` if it cannot be read, `UserError` without openpyxl.
    """
    try:
        import openpyxl
        from openpyxl.utils.exceptions import InvalidFileException
    except ImportError:
        raise UserError(
            "reading a spreadsheet needs openpyxl", "pip install 'icdgen[import]'"
        ) from None
    try:
        # openpyxl gives either the values or the formulas of cells.
        book = openpyxl.load_workbook(path, data_only=True)
        formulas = openpyxl.load_workbook(path)
    except (
        InvalidFileException,
        zipfile.BadZipFile,
        KeyError,
        ValueError,
        OSError,
    ) as error:
        help = "open it in a spreadsheet program and save it as .xlsx"
        raise Findings(
            [
                Finding(
                    CODE,
                    f"the workbook cannot be read: {error}",
                    Place(str(path)),
                    help,
                )
            ]
        ) from None
    document = Document(str(path), title=str(book.properties.title or ""))
    for sheet in book.worksheets:
        if sheet.sheet_state != "visible":
            document.import_findings.append(
                ImportFinding(
                    "IMP013",
                    f"the sheet `{sheet.title}` is hidden; it was left out",
                    help="show it if it has tables",
                    severity="note",
                )
            )
            continue
        reader = _Sheet(sheet, formulas[sheet.title], document)
        document.blocks += [
            Heading("", sheet.title),
            *_blocks(reader.rows(), sheet.title),
        ]
    return document


class _Sheet:
    """A sheet with the values of its cells, and the same sheet with their formulas."""

    def __init__(self, sheet: Any, formulas: Any, document: Document) -> None:
        self.sheet, self.formulas, self.document = sheet, formulas, document

    def rows(self) -> Cells:
        """Return the rows up to the last one with a value, without cells merged into
        others.
        """
        height, width = (
            min(self.sheet.max_row, MOST_ROWS),
            min(self.sheet.max_column, MOST_COLUMNS),
        )
        spans = {}
        covered = set()
        for area in self.sheet.merged_cells.ranges:
            bottom, right = min(area.max_row, height), min(area.max_col, width)
            spans[area.min_row, area.min_col] = (
                right - area.min_col + 1,
                bottom - area.min_row + 1,
            )
            covered |= {
                (r, c)
                for r in range(area.min_row, bottom + 1)
                for c in range(area.min_col, right + 1)
            }
        covered -= set(spans)
        result: Cells = []
        for row in range(1, height + 1):
            cells = []
            for column in range(1, width + 1):
                if (row, column) in covered:
                    continue
                columns, rows = spans.get((row, column), (1, 1))
                cells.append(SourceCell(self.text(row, column), columns, rows))
            result.append((row, cells))
        return result

    def text(self, row: int, column: int) -> str:
        """Return the value of a cell as text.

        Report values that differ from what was typed.
        """
        cell = self.sheet.cell(row, column)
        value = cell.value
        where = f"sheet `{self.sheet.title}`, cell {cell.coordinate}"
        if isinstance(value, (datetime.date, datetime.time)):
            self.report(row, f"{where}: the spreadsheet program made the date {value} of what was typed",
                        "was it a range such as 1-2? Format the column as text and type it again")  # fmt: skip
            return str(value)
        # openpyxl computes no formulas: it returns the values that were stored last.
        if value is None:
            formula = self.formulas.cell(row, column).value
            if isinstance(formula, str) and formula.startswith("="):
                self.report(
                    row,
                    f"{where}: the formula `{formula[:40]}` has no stored value",
                    "open and save it in a spreadsheet program",
                )
            return ""
        if isinstance(value, bool):
            return "TRUE" if value else "FALSE"
        if isinstance(value, float):
            # Also infinity, which a workbook can have as `1e999`, has no integer.
            return str(int(value)) if value.is_integer() else repr(value)
        if (
            isinstance(value, str)
            and value.startswith("#")
            # `#REF!`, `#NAME?`, `#N/A`
            and value.endswith(("!", "?", "/A"))
        ):
            self.report(
                row,
                f"{where}: its formula gives the error `{value}`",
                "correct the formula",
            )
        return str(value).strip().replace("\r\n", "\n")

    def report(self, row: int, message: str, help: str) -> None:
        self.document.import_findings.append(
            ImportFinding("IMP023", message, SourcePlace(line=row), help, "error")
        )


def _blocks(rows: Cells, sheet: str) -> list[Block]:
    """Tables between rows without text, and the texts above them."""
    blocks: list[Block] = []
    table: list[SourceRow] = []
    open_rows = 0  # that a merged cell above reaches into

    def close() -> None:
        if table:
            rows = list(table)
            while rows and not rows[-1].shown:
                rows.pop()
            blocks.append(SourceTable(sheet=sheet, rows=_without_empty_columns(rows)))
            table.clear()

    for number, cells in rows:
        filled = [cell.text for cell in cells if cell.text]
        # A row below a merged cell can have no text of its own, and does not end the
        # table.
        open_rows = max(open_rows - 1, 0)
        if not filled and not open_rows:
            close()
        elif (
            len(filled) == 1
            and not table
            and not open_rows
            and (cells[0].text or len(cells) > 1)
        ):
            blocks.append(TextBlock(filled[0], line=number))
        else:
            table.append(SourceRow(cells, line=number))
        open_rows = max([open_rows, *(cell.rows for cell in cells if cell.text)])
    close()
    return blocks


def _without_empty_columns(rows: list[SourceRow]) -> list[SourceRow]:
    """Return the rows without empty columns at the right of the table."""
    # With spans, the index of a cell is not its column.
    if any(cell.columns > 1 or cell.rows > 1 for row in rows for cell in row.cells):
        return rows
    width = max(
        (
            index + 1
            for row in rows
            for index, cell in enumerate(row.cells)
            if cell.text
        ),
        default=0,
    )
    return [SourceRow(row.cells[:width], row.page, row.line) for row in rows]
