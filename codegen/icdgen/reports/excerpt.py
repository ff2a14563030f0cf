"""The line that a finding is about, made fit for a terminal, and the marks under it."""

from __future__ import annotations

import unicodedata

from icdgen.diagnostics import Fix, Lines, Place

WIDTH = 100  # columns of a line that are shown
LEAD = 30  # columns kept before the marks where the line is cut
TAB = "    "
CUT = "..."
LONGEST = 1000  # characters of a message; a hostile name may have thousands

_ODD = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")


def printable(text: str) -> str:
    """The text with every character that a terminal could act upon written out: ``\\x1b``, ``\\u202e``."""
    return text if text.isascii() and text.isprintable() else "".join(map(_shown, text))


def shown(text: str) -> str:
    """A message, `printable` and cut to `LONGEST`."""
    return printable(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


def _shown(char: str) -> str:
    if unicodedata.category(char) not in _ODD:
        return char
    code = ord(char)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _columns(text: str) -> int:
    """Columns that the text takes on a terminal."""
    if text.isascii():
        return len(text)
    return sum(_width(char) for char in text)


def _width(char: str) -> int:
    if unicodedata.combining(char):
        return 0
    return 2 if unicodedata.east_asian_width(char) in "WF" else 1


def excerpt(lines: Lines, place: Place, mark: str = "^") -> tuple[str, str] | None:
    """The line and the marks below it, or None where the text has no such line. Long lines are cut to a window."""
    line = lines[place.line]
    return None if line is None else marked(line, place.column, place.length, mark)


def corrected(lines: Lines, fix: Fix) -> tuple[str, str] | None:
    """The line with the correction, and marks below what is new."""
    line, start = lines[fix.place.line], fix.place.column - 1
    if line is None:
        return None
    line = line[:start] + fix.text + line[start + fix.place.length :]
    return marked(line, fix.place.column, len(fix.text), "~")


def marked(line: str, column: int, length: int, mark: str) -> tuple[str, str]:
    """A line and marks below ``length`` of its characters from ``column`` on."""
    start = min(column - 1, len(line))
    # Only what can end up in the window is looked at: a line may have a million columns.
    head, tail = line[max(0, start - WIDTH) : start], line[start : start + WIDTH]
    stretch = tail[: max(1, min(length, len(tail)))]
    before, under, after = (_spread(t) for t in (head, stretch, tail[len(stretch) :]))
    hidden_before, hidden_after = start > WIDTH, start + WIDTH < len(line)
    if not hidden_before and not hidden_after and _columns(before + under + after) <= WIDTH:
        return before + under + after, _marks(before, under, mark)
    if hidden_before or _columns(before) > LEAD:
        before = CUT + _last(before, LEAD)
    room = WIDTH - _columns(before)
    shown = _first(under + after, room)
    if hidden_after or len(shown) < len(under + after):
        shown = _first(shown, room - len(CUT)) + CUT
    return before + shown, _marks(before, _first(under, room - len(CUT)), mark)


def _spread(text: str) -> str:
    return printable(text.replace("\t", TAB))


def _marks(before: str, under: str, mark: str) -> str:
    return " " * _columns(before) + mark * max(1, _columns(under))


def _first(text: str, columns: int) -> str:
    """As much of the beginning as fits."""
    if text.isascii():
        return text[: max(0, columns)]
    for index, char in enumerate(text):
        columns -= _width(char)
        if columns < 0:
            return text[:index]
    return text


def _last(text: str, columns: int) -> str:
    """As much of the end as fits."""
    if text.isascii():
        return text[-columns:]
    return _first(text[::-1], columns)[::-1]
