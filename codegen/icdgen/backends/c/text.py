"""Comments and string literals of C that no text can end early.

Text of an ICD can contain comment delimiters, trigraphs, quotes and commands of
Doxygen. `plain`, `prose` and `literal` make it safe.
"""

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
    """Paragraph that starts with a command of documentation tools.

    Text of the ICD never becomes one.
    """


FILE = _Command("@file")


@lru_cache(maxsize=8192)
def plain(text: str) -> str:
    """Return one line that is safe in a block comment: without comment delimiters,
    trigraphs and control characters.
    """
    text = lines.plain(text)
    # Trigraphs (C99 5.2.1.1) are replaced before comments are recognized: `??/` at the
    # end of a line is a backslash, which continues the line.
    for unsafe, safe in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?")):
        # A replacement can leave the sequence again, such as in `???`, so it is
        # repeated until nothing is left.
        while unsafe in text:
            text = text.replace(unsafe, safe)
    return text


@lru_cache(maxsize=8192)
def prose(text: str) -> str:
    """Return `plain` text for a documentation comment.

    Only backticks are markup; commands and HTML of Doxygen are escaped.
    """
    return _MARKUP.sub(_escaped, plain(text))


def _escaped(match: re.Match[str]) -> str:
    # A function is faster than a replacement template, which `re` parses for each text.
    return f"\\{match[0]}"


def _escaped_paragraph(paragraph: str) -> str:
    command, space, text = (
        paragraph.partition(" ")
        if isinstance(paragraph, _Command)
        else ("", "", paragraph)
    )
    return command + space + prose(text)


def comment(paragraphs: Iterable[str], indent: str = "") -> str:
    """Return a documentation comment: on one line if it fits, else a block."""
    paragraphs = [_escaped_paragraph(p) for p in paragraphs if p]
    if len(paragraphs) == 1 and len(indent) + len(paragraphs[0]) + 7 <= WIDTH:
        return f"{indent}/** {tamed(paragraphs[0])} */"
    return "\n".join(
        [f"{indent}/**", *commented(paragraphs, WIDTH, f"{indent} * "), f"{indent} */"]
    )


def described(paragraphs: Comment, indent: str = "") -> str:
    """Return the comment of a part of the ICD, with its errata as notes."""
    return comment(
        [" ".join((paragraphs.head, *paragraphs.details)), *noted(paragraphs)], indent
    )


def noted(paragraphs: Comment) -> list[str]:
    """Return the errata as notes of documentation tools."""
    return [
        _Command(f"@note {paragraph.removeprefix('Note ')}")
        for paragraph in paragraphs.errata
    ]


@lru_cache(maxsize=4096)
def literal(text: str) -> str:
    """Return a string literal, in ASCII, of the UTF-8 bytes of a text."""
    text = text.replace("\\", "\\\\").replace('"', '\\"')
    # `\?` exists to avoid trigraphs (C99 6.4.4.4).
    while "??" in text:
        text = text.replace("??", "?\\?")
    if not (text.isascii() and text.isprintable()):
        text = "".join(c if " " <= c <= "~" else _octal(c) for c in text)
    return f'"{text}"'


def _octal(char: str) -> str:
    # Octal, because an octal escape ends after three digits. A hexadecimal one takes
    # all digits that follow (C99 6.4.4.4).
    return "".join(f"\\{byte:03o}" for byte in char.encode("utf-8", "replace"))
