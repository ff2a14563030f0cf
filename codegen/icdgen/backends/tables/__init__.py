"""Tables for reviews with one row per field: an .xlsx or .csv file per node.

`icdgen import --profile tables` reads them.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.backends.tables import rows
from icdgen.icd.model import Icd


class _TablesBackend:
    """Base class of both table formats.

    Cells can contain any name, so names never conflict.
    """

    reserved: frozenset[str] = frozenset()
    named_in: tuple[str, ...] = ()  # names of the ICD are unchanged
    needs_lines = True  # keys without a column are taken from the file

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers: tables declare none."""
        return iter(())


class CsvBackend(_TablesBackend):
    """Backend of ``icdgen --lang csv``."""

    name = "csv"
    title = "CSV"

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield ``<node>.csv`` for each node with own messages, in order."""
        for node in icd.nodes:
            if table := rows.of_node(node):
                text = io.StringIO()
                csv.writer(text, lineterminator="\n").writerows([rows.HEADINGS, *table])
                yield PurePosixPath(f"{node.name}.csv"), text.getvalue()


class XlsxBackend(_TablesBackend):
    """Backend of ``icdgen --lang xlsx``."""

    name = "xlsx"
    title = "XLSX"

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, bytes]]:
        """Yield ``<node>.xlsx`` for each node with own messages, in order.

        Raises `UserError` without openpyxl.
        """
        from icdgen.backends.tables import workbook

        for node in icd.nodes:
            if table := rows.of_node(node):
                yield PurePosixPath(f"{node.name}.xlsx"), workbook.of_rows(node, table)
