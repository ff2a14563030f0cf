"""A paper of the pack: a table with what it says, as a page to print and as CSV (RFC 4180). Files are named in it by where they
lie below the folder that holds them all, and not on somebody's machine."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from icdgen.diagnostics import Place

Cell = str | Sequence[str]
"""A text, or several, each in a line of its own."""


@dataclass(frozen=True, slots=True)
class Group:
    """Rows under a heading; without a title they stand alone."""

    rows: list[Sequence[Cell]]
    title: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Page:
    """``file`` is its name, ``facts`` what it is about in short, ``says`` what it shows and does not prove, in paragraphs."""

    file: str
    title: str
    says: tuple[str, ...]
    columns: tuple[str, ...]
    groups: list[Group]
    facts: tuple[tuple[str, str], ...] = ()
    data: tuple[str, ...] = ()  # names of the CSV files of the same


def lines_of(cell: Cell) -> list[str]:
    """The lines of a cell."""
    return [cell] if isinstance(cell, str) else list(cell)


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """A table with a header; several texts in a cell are parted by semicolons."""
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(columns)
    writer.writerows(["; ".join(lines_of(cell)) for cell in row] for row in rows)
    return file.getvalue()


class Files:
    """The files that the ICDs were read from."""

    def __init__(self, files: Iterable[str]) -> None:
        folders = {os.path.dirname(os.path.abspath(file)) for file in files}
        self._top = os.path.commonpath(folders) if folders else ""

    def name(self, file: str) -> str:
        return os.path.relpath(os.path.abspath(file), self._top).replace(os.sep, "/") if file else ""

    def line(self, place: Place) -> str:
        """``errata/demo.yaml:12``; nothing of what was not read from a file."""
        return f"{self.name(place.file)}:{place.line}" if place.file else ""
