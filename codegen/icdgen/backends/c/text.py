"""Text -> C comments and string literals that nothing can break out of."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from icdgen.backends.lines import bulleted
from icdgen.describe.comments import Comment

WIDTH = 120

_MARKUP = re.compile(r"[\\@`]|<(?=[A-Za-z/!?])|[&#%](?=[\w#:])|(?:(?<![^\s<{(\[,:;]))[*_~](?=\S)|\[(?=[^\]]*\][(\[:])")
_BLOCK = re.compile(r"(\d*)([-+*=#]+\Z|[.)]\Z|>)")  # begins a list, a heading or a quotation where it begins a line


@lru_cache(maxsize=8192)
def plain(text: str) -> str:
    """One line for a documentation comment, where it reads as it is: no comment delimiters, trigraphs or control characters,
    and nothing that Doxygen or clang take for a command, for HTML or for emphasis."""
    text = " ".join(text.split())
    if not (text.isascii() and text.isprintable()):
        text = "".join(c if c.isprintable() else f"U+{ord(c):04X}" for c in text)
    for unsafe, safe in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?")):
        while unsafe in text:
            text = text.replace(unsafe, safe)
    return text if text.replace(" ", "").isalnum() else _MARKUP.sub(r"\\\g<0>", text)


def comment(paragraphs: Iterable[str], indent: str = "") -> str:
<<<<<<< HEAD
    """A documentation comment of `plain` paragraphs: one line where it fits, else a block."""
    paragraphs = [_tamed(word) + rest for word, rest in map(_first_word, filter(None, paragraphs))]
=======
    """A documentation comment: one line where it fits, else a block."""
    paragraphs = [plain(p) for p in paragraphs if p]
>>>>>>> main
    if len(paragraphs) == 1 and len(indent) + len(paragraphs[0]) + 7 <= WIDTH:
        return f"{indent}/** {paragraphs[0]} */"
    lines = bulleted(paragraphs, WIDTH, f"{indent} * ", "")
    return "\n".join([f"{indent}/**", *filter(None, lines), f"{indent} */"])


<<<<<<< HEAD
def _lines(paragraph: str, width: int) -> list[str]:
    if len(paragraph) <= width:
        return [paragraph]
    hang = "  " if paragraph.startswith("@") else ""
    lines, line = [], ""
    for word in paragraph.split(" "):
        if line.strip() and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = hang + _tamed(word)
        else:
            line = f"{line} {word}" if line else word
    return [*lines, line]
=======
def described(one: Comment, indent: str = "") -> str:
    """The comment of a part: what it is in one paragraph, and its errata as notes."""
    return comment([" ".join((one.head, *one.rest)), *noted(one)], indent)


def noted(one: Comment) -> list[str]:
    """The errata as notes of the usual documentation tools."""
    return [f"@note {paragraph}" for paragraph in one.errata]
>>>>>>> main


def _first_word(paragraph: str) -> tuple[str, str]:
    word, space, rest = paragraph.partition(" ")
    return word, space + rest


def _tamed(word: str) -> str:
    """A word as it may begin a line: no list, heading or quotation."""
    return _BLOCK.sub(r"\1\\\2", word, 1) if _BLOCK.match(word) else word


@lru_cache(maxsize=4096)
def literal(text: str) -> str:
    """A string literal of the UTF-8 bytes of ``text``; itself pure ASCII."""
    text = text.replace("\\", "\\\\").replace('"', '\\"')
    while "??" in text:
        text = text.replace("??", "?\\?")
    if not (text.isascii() and text.isprintable()):
        text = "".join(c if " " <= c <= "~" else _octal(c) for c in text)
    return f'"{text}"'


def _octal(char: str) -> str:
    return "".join(f"\\{byte:03o}" for byte in char.encode("utf-8", "replace"))
