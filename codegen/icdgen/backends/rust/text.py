"""Text and numbers -> Rust source: documentation comments, literals, and lines laid out as rustfmt would."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

WIDTH = 100  # rustfmt's max_width
CALL_WIDTH = 60  # rustfmt's fn_call_width: wider arguments stand one a line
LITERAL_WIDTH = 18  # rustfmt's struct_lit_width: what is narrower stands on one line

_MARKDOWN = re.compile(r"[\\`*\[\]<|~$]|(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])|&(?=[#A-Za-z])|(?<=http):|(?<=https):")
_NUMBERED = re.compile(r"\d+[.)]\Z")


def _character(char: str) -> str:
    return char if char.isprintable() else f"U+{ord(char):04X}"


@lru_cache(maxsize=8192)
def plain(text: str) -> str:
    """One line without control, invisible or direction-changing characters."""
    text = " ".join(text.split())
    return text if text.isascii() and text.isprintable() else "".join(map(_character, text))


@lru_cache(maxsize=8192)
def prose(text: str) -> str:
    """``plain`` text that rustdoc shows as it is: no markup, links or HTML."""
    text = plain(text)
    return text if text.replace(" ", "").isalnum() else _MARKDOWN.sub(r"\\\g<0>", text)


def code(text: str) -> str:
    """``plain`` text as a code span, or as prose where it holds a backtick."""
    text = plain(text)
    return prose(text) if "`" in text else f"`{text}`"


def sentence(text: str) -> str:
    """The text with a full stop."""
    return text if text.endswith((".", "!", "?", ":")) else text + "."


def doc(paragraphs: Iterable[str], indent: str = "", mark: str = "///") -> str:
    """A documentation comment of ready paragraphs, wrapped; every line begins with ``indent``."""
    start = f"{indent}{mark} "
    lines: list[str] = []
    for paragraph in paragraphs:
        if not paragraph:
            continue
        if lines:
            lines.append(indent + mark)
        if len(start) + len(paragraph) <= WIDTH and paragraph[0].isalpha():
            lines.append(start + paragraph)
        else:
            lines += [start + line for line in _wrapped(paragraph, WIDTH - len(start))]
    return "\n".join(lines)


def _wrapped(paragraph: str, width: int) -> list[str]:
    lines, line = [], ""
    for word in paragraph.split(" "):
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = ""
        if not line:
            line = _tamed(word)
        else:
            line += " " + word
    lines.append(line)
    return lines


def _tamed(word: str) -> str:
    """A word that begins no list, heading or quotation at the start of a line."""
    if word[0] == ">" or not word.strip("-+=#"):
        return "\\" + word
    return f"{word[:-1]}\\{word[-1]}" if _NUMBERED.match(word) else word


_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


@lru_cache(maxsize=8192)
def string(text: str) -> str:
    """A string literal in ASCII."""
    if text.isascii() and text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    return '"' + "".join(_ESCAPES.get(c) or (c if " " <= c <= "~" else f"\\u{{{ord(c):x}}}") for c in text) + '"'


@lru_cache(maxsize=4096)
def integer(value: int) -> str:
    """``-32_768``"""
    return f"{value:_}"


@lru_cache(maxsize=4096)
def mask(value: int, bits: int = 8) -> str:
    """``0x0f``; ``0x0fff``; ``0x000f_ffff``: a digit for each four of ``bits``."""
    digits = f"{value:0{bits // 4}x}"
    return "0x" + "_".join(digits[max(0, end - 4) : end] for end in _ends(len(digits)))


def _ends(length: int) -> range:
    return range(length % 4 or 4, length + 1, 4)


def whole_double(value: int) -> str:
    """A whole number as a literal of a double: ``32_768.0``."""
    return f"{value:_}.0"


@lru_cache(maxsize=4096)
def double(value: float) -> str:
    """The shortest literal of a double, digits grouped: ``0.488_281_25``; ``1.0e-9``."""
    digits, _, exponent = repr(value).partition("e")
    whole, _, fraction = digits.partition(".")
    sign, whole = ("-", whole[1:]) if whole.startswith("-") else ("", whole)
    fraction = fraction or "0"
    if len(fraction) > 3:
        fraction = "_".join(fraction[i : i + 3] for i in range(0, len(fraction), 3))
    text = f"{sign}{int(whole):_}.{fraction}"
    return f"{text}e{int(exponent)}" if exponent else text


def decimal(value: float) -> str:
    """A number for people: ``-327.68``; no more digits than the double has."""
    return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def rhs(indent: str, left: str, right: str, end: str) -> str:
    """``left right end`` on one line where it fits, else the right side on a line of its own."""
    line = f"{indent}{left} {right}{end}"
    return line if len(line) <= WIDTH or "\n" in right else f"{indent}{left}\n{indent}    {right}{end}"


def arm(indent: str, pattern: str, body: str) -> str:
    """An arm of a match."""
    line = f"{indent}{pattern} => {body},"
    return line if len(line) <= WIDTH else f"{indent}{pattern} => {{\n{indent}    {body}\n{indent}}}"


def signature(start: str, parameters: tuple[str, ...], returns: str, indent: str = "    ") -> str:
    """A function's head, up to its opening brace."""
    line = f"{indent}{start}({', '.join(parameters)}) -> {returns} {{"
    if len(line) <= WIDTH:
        return line
    inner = "".join(f"{indent}    {parameter},\n" for parameter in parameters)
    return f"{indent}{start}(\n{inner}{indent}) -> {returns} {{"


def implementation(trait: str, type_: str) -> str:
    """``impl trait for type {``"""
    line = f"impl {trait} for {type_} {{"
    return line if len(line) <= WIDTH else f"impl {trait}\n    for {type_}\n{{"
