"""A paper of the pack: a table with what it says, as a page to print and as CSV (RFC 4180)."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

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
    data: tuple[str, ...] = field(default=())  # names of the CSV files of the same


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


def ranges(numbers: Iterable[int]) -> str:
    """Rising numbers in short: ``31-38 40``."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return " ".join(f"{first}-{last}" if last > first else str(first) for first, last in runs)
