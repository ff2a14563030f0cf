"""Text tables for terminals and pipes. In a pipe nothing is wrapped, cut or coloured, for programs to read."""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, TextIO

GAP = 2  # spaces between columns
NARROWEST = 8  # a column is not wrapped to less


class Column(NamedTuple):
    """``right``: numbers, aligned at their last digit. ``fixed``: never wrapped."""

    title: str
    right: bool = False
    fixed: bool = False


def width_of(stream: TextIO | None) -> int | None:
    """Columns of the terminal that the stream goes to; None if it is not a terminal, or closed."""
    try:
        return os.get_terminal_size(stream.fileno()).columns if stream is not None and stream.isatty() else None
    except (OSError, ValueError):
        return None


def render(columns: Sequence[Column], rows: Iterable[Sequence[str]], width: int | None = None) -> str:
    """The table, each line ended by a newline. With ``width`` cells are wrapped so that it fits, if it can.

    Columns that are empty in every row are left out. Control characters in cells are shown as escapes.
    """
    cells = [[clean(cell) for cell in row] for row in rows]
    used = [index for index in range(len(columns)) if any(row[index] for row in cells)]
    columns = [columns[index] for index in used]
    cells = [[row[index] for index in used] for row in cells]
    if not columns:
        return ""
    widths = [max(_width(c.title), *(_width(row[i]) for row in cells)) for i, c in enumerate(columns)]
    least = [
        size if c.fixed else min(size, max(_width(c.title), NARROWEST)) for c, size in zip(columns, widths, strict=True)
    ]
    if width is not None and _total(least) <= width < _total(widths):
        return _wrapped(columns, cells, least, width)
    lines = [[column.title for column in columns], ["-" * size for size in widths], *cells]
    return "".join(_line(line, columns, widths) for line in lines)


def clean(text: str) -> str:
    """The text with everything that could move the cursor or colour the terminal written as an escape."""
    return text if text.isprintable() else "".join(c if c.isprintable() else _escape(c) for c in text)


def _escape(character: str) -> str:
    code = ord(character)
    return " " if character in "\n\t" else f"\\u{{{code:x}}}"


def _line(cells: Sequence[str], columns: Sequence[Column], widths: Sequence[int]) -> str:
    padded = []
    for cell, column, size in zip(cells, columns, widths, strict=True):
        space = " " * (size - _width(cell))
        padded.append(space + cell if column.right else cell + space)
    return (" " * GAP).join(padded).rstrip() + "\n"


def _width(text: str) -> int:
    if text.isascii():
        return len(text)
    return sum(0 if unicodedata.combining(c) else 1 + (unicodedata.east_asian_width(c) in "WF") for c in text)


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + GAP * (len(widths) - 1)


def _wrapped(columns: Sequence[Column], cells: Sequence[Sequence[str]], least: Sequence[int], width: int) -> str:
    import io

    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, padding=(0, GAP, 0, 0), pad_edge=False, header_style="", show_edge=False)
    for column, size in zip(columns, least, strict=True):
        justify: Literal["right", "left"] = "right" if column.right else "left"
        table.add_column(Text(column.title), justify=justify, no_wrap=column.fixed, overflow="fold", min_width=size)
    for row in cells:
        table.add_row(*(Text(cell) for cell in row))
    file = io.StringIO()
    Console(file=file, width=width, color_system=None, force_terminal=False).print(table)
    return "".join(line.rstrip() + "\n" for line in file.getvalue().splitlines())
