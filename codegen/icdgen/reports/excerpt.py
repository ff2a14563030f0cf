"""The line that a finding is about, made fit for a terminal, and the caret under it."""

from __future__ import annotations

import re
import unicodedata

from icdgen.diagnostics import Place

WIDTH = 100  # columns of a line that are shown
LEAD = 30  # columns kept before the caret where the line is cut
TAB = "    "
CUT = "..."
LONGEST = 1000  # characters of a message; a hostile name may have thousands

_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")  # what YAML counts as the end of a line
_ODD = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")


class Lines:
    """The lines of a text, split when first asked for."""

    def __init__(self, text: str) -> None:
        self._text = text.removeprefix("\ufeff")
        self._lines: list[str] | None = None

    def __getitem__(self, number: int) -> str | None:
        """Line ``number``, counted from 1; None if there is none."""
        if self._lines is None:
            self._lines = _BREAK.split(self._text)
        return self._lines[number - 1] if 1 <= number <= len(self._lines) else None


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


def excerpt(lines: Lines, place: Place) -> tuple[str, str] | None:
    """The line and the caret below it, or None where the text has no such line. Long lines are cut to a window."""
    line = lines[place.line]
    if line is None:
        return None
    start = min(place.column - 1, len(line))
    # Only what can end up in the window is looked at: a line may have a million columns.
    head, tail = line[max(0, start - WIDTH) : start], line[start : start + WIDTH]
    marked = tail[: max(1, min(place.length, len(tail)))]
    before, under, after = (_spread(t) for t in (head, marked, tail[len(marked) :]))
    hidden_before, hidden_after = start > WIDTH, start + WIDTH < len(line)
    if not hidden_before and not hidden_after and _columns(before + under + after) <= WIDTH:
        return before + under + after, _caret(before, under)
    if hidden_before or _columns(before) > LEAD:
        before = CUT + _last(before, LEAD)
    room = WIDTH - _columns(before)
    shown = _first(under + after, room)
    if hidden_after or len(shown) < len(under + after):
        shown = _first(shown, room - len(CUT)) + CUT
    return before + shown, _caret(before, _first(under, room - len(CUT)))


def _spread(text: str) -> str:
    return printable(text.replace("\t", TAB))


def _caret(before: str, under: str) -> str:
    return " " * _columns(before) + "^" * max(1, _columns(under))


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
