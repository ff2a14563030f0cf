"""Workbook of the rows of a node.

Equal rows result in equal bytes on all machines, so that `--check` can compare them.
"""

from __future__ import annotations

import datetime
import io
import re
import zipfile

from icdgen.backends.tables.rows import HEADINGS, Row
from icdgen.errors import UserError
from icdgen.icd.model import Node

WIDEST = 60  # characters of a column
# The first time that a ZIP archive can represent
_EPOCH = datetime.datetime(1980, 1, 1)


def of_rows(node: Node, rows: list[Row]) -> bytes:
    """Return the workbook.

    Raises `UserError` without openpyxl.
    """
    try:
        from openpyxl import Workbook
        from openpyxl.styles import Font
        from openpyxl.utils import get_column_letter
    except ImportError:
        raise UserError(
            "writing a spreadsheet needs openpyxl", "pip install 'icdgen[import]'"
        ) from None
    book = Workbook()
    book.properties.creator = "icdgen"
    # openpyxl would write the time of this run.
    book.properties.created = _EPOCH
    sheet = book.active
    sheet.title = "Messages"
    sheet.append(
        [f"{node.title} ({node.name}): {node.byte_order}-endian, {node.bit_order}"]
    )
    table: list[Row] = [list(HEADINGS), *rows]
    for row in table:
        sheet.append(row)
    for cells in sheet.iter_rows(min_row=3):
        for cell in cells:
            if isinstance(cell.value, str):
                cell.data_type = "s"  # a text that begins with `=` is no formula
    for cell in sheet[2]:
        cell.font = Font(bold=True)
        texts = [str(row[cell.column - 1]) for row in table]
        sheet.column_dimensions[get_column_letter(cell.column)].width = min(
            max(map(len, texts)) + 2, WIDEST
        )
    # Title and headings remain visible.
    sheet.freeze_panes = "A3"
    sheet.auto_filter.ref = f"A2:{get_column_letter(len(HEADINGS))}{len(rows) + 2}"
    data = io.BytesIO()
    book.save(data)
    return _without_times(data)


def _without_times(data: io.BytesIO) -> bytes:
    """Return the archive with fixed times and without compression, whose result depends
    on the version of zlib.
    """
    output = io.BytesIO()
    with (
        zipfile.ZipFile(data) as archive,
        zipfile.ZipFile(output, "w", zipfile.ZIP_STORED) as fixed,
    ):
        for name in archive.namelist():
            content = archive.read(name)
            if name == "docProps/core.xml":  # openpyxl writes the time of saving
                content = re.sub(
                    rb"(<dcterms:modified[^>]*>)[^<]*",
                    rb"\g<1>1980-01-01T00:00:00Z",
                    content,
                )
            fixed.writestr(zipfile.ZipInfo(name, _EPOCH.timetuple()[:6]), content)
    return output.getvalue()
