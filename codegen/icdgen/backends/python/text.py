"""Text of the ICD in Python source: literals and docstrings that no text can end early.

`literal` escapes quotes and control characters; `prose` and `paragraph` escape markup
as well, because documentation tools read docstrings as reStructuredText.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from icdgen.backends.lines import wrapped

WIDTH = 88

# Printable ASCII without double quote and backslash.
_PLAIN = re.compile(r"[ -!#-\[\]-~]*\Z")
# In both a backslash takes the meaning from what follows: of inline markup, and of what
# begins a list, a directive, a field.
_MARKUP = re.compile(
    r"""[\\`<*_|]  # characters that markup contains: without one of them, the alternatives are not tried
        (?: (?<=[\\`])
          | (?<=<)(?=[A-Za-z/!?])
          | (?<=[*_|])(?<![^\s'"(\[{</:-].)(?=\S)
          | (?<=\w_)(?!\w)
          | (?<=\|)(?=_)
        )""",
    re.VERBOSE,
)
_BLOCK = re.compile(
    r"\A(\(?(?:[0-9]+|[A-Za-z#])(?=[.)] )|(?=[-+*\u2022] |\.\. |>>>|:|[=#]+ ))"
)
_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t", "\\": "\\\\"}


def literal(text: str) -> str:
    """Return a string literal, in double quotes unless single quotes need fewer
    escapes.
    """
    if _PLAIN.match(text):
        return f'"{text}"'
    quote = "'" if text.count('"') > text.count("'") else '"'
    return (
        quote
        + "".join(f"\\{quote}" if c == quote else _character(c) for c in text)
        + quote
    )


def _character(c: str) -> str:
    if c in _ESCAPES:
        return _ESCAPES[c]
    if c.isprintable():
        return c
    code = ord(c)
    if code < 0x100:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def prose(text: str) -> str:
    """Return text for a docstring on one line, with escapes for quotes and for markup
    of reStructuredText and Markdown.
    """
    return _escaped_parts([" ".join(text.split())])


def paragraph(text: str) -> str:
    """Return `prose` of a paragraph of a description, in which text in backticks is
    code.
    """
    return _escaped_parts(text.split("`"))


def _escaped_parts(parts: list[str]) -> str:
    # Every second part is code. Backticks come in pairs: `describe.comments` replaces
    # those of the ICD.
    parts[::2] = [
        part if part.replace(" ", "").isalnum() else _MARKUP.sub(r"\\\g<0>", part)
        for part in parts[::2]
    ]
    text = _BLOCK.sub(r"\g<1>\\", "`".join(parts))
    if _PLAIN.match(text):
        return text
    # The docstring is no raw string. The backslashes of markup are doubled here, and a
    # quote at its end cannot join the closing quotes.
    return "".join('\\"' if c == '"' else _character(c) for c in text)


def docstring(indent: int, paragraphs: Iterable[str]) -> str:
    """Return paragraphs of `prose` between triple quotes; the first line has no
    indentation.
    """
    pad = " " * indent
    first, *further = paragraphs
    # Text without a blank cannot be wrapped, so it stays on the line of the quotes.
    if not further and (len(first) + 6 + indent <= WIDTH or " " not in first):
        return f'"""{first}"""'
    blocks = [f'"""{first}', *further]
    text = f"\n\n{pad}".join(
        f"\n{pad}".join(wrapped(block, WIDTH - indent)) for block in blocks
    )
    return f'{text}\n{pad}"""'


def documented(paragraphs: Iterable[str], indent: int = 4) -> str:
    """Return the docstring of the paragraphs of a description."""
    return docstring(indent, map(paragraph, paragraphs))
