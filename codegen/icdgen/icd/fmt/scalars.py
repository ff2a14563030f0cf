"""Spelling of scalars: unquoted if all readers of YAML interpret it as the same text,
else in double quotes.

`flow` and `key` return a `ScalarText` as text, `block` as lines: texts longer than
`WIDTH` are folded, texts with line breaks become block scalars if possible. Numbers
keep their spelling, except for capital letters in hexadecimal digits. Code without a
tree of the formatter calls `quoted_if_needed`.
"""

from __future__ import annotations

import re
from functools import lru_cache

from icdgen.diagnostics import Findings
from icdgen.icd import source
from icdgen.icd.fmt.commented import ScalarText

WIDTH = 120
BLOCK_HEADERS = frozenset({"|", "|-", ">"})

_WORDS = frozenset({"y", "yes", "n", "no", "on", "off", "true", "false", "null"})
# Start of unquoted text: a letter or digit, or a sign without meaning in YAML; a dash
# only before a letter or digit. Text that looks like a prefixed number (`0b0010 0100`)
# is quoted, too.
_START = re.compile(r"(?!0[xXbBoO])[^\W_]|[(/_$+^;]|\.(?!\.)|-[^\W_]")
_NOT_IN_BLOCK = re.compile(r":(?: |\Z)| #")
_NOT_IN_FLOW = re.compile(r"[,\[\]{}:?]| #")
_NUMBER_OR_WORD = re.compile(r"-?[0-9]+(?:\.[0-9]+)?|0x[0-9A-Fa-f]+|true|false|null|~|")
_BREAK = re.compile(r"(?<=[^ ]) (?=[^ ])")
_ESCAPES = {
    '"': '\\"',
    "\\": "\\\\",
    "\n": "\\n",
    "\t": "\\t",
    "\r": "\\r",
    "\0": "\\0",
}
_SPECIAL = re.compile(r'["\\]')


def flow(text: ScalarText) -> str:
    """Return a scalar in flow style, within braces or brackets."""
    return (
        quoted_if_needed(text.value, True)
        if isinstance(text.value, str)
        else _number_or_word(text)
    )


def key(text: ScalarText, in_flow: bool) -> str:
    """Return a scalar as a key."""
    if (
        text.value is None
        and len(text.spelling) < 40
        and _NUMBER_OR_WORD.fullmatch(text.spelling)
    ):
        return _number_or_word(text)
    return quoted_if_needed(name(text), in_flow)


def name(text: ScalarText) -> str:
    """Return the name of a key."""
    return text.spelling if text.value is None else str(text.value)


def block(text: ScalarText, column: int, indent: int) -> list[str]:
    """Return the lines of a scalar in block style that begins at ``column``; all except
    the first are indented.
    """
    if not isinstance(text.value, str):
        return [_number_or_word(text)]
    value = text.value
    if "\n" in value and _fits_literal(value):
        body = value.removesuffix("\n")
        if "\n" not in body and indent + len(body) > WIDTH:
            return [
                ">",
                *(
                    " " * indent + line
                    for line in _fill(body, WIDTH - indent, WIDTH - indent)
                ),
            ]
        lines = [" " * indent + line if line else "" for line in body.split("\n")]
        return ["|" if body != value else "|-", *lines]
    return _fold(quoted_if_needed(value, False), column, indent)


@lru_cache(maxsize=16384)
def quoted_if_needed(value: str, in_flow: bool) -> str:
    """Return a text unquoted if that is unambiguous, else in double quotes."""
    if (
        _START.match(value)
        and value.isprintable()
        and value[-1] != " "
        and not (_NOT_IN_FLOW if in_flow else _NOT_IN_BLOCK).search(value)
        and _reads_as_text(value)
    ):
        return value
    return _quote(value)


def _reads_as_text(value: str) -> bool:
    """Return whether the loader and other readers of YAML interpret the unquoted
    spelling as this text.
    """
    if value[:1].isalpha() and value.isprintable():
        return value.lower() not in _WORDS
    return bool(value) and _loader_reads(value)


@lru_cache(maxsize=4096)
def _loader_reads(value: str) -> bool:
    """Return whether the loader reads the unquoted spelling as this text."""
    try:
        return source.parse(f"key: {value}\n".encode(), "") == {"key": value}
    except (Findings, UnicodeEncodeError):
        return False


def _number_or_word(text: ScalarText) -> str:
    """Return a number, a truth value or null in its canonical spelling: ``0x5A``,
    ``null``.
    """
    spelling = text.spelling
    if spelling.startswith("0x"):
        return "0x" + spelling[2:].upper()
    return "null" if spelling in ("", "~") else spelling


def _quote(value: str) -> str:
    """Return a text in double quotes."""
    if value.isprintable():
        return '"' + _SPECIAL.sub(r"\\\g<0>", value) + '"'
    return '"' + "".join(map(_escape, value)) + '"'


def _escape(character: str) -> str:
    """Return a character of a text in double quotes."""
    if character in _ESCAPES:
        return _ESCAPES[character]
    if character.isprintable():
        return character
    code = ord(character)
    if code < 0x100:
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code < 0x10000 else f"\\U{code:08X}"


def _fits_literal(value: str) -> bool:
    """Return whether a text with line breaks can be written as a literal block scalar
    (``|``).
    """
    lines = value.removesuffix("\n").split("\n")
    if not lines[0] or lines[0][0] == " " or not lines[-1]:
        return False
    return all(line.isprintable() and not line.endswith(" ") for line in lines)


def _fold(text: str, column: int, indent: int) -> list[str]:
    """Return an unquoted or quoted scalar, folded over several lines if it is longer
    than `WIDTH`.
    """
    if column + len(text) <= WIDTH:
        return [text]
    quote = '"' if text[0] == '"' else ""
    lines = _fill(
        text[1:-1] if quote else text, WIDTH - column - len(quote), WIDTH - indent
    )
    lines[0] = quote + lines[0]
    lines[-1] += quote
    return [lines[0], *(" " * indent + line for line in lines[1:])]


def _fill(text: str, first: int, width: int) -> list[str]:
    """Break a text at single spaces, as a reader of YAML replaces a line break by one
    space.

    ``first`` is the width of the first line.
    """
    lines: list[str] = []
    for word in _BREAK.split(text):
        if lines and len(lines[-1]) + 1 + len(word) <= (
            first if len(lines) == 1 else width
        ):
            lines[-1] += " " + word
        else:
            lines.append(word)
    return lines
