"""Text from the ICD -> C comments and string literals that nothing can break out of."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

WIDTH = 120


@lru_cache(maxsize=8192)
def plain(text: str) -> str:
    """One line that is safe within a block comment: no comment delimiters, trigraphs or control characters."""
    text = " ".join(text.split())
    if not (text.isascii() and text.isprintable()):
        text = "".join(c if c.isprintable() else f"<U+{ord(c):04X}>" for c in text)
    for unsafe, safe in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?")):
        while unsafe in text:
            text = text.replace(unsafe, safe)
    return text


def comment(paragraphs: Iterable[str], indent: str = "") -> str:
    """A documentation comment of `plain` paragraphs: one line where it fits, else a block."""
    paragraphs = [p for p in paragraphs if p]
    if len(paragraphs) == 1 and len(indent) + len(paragraphs[0]) + 7 <= WIDTH:
        return f"{indent}/** {paragraphs[0]} */"
    lines = [f"{indent}/**"]
    for paragraph in paragraphs:
        lines += [f"{indent} * {line}" for line in _lines(paragraph, WIDTH - len(indent) - 3)]
    lines.append(f"{indent} */")
    return "\n".join(lines)


def _lines(paragraph: str, width: int) -> list[str]:
    if len(paragraph) <= width:
        return [paragraph]
    hang = "  " if paragraph.startswith("@") else ""
    lines, line = [], ""
    for word in paragraph.split(" "):
        if line.strip() and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = hang + word
        else:
            line = f"{line} {word}" if line else word
    return [*lines, line]


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
