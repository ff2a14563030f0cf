"""Documentation comments, literals and lines of Rust.

Text of an ICD is escaped so that rustdoc shows it unchanged. Generated code is laid out
as rustfmt would do it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from icdgen.backends.lines import STEP, bracketed, commented, plain
from icdgen.describe.comments import Comment

WIDTH = 100

# `_` is markup only at the edge of a word, and `&` only where an entity can begin. The
# colon of a URL is escaped because rustdoc (`bare_urls`) warns about URLs that are no
# links.
_MARKDOWN = re.compile(
    r"""[\\`*\[\]<|~$_&:]  # characters that markup contains: without one of them, the alternatives are not tried
        (?: (?<=[\\`*\[\]<|~$])
          | (?<![A-Za-z0-9]_)(?<=_)
          | (?<=_)(?![A-Za-z0-9])
          | (?<=&)(?=[#A-Za-z])
          | (?<=http:)|(?<=https:)
        )""",
    re.VERBOSE,
)


@lru_cache(maxsize=8192)
def prose(text: str) -> str:
    """Return `plain` text that rustdoc shows unchanged: markup, links and HTML are
    escaped, text in backticks is code.
    """
    text = plain(text)
    if text.replace(" ", "").isalnum():
        return text
    parts = text.split("`")
    # The number of backticks is odd, so one of them opens no code. All are escaped.
    if len(parts) % 2 == 0:
        return _MARKDOWN.sub(r"\\\g<0>", text)
    return "`".join(
        part if number % 2 else _MARKDOWN.sub(r"\\\g<0>", part)
        for number, part in enumerate(parts)
    )


def doc(paragraphs: Iterable[str], indent: str = "", mark: str = "///") -> str:
    """Return a documentation comment of `prose`, wrapped and indented."""
    return "\n".join(commented(paragraphs, WIDTH, f"{indent}{mark} ", is_spaced=True))


def code(lines: Iterable[str], indent: str = "", mark: str = "///") -> str:
    """Return lines of a documentation comment without wrapping, after an empty line."""
    return "\n".join(f"{indent}{mark} {line}".rstrip() for line in ("", *lines))


def described(comment: Comment, indent: str = "") -> str:
    """Return the documentation comment of a part of the ICD."""
    return doc(map(prose, comment.paragraphs), indent)


_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


@lru_cache(maxsize=8192)
def string(text: str) -> str:
    """Return a string literal in ASCII."""
    if text.isascii() and text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    return (
        '"'
        + "".join(
            _ESCAPES.get(c) or (c if " " <= c <= "~" else f"\\u{{{ord(c):x}}}")
            for c in text
        )
        + '"'
    )


@lru_cache(maxsize=4096)
def integer(value: int) -> str:
    """Return the literal of an integer: ``-32_768``."""
    return f"{value:_}"


@lru_cache(maxsize=4096)
def mask(value: int, bits: int = 8) -> str:
    """Return a hexadecimal literal with a digit for four bits: ``0x0f``, ``0x0fff``,
    ``0x000f_ffff``.
    """
    digits = bits // 4
    return f"0x{value:0{digits + (digits - 1) // 4}_x}"


def whole_double(value: int) -> str:
    """Return a whole number as the literal of a double: ``32_768.0``."""
    return f"{value:_}.0"


def double(value: float) -> str:
    """Return the shortest literal of a double with grouped digits: ``0.488_281_25``,
    ``1.0e-9``.
    """
    digits, _, exponent = repr(value).partition("e")
    integral, _, fraction = digits.partition(".")
    sign, integral = ("-", integral[1:]) if integral.startswith("-") else ("", integral)
    fraction = fraction or "0"
    if len(fraction) > 3:
        fraction = "_".join(fraction[i : i + 3] for i in range(0, len(fraction), 3))
    # The sign was removed before, because `int("-0")` would lose it.
    text = f"{sign}{int(integral):_}.{fraction}"
    return f"{text}e{int(exponent)}" if exponent else text


def assigned(left: str, right: str, end: str, indent: str = STEP) -> str:
    """Return ``left right end`` on one line if it fits, else with the right side on a
    line of its own.
    """
    line = f"{indent}{left} {right}{end}"
    return line if len(line) <= WIDTH else f"{indent}{left}\n{indent}{STEP}{right}{end}"


def arm(pattern: str, body: str, indent: str = STEP * 3) -> str:
    """Return an arm of a match."""
    line = f"{indent}{pattern} => {body},"
    return (
        line
        if len(line) <= WIDTH
        else f"{indent}{pattern} => {{\n{indent}{STEP}{body}\n{indent}}}"
    )


def signature(start: str, parameters: tuple[str, ...], returns: str) -> str:
    """Return the head of a method, up to its opening brace."""
    return STEP + bracketed(f"{start}(", parameters, f") -> {returns} {{", WIDTH, STEP)
