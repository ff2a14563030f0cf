"""The YAML that ICDs are usually written in, read without a library that knows all of YAML, in three fifths of its time.

Block mappings and lists, flow ones, plain words and numbers, and quoted texts without escapes do for nearly every ICD.
A text of these alone is read here, value for value and place for place as `icdgen.icd.source` would; whatever else there
is in one, right or wrong, is left to it.
"""

from __future__ import annotations

import re
from typing import Any, cast

from icdgen.icd.located import Lines, Map, Seq, Spot
from icdgen.icd.scalars import MAX_SCALAR, value_of

_DEEPEST = 30

_KEY = r"([A-Za-z_][A-Za-z0-9_ .()/-]{0,99})(?<! ):"
_FIRST = r"(?:[^\s?:,\[\]{}#&*!|>'\"%@`-]|-(?=[^\s,\[\]{}]))"  # of a plain scalar
_VALUE = rf'(?:"([^"\\\n]*)" *|({_FIRST}[^\n,\[\]{{}}:#?]*))?'
_GAP = re.compile(r"(?: *(?:#[^\n]*)?\n)*( *)")  # the rest of a line, those without content, the next one's indentation
_BLOCK_KEY = re.compile(_KEY + r"(?: +|(?=\n))")
_ROW = re.compile(r"\{([^{}\[\]\"\n#?]+)\}")
_ROW_PAIR = re.compile(rf" *{_KEY} +({_FIRST}[^:]*)")
_FLOW_PAIR = re.compile(rf" *(?:\n +)?{_KEY} +{_VALUE}([,}}\[{{])")
_FLOW_ITEM = re.compile(rf" *(?:\n +)?(){_VALUE}([,\]\[{{])")
_DASH = re.compile(r"- +")
_QUOTED = re.compile(r'"([^"\\]*)"')
_PLAIN = re.compile(rf"{_FIRST}[^\n]*")


class _Unusual(Exception):
    """The text has something in it that is left to `icdgen.icd.source`."""


def tree(text: str, name: str) -> Map | None:
    """The tree of a text as it is usually written; None for any other."""
    if not text.replace("\n", "").isprintable():
        return None
    try:
        return _Reader(Lines(name, text if text.endswith("\n") else f"{text}\n")).document()
    except (_Unusual, ValueError):
        return None


class _Row(Map):
    """A mapping in braces. Where its keys and values stood is worked out once it is asked for: of few rows it is."""

    __slots__ = ()

    def __init__(self, spot: Spot) -> None:
        self.spot = spot

    def __getattr__(self, name: str) -> Any:
        if name != "spots":
            raise AttributeError(name)
        lines, at, _ = cast(tuple[Lines, int, int], self.spot)
        again, _ = _Reader(lines).flow(at)
        assert isinstance(again, Map)
        self.spots = again.spots
        return self.spots


class _Reader:
    """``at`` and ``column`` are where the next content begins; at the end of the text, the column is -1."""

    def __init__(self, lines: Lines) -> None:
        self.text, self.lines = lines.text, lines
        self.known: dict[str, Any] = {}  # values of plain scalars
        self.keys: dict[str, str] = {}  # those of them that were keys
        self.pairs_known: dict[str, tuple[str, Any]] = {}  # key and value of what stood between two commas
        self.at = self.column = self.depth = 0

    def document(self) -> Map:
        self.go_on(0)
        made = self.block(0) if self.column == 0 else None
        if type(made) is not Map or self.column != -1:
            raise _Unusual
        return made

    def go_on(self, at: int) -> None:
        """Goes on to the next content; nothing but a comment follows in the line of ``at``."""
        found = _GAP.match(self.text, at)
        assert found
        begin, self.at = found.span(1)
        if at and (self.text[begin - 1] != "\n" or (self.text[at] == "#" and self.text[at - 1] != " ")):
            raise _Unusual
        self.column = self.at - begin if self.at < len(self.text) else -1

    def plain(self, text: str) -> Any:
        """The value of a plain scalar that was not seen before."""
        if len(text) > MAX_SCALAR:
            raise _Unusual
        value = self.known[text] = value_of(text)
        return value

    def key(self, text: str) -> str:
        """A key that was not seen before; it is a word for all readers."""
        if type(self.plain(text)) is not str:
            raise _Unusual
        self.keys[text] = text
        return text

    def block(self, column: int) -> Map | Seq:
        """The mapping or list that begins here."""
        self.depth += 1
        if self.depth > _DEEPEST:
            raise _Unusual
        made = self.items(column) if self.text.startswith("- ", self.at) else self.pairs(column)
        self.depth -= 1
        if self.column > column:
            raise _Unusual
        return made

    def pairs(self, column: int) -> Map:
        made = Map((self.lines, self.at, self.at))
        while self.column == column:
            begin = self.at
            found = _BLOCK_KEY.match(self.text, begin)
            if found is None or found[1] in made:
                raise _Unusual
            key = self.keys.get(found[1]) or self.key(found[1])
            end = begin + len(key)
            made[key], spot = self.value(found.end(), end + 1, column)
            made.spots[key] = (self.lines, begin, end), spot
        return made

    def value(self, at: int, empty: int, column: int) -> tuple[Any, Spot]:
        """The value of a key, and where it stands: at ``at`` or below; if there is none, at ``empty``."""
        if self.text[at] not in "\n#":
            return self.inline(at, column)
        self.go_on(at)
        if self.column > column or (self.column == column and self.text.startswith("- ", self.at)):
            return self.nested(column)
        return None, (self.lines, empty, empty)

    def nested(self, column: int) -> tuple[Any, Spot]:
        """What begins at the beginning of a line or after a dash, inside of what is at ``column``."""
        if self.text[self.at] != "{" and (self.text.startswith("- ", self.at) or _BLOCK_KEY.match(self.text, self.at)):
            made = self.block(self.column)
            return made, made.spot
        return self.inline(self.at, column)

    def items(self, column: int) -> Seq:
        text = self.text
        made = Seq((self.lines, self.at, self.at))
        while self.column == column and (found := _DASH.match(text, self.at)):
            begin, self.at = found.span()
            self.column += self.at - begin
            value, spot = self.nested(column)
            made.append(value)
            made.spots.append(spot)
        return made

    def inline(self, at: int, column: int) -> tuple[Any, Spot]:
        """A value that is neither a mapping nor a list in block style."""
        first = self.text[at]
        if first in "{[":
            row = _ROW.match(self.text, at)
            made, end = self.flow(at) if row is None else (self.row(row), row.end())
            self.go_on(end)
            return made, made.spot
        if first == '"':
            found = _QUOTED.match(self.text, at)
            if found is None or len(found[1]) > MAX_SCALAR:
                raise _Unusual
            self.go_on(found.end())
            return _folded(found[1], column), (self.lines, *found.span())
        return self.words(at, column)

    def words(self, begin: int, column: int) -> tuple[Any, Spot]:
        """A plain scalar: on one line, or on several that begin further right than ``column``."""
        text, parts, at = self.text, [], begin
        while True:
            found = _PLAIN.match(text, at)
            if found is None:
                raise _Unusual
            words, comment, _ = found[0].partition(" #")
            parts.append(words.rstrip(" "))
            if ": " in words or words.endswith(":"):
                raise _Unusual
            end = at + len(parts[-1])
            self.go_on(end)
            if self.column <= column:
                break
            if comment or text.count("\n", end, self.at) > 1:
                raise _Unusual
            at = self.at
        whole = " ".join(parts)
        value = self.known.get(whole, self)
        return self.plain(whole) if value is self else value, (self.lines, begin, end)

    def row(self, row: re.Match[str]) -> _Row:
        """A mapping in braces of plain scalars."""
        made = _Row((self.lines, row.start(), row.start()))
        texts, known = row[1].split(","), self.pairs_known
        for text in texts:  # by the ten thousand
            key, value = known.get(text) or self.row_pair(text)
            made[key] = value
        if len(made) < len(texts):
            raise _Unusual
        return made

    def row_pair(self, text: str) -> tuple[str, Any]:
        """A pair that was not seen before."""
        found = _ROW_PAIR.fullmatch(text)
        if found is None:
            raise _Unusual
        made = self.pairs_known[text] = self.keys.get(found[1]) or self.key(found[1]), self.plain(found[2].rstrip(" "))
        return made

    def flow(self, at: int) -> tuple[Map | Seq, int]:
        """The mapping or list in braces or brackets that begins at ``at``, and where it has ended."""
        self.depth += 1
        if self.depth > _DEEPEST:
            raise _Unusual
        text, lines, known, keys = self.text, self.lines, self.known, self.keys
        made: Any = Map((lines, at, at)) if text[at] == "{" else Seq((lines, at, at))
        match, close = (_FLOW_PAIR.match, "}") if type(made) is Map else (_FLOW_ITEM.match, "]")
        spots = made.spots
        at += 1
        then = text[at]
        at += then == close
        while then != close:  # once a value of a row, by the ten thousand
            found = match(text, at)
            if found is None:
                raise _Unusual
            name, quoted, plain, then = found.groups()
            (_, at), (of_name, end_of_name), (of_quoted, end_of_quoted), (of_plain, _), _ = found.regs
            spot: Spot
            if plain is not None:
                if plain[-1] == " ":
                    plain = plain.rstrip(" ")
                value = known.get(plain, known)  # which stands for what was not seen before
                if value is known:
                    value = self.plain(plain)
                spot = lines, of_plain, of_plain + len(plain)
            elif quoted is not None and len(quoted) <= MAX_SCALAR:
                value, spot = quoted, (lines, of_quoted - 1, end_of_quoted + 1)
            else:
                value, at = self.flow_inside(at - 1)
                spot, then, at = value.spot, text[at], at + 1
            if name:
                key = keys.get(name) or self.key(name)
                if key in made:
                    raise _Unusual
                made[key] = value
                spots[key] = (lines, of_name, end_of_name), spot
            else:
                made.append(value)
                spots.append(spot)
            if then != "," and then != close:
                raise _Unusual
        self.depth -= 1
        return made, at

    def flow_inside(self, at: int) -> tuple[Map | Seq, int]:
        """What begins at ``at``, which ought to be a bracket or brace, and where the next comma, bracket or brace stands."""
        if self.text[at] not in "{[":
            raise _Unusual
        made, at = self.flow(at)
        while self.text[at] == " ":
            at += 1
        return made, at


def _folded(text: str, column: int) -> str:
    """A quoted text, its lines joined. All but the first begin further right than ``column``."""
    if "\n" not in text:
        return text
    first, *rest = text.split("\n")
    if any(len(line) - len(line.lstrip(" ")) <= column or not line.strip(" ") for line in rest):
        raise _Unusual
    return " ".join([first.rstrip(" "), *(line.strip(" ") for line in rest[:-1]), rest[-1].lstrip(" ")])
