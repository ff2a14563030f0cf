"""Reports of the verification package: tables as printable pages and as CSV (RFC 4180).

Files are named relative to their common folder, so that reports do not depend on a
machine.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from icdgen.diagnostics import Place

Cell = str | Sequence[str]
"""A text, or several texts with one line each."""


@dataclass(frozen=True, slots=True)
class RowGroup:
    """Rows under a heading; without a title, rows only."""

    rows: list[Sequence[Cell]]
    title: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ReportPage:
    """Page of a report.

    ``file``: its name. ``facts``: summary. ``says``: paragraphs on what it shows and
    what it does not prove.
    """

    file: str
    title: str
    says: tuple[str, ...]
    columns: tuple[str, ...]
    groups: list[RowGroup]
    facts: tuple[tuple[str, str], ...] = ()
    data: tuple[str, ...] = ()  # names of the CSV files with this content


def lines_of(cell: Cell) -> list[str]:
    """Return the lines of a cell."""
    return [cell] if isinstance(cell, str) else list(cell)


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """Return a table with header as CSV; several texts in a cell are separated by
    semicolons.
    """
    file = io.StringIO()
    # The default dialect writes CRLF, as RFC 4180 requires.
    writer = csv.writer(file)
    writer.writerow(columns)
    writer.writerows(["; ".join(lines_of(cell)) for cell in row] for row in rows)
    return file.getvalue()


class Files:
    """Files of the ICDs, named relative to their common folder."""

    def __init__(self, files: Iterable[str]) -> None:
        folders = {os.path.dirname(os.path.abspath(file)) for file in files}
        self._top = os.path.commonpath(folders) if folders else ""

    def relative_name(self, file: str) -> str:
        return (
            os.path.relpath(os.path.abspath(file), self._top).replace(os.sep, "/")
            if file
            else ""
        )

    def line(self, place: Place) -> str:
        """Return the place as ``errata/demo.yaml:12``; empty without a file."""
        return f"{self.relative_name(place.file)}:{place.line}" if place.file else ""
