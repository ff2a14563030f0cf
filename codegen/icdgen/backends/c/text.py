"""Text -> C comments and string literals that nothing can break out of."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from icdgen.backends import lines
from icdgen.backends.lines import commented, tamed
from icdgen.describe.comments import Comment

WIDTH = 120

_MARKUP = re.compile(
    r"""[\\@<&#%*_~[]  # characters that markup contains: without one of them, the alternatives are not tried
        (?: (?<=[\\@])
          | (?<=<)(?=[A-Za-z/!?])
          | (?<=[&#%])(?=[\w#:])
          | (?<=[*_~])(?<![^\s<{(\[,:;].)(?=\S)
          | (?<=\[)(?=[^\]]*\][(\[:])
        )""",
    re.VERBOSE,
)


class _Command(str):
    """A paragraph that begins with a command of documentation tools: only we make one, no text of an ICD does."""


FILE = _Command("@file")


@lru_cache(maxsize=8192)
def plain(text: str) -> str:
    """One line that is safe within a block comment: no comment delimiters, trigraphs or control characters."""
    text = lines.plain(text)
    for unsafe, safe in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?")):
        while unsafe in text:
            text = text.replace(unsafe, safe)
    return text


@lru_cache(maxsize=8192)
def prose(text: str) -> str:
    """`plain` text for a documentation comment: only backticks are markup, nothing is a command or HTML to Doxygen or clang."""
    return _MARKUP.sub(_escaped, plain(text))


def _escaped(found: re.Match[str]) -> str:  # a template in the place of it is read anew for each text
    return f"\\{found[0]}"


def _spelled(paragraph: str) -> str:
    command, space, rest = paragraph.partition(" ") if isinstance(paragraph, _Command) else ("", "", paragraph)
    return command + space + prose(rest)


def comment(paragraphs: Iterable[str], indent: str = "") -> str:
    """A documentation comment: one line where it fits, else a block."""
    paragraphs = [_spelled(p) for p in paragraphs if p]
    if len(paragraphs) == 1 and len(indent) + len(paragraphs[0]) + 7 <= WIDTH:
        return f"{indent}/** {tamed(paragraphs[0])} */"
    return "\n".join([f"{indent}/**", *commented(paragraphs, WIDTH, f"{indent} * "), f"{indent} */"])


def described(one: Comment, indent: str = "") -> str:
    """The comment of a part: what it is in one paragraph, and its errata as notes."""
    return comment([" ".join((one.head, *one.details)), *noted(one)], indent)


def noted(one: Comment) -> list[str]:
    """The errata as notes of the usual documentation tools."""
    return [_Command(f"@note {paragraph.removeprefix('Note ')}") for paragraph in one.errata]


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
