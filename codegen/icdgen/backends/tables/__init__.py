"""Tables for reviews, a row per field: an .xlsx or .csv file per node. `icdgen import --profile tables` reads them back."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.backends.tables import rows
from icdgen.icd.model import Icd


class _Tables:
    """What both formats share: every name may stand in a cell, so that no name clashes."""

    reserved: frozenset[str] = frozenset()
    named_in: tuple[str, ...] = ()  # names stand as the ICD has them
    needs_lines = True  # keys without a column are taken from the file

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None: the tables declare no identifiers."""
        return iter(())


class CsvBackend(_Tables):
    """``icdgen --lang csv``"""

    name = "csv"

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, str]]:
        """``<node>.csv`` for each node with messages of its own, in their order."""
        for node in icd.nodes:
            if table := rows.of_node(node):
                text = io.StringIO()
                csv.writer(text, lineterminator="\n").writerows([rows.HEADINGS, *table])
                yield PurePosixPath(f"{node.name}.csv"), text.getvalue()


class XlsxBackend(_Tables):
    """``icdgen --lang xlsx``"""

    name = "xlsx"

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, bytes]]:
        """``<node>.xlsx`` for each node with messages of its own, in their order. Raises `UserError` without openpyxl."""
        from icdgen.backends.tables import workbook

        for node in icd.nodes:
            if table := rows.of_node(node):
                yield PurePosixPath(f"{node.name}.xlsx"), workbook.of_rows(node, table)
