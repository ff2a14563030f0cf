"""Text tables for terminals and pipes.

Tables for a pipe are not wrapped, cut or coloured. `render_table` takes columns, rows
of text and the width of the terminal (`width_of`), and returns the table as text.
It wraps cells only if the table does not fit otherwise, and omits empty columns.
`printable_text` replaces control characters in texts of ICDs and devices.
"""

from __future__ import annotations

import io
import os
import unicodedata
from collections.abc import Iterable, Sequence
from typing import Literal, TextIO

from icdgen.frozen import NamedTuple

GAP = 2  # spaces between columns
NARROWEST = 8  # minimum width of a wrapped column


class Column(NamedTuple):
    """A column of a table."""

    title: str
    right: bool = False  # aligned to the right, for numbers
    fixed: bool = False  # never wrapped


def width_of(stream: TextIO | None) -> int | None:
    """Return the width of the terminal of a stream in characters; None if it is not a
    terminal, or closed.
    """
    try:
        return (
            os.get_terminal_size(stream.fileno()).columns
            if stream is not None and stream.isatty()
            else None
        )
    except (OSError, ValueError):
        return None


def render_table(
    columns: Sequence[Column], rows: Iterable[Sequence[str]], width: int | None = None
) -> str:
    """Return a table as text. With ``width``, cells are wrapped to fit, if possible.

    Columns that are empty in all rows are omitted. Control characters in cells are
    shown as escapes.
    """
    cells = [[printable_text(cell) for cell in row] for row in rows]
    used = [index for index in range(len(columns)) if any(row[index] for row in cells)]
    columns = [columns[index] for index in used]
    cells = [[row[index] for index in used] for row in cells]
    if not columns:
        return ""
    widths: list[int] = []
    least: list[int] = []
    for index, column in enumerate(columns):
        size = max(_width(column.title), *(_width(row[index]) for row in cells))
        widths.append(size)
        least.append(
            size if column.fixed else min(size, max(_width(column.title), NARROWEST))
        )
    # If even the minimum widths do not fit, the terminal wraps complete lines, which is
    # more readable.
    if width is not None and _total(least) <= width < _total(widths):
        return _wrapped(columns, cells, least, width)
    lines = [
        [column.title for column in columns],
        ["-" * size for size in widths],
        *cells,
    ]
    return "".join(_line(line, columns, widths) for line in lines)


def printable_text(text: str) -> str:
    """Return a text with escapes for all characters that can move the cursor or change
    colours.
    """
    if text.isprintable():
        return text
    return "".join(
        character if character.isprintable() else _escape(character)
        for character in text
    )


def _escape(character: str) -> str:
    """Return the escape of a character; a space for a line break or a tab."""
    code = ord(character)
    return " " if character in "\n\t" else f"\\u{{{code:x}}}"


def _line(
    cells: Sequence[str], columns: Sequence[Column], widths: Sequence[int]
) -> str:
    """Return a line of the table."""
    padded = []
    for cell, column, size in zip(cells, columns, widths, strict=True):
        space = " " * (size - _width(cell))
        padded.append(space + cell if column.right else cell + space)
    return (" " * GAP).join(padded).rstrip() + "\n"


def _width(text: str) -> int:
    """Return the columns of a text on a terminal: none for combining characters, two
    for wide ones.
    """
    if text.isascii():
        return len(text)
    visible = (character for character in text if not unicodedata.combining(character))
    return sum(
        1 + (unicodedata.east_asian_width(character) in "WF") for character in visible
    )


def _total(widths: Sequence[int]) -> int:
    """Return the width of a line."""
    return sum(widths) + GAP * (len(widths) - 1)


def _wrapped(
    columns: Sequence[Column],
    cells: Sequence[Sequence[str]],
    least: Sequence[int],
    width: int,
) -> str:
    """Return a table with wrapped cells."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(
        box=None,
        padding=(0, GAP, 0, 0),
        pad_edge=False,
        header_style="",
        show_edge=False,
    )
    for column, size in zip(columns, least, strict=True):
        justify: Literal["right", "left"] = "right" if column.right else "left"
        table.add_column(
            Text(column.title),
            justify=justify,
            no_wrap=column.fixed,
            overflow="fold",
            min_width=size,
        )
    for row in cells:
        table.add_row(*(Text(cell) for cell in row))
    file = io.StringIO()
    Console(file=file, width=width, color_system=None, force_terminal=False).print(
        table
    )
    return "".join(line.rstrip() + "\n" for line in file.getvalue().splitlines())
