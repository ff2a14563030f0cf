"""The ICD's words in Python source: literals and docstrings that nothing can break out of."""

from __future__ import annotations

import re
from collections.abc import Iterable

from icdgen.backends.python.black import WIDTH

_PLAIN = re.compile(r"[ -!#-\[\]-~]*\Z")  # printable ASCII without double quote and backslash
# In both a backslash takes the meaning from what follows: of inline markup, and of what begins a list, a directive, a field.
_MARKUP = re.compile(r"[\\`]|<(?=[A-Za-z/!?])|(?<![^\s'\"(\[{</:-])[*_|](?=\S)|(?<=\w)_(?!\w)|\|(?=_)")
_BLOCK = re.compile(r"\A(\(?(?:[0-9]+|[A-Za-z#])(?=[.)] )|(?=[-+*\u2022] |\.\. |>>>|:|[=#]+ ))")
_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t", "\\": "\\\\"}


def literal(text: str) -> str:
    """A string literal, in double quotes unless single ones need fewer escapes."""
    if _PLAIN.match(text):
        return f'"{text}"'
    quote = "'" if text.count('"') > text.count("'") else '"'
    return quote + "".join(f"\\{quote}" if c == quote else _character(c) for c in text) + quote


def _character(c: str) -> str:
    if c in _ESCAPES:
        return _ESCAPES[c]
    if c.isprintable():
        return c
    code = ord(c)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def prose(text: str) -> str:
    """Text for a docstring: one line, nothing that ends or escapes from it, and nothing that reStructuredText or Markdown take
    for markup."""
    text = " ".join(text.split())
    if not text.replace(" ", "").isalnum():
        text = _BLOCK.sub(r"\g<1>\\", _MARKUP.sub(r"\\\g<0>", text))
    if _PLAIN.match(text):
        return text
    return "".join('\\"' if c == '"' else _character(c) for c in text)


def sentence(text: str) -> str:
    """`prose` that ends like a sentence, so that a docstring never ends in a quote."""
    text = prose(text)
    return text if text.endswith((".", "!", "?")) else f"{text}."


def wrapped(text: str, width: int) -> list[str]:
    """The words of ``text`` on lines of at most ``width`` characters, as far as words allow."""
    if len(text) <= width:
        return [text]
    lines, line = [], ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}" if line else word
    return [*lines, line]


def docstring(indent: int, paragraphs: Iterable[str]) -> str:
    """Paragraphs (of `prose`) between triple quotes; the first line stands without its indentation."""
    paragraphs = list(paragraphs)
    pad = " " * indent
    if len(paragraphs) == 1:
        text = f'"""{paragraphs[0]}"""'
        if len(text) + indent <= WIDTH or " " not in paragraphs[0]:
            return text
        lines = wrapped(text[:-3], WIDTH - indent)
        if len(lines) == 1:  # only the closing quotes do not fit
            lines = wrapped(text[:-3], len(lines[0]) - 1)
        return f"\n{pad}".join(lines) + f'\n{pad}"""'
    blocks = []
    for number, paragraph in enumerate(paragraphs):
        first = "" if number else '"""'
        blocks.append(f"\n{pad}".join(wrapped(first + paragraph, WIDTH - indent)))
    text = f"\n\n{pad}".join(blocks)
    return f'{text}\n{pad}"""'
