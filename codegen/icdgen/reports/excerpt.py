"""Excerpt of a source line for a finding, with marks below it.

It is safe to print on a terminal.
"""

from __future__ import annotations

import unicodedata

from icdgen.diagnostics import Fix, Lines, Place

WIDTH = 100  # columns of a line that are shown
LEAD = 30  # columns that are shown before the marks if the line is cut
TAB = "    "
CUT = "..."
LONGEST = 1000  # characters of a message; a hostile name may have thousands

# Unicode categories of control, format, private and unassigned characters, and of line
# separators.
_UNPRINTABLE = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")


def printable(text: str) -> str:
    """Return a text with escapes such as ``\\x1b`` and ``\\u202e`` for characters that
    a terminal can interpret.
    """
    return text if text.isascii() and text.isprintable() else "".join(map(_shown, text))


def shown(text: str) -> str:
    """Return a message, cut to `LONGEST` characters, as `printable` text."""
    return printable(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


def _shown(char: str) -> str:
    """Return a character, or its escape if it is not printable."""
    if unicodedata.category(char) not in _UNPRINTABLE:
        return char
    code = ord(char)
    if code < 0x100:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _columns(text: str) -> int:
    """Return the number of columns of a text on a terminal."""
    if text.isascii():
        return len(text)
    return sum(_width(char) for char in text)


def _width(char: str) -> int:
    """Return the number of columns of a character on a terminal."""
    if unicodedata.combining(char):
        return 0
    return 2 if unicodedata.east_asian_width(char) in "WF" else 1


def excerpt(lines: Lines, place: Place, mark: str = "^") -> tuple[str, str] | None:
    """Return a line and the marks below it; None if the text has no such line.

    Long lines are cut around the marks.
    """
    line = lines[place.line]
    return None if line is None else marked(line, place.column, place.length, mark)


def corrected(lines: Lines, fix: Fix) -> tuple[str, str] | None:
    """Return the corrected line, and marks below the new text; None if the text has no
    such line.
    """
    line, start = lines[fix.place.line], fix.place.column - 1
    if line is None:
        return None
    line = line[:start] + fix.text + line[start + fix.place.length :]
    return marked(line, fix.place.column, len(fix.text), "~")


def marked(line: str, column: int, length: int, mark: str) -> tuple[str, str]:
    """Return a line and marks below ``length`` characters from ``column`` on, both cut
    to `WIDTH` columns.
    """
    start = min(column - 1, len(line))
    # Look only at the part that can be visible: a line can have a million columns.
    head, tail = line[max(0, start - WIDTH) : start], line[start : start + WIDTH]
    stretch = tail[: max(1, min(length, len(tail)))]
    before, under, after = map(_spread, (head, stretch, tail[len(stretch) :]))
    hidden_before, hidden_after = start > WIDTH, start + WIDTH < len(line)
    # Short lines are shown completely. Of a long line, the marked text and a little
    # before it are shown.
    if (
        not hidden_before
        and not hidden_after
        and _columns(before + under + after) <= WIDTH
    ):
        return before + under + after, _marks(before, under, mark)
    if hidden_before or _columns(before) > LEAD:
        before = CUT + _last(before, LEAD)
    room = WIDTH - _columns(before)
    shown = _first(under + after, room)
    if hidden_after or len(shown) < len(under + after):
        shown = _first(shown, room - len(CUT)) + CUT
    return before + shown, _marks(before, _first(under, room - len(CUT)), mark)


def _spread(text: str) -> str:
    """Return printable text with tabs replaced by spaces."""
    return printable(text.replace("\t", TAB))


def _marks(before: str, under: str, mark: str) -> str:
    """Return the line of marks: spaces below ``before``, and at least one mark below
    ``under``.
    """
    return " " * _columns(before) + mark * max(1, _columns(under))


def _first(text: str, columns: int) -> str:
    """Return the longest start of a text that fits in a number of columns."""
    if text.isascii():
        return text[: max(0, columns)]
    for index, char in enumerate(text):
        columns -= _width(char)
        if columns < 0:
            return text[:index]
    return text


def _last(text: str, columns: int) -> str:
    """Return the longest end of a text that fits in a number of columns."""
    if text.isascii():
        return text[-columns:]
    return _first(text[::-1], columns)[::-1]
