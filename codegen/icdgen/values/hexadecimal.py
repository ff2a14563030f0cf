"""Conversion of hexadecimal text in any usual spelling to bytes."""

from __future__ import annotations

import re

from icdgen.values.errors import BadHex

_TOKEN = re.compile(
    r"""(?P<space> [\s,;:{}\[\]()_.-]+ )
      | (?P<prefix> 0[xX] | \\[xX] | [xX\#$](?=[0-9A-Fa-f]) )
      | (?P<digits> [0-9A-Fa-f]+ )""",
    re.VERBOSE,
)
_QUOTED = re.compile(r"""\s*b?(?P<quote>["'])(?P<inside>.*)(?P=quote)\s*""", re.DOTALL)
HELP = "bytes are two digits each, for instance `2efb 0a00`, `0x2e, 0xfb` or `2E:FB`"


def parse_hex(text: str) -> bytes:
    r"""Return the bytes of ``2efb 0a00``, ``0x2e,0xfb``, ``2E:FB``, ``{0x2e, 0xfb}`` or
    ``\x2e\xfb``, on one or more lines.

    After a prefix, a single digit is also a byte (``0x5``). Raises `BadHex` with the
    place of the first error.
    """
    quoted = _QUOTED.fullmatch(text)
    at, end = quoted.span("inside") if quoted else (0, len(text))
    result = bytearray()
    prefixed = -1  # index of the end of the last prefix
    while at < end:
        token = _TOKEN.match(text, at, end)
        if token is None:
            raise BadHex(
                f"{_place(text, at)}: {_show(text[at])} is not hexadecimal", HELP
            )
        digits = token["digits"]
        if prefixed == at and digits is None:
            raise BadHex(f"{_place(text, at)}: digits must follow the prefix", HELP)
        if digits is not None:
            if prefixed == at and len(digits) == 1:
                digits = "0" + digits
            # A letter directly after digits is an error, and not the start of a prefix
            # as in `2ex`.
            after = text[token.end() : min(token.end() + 1, end)]
            if after.isalnum():
                raise BadHex(
                    f"{_place(text, token.end())}: {_show(after)} is not hexadecimal",
                    HELP,
                )
            if len(digits) % 2:
                raise BadHex(
                    f"{_place(text, at)}: `{digits[:20]}` is an odd number of digits",
                    HELP,
                )
            result += bytes.fromhex(digits)
        elif token["prefix"]:
            prefixed = token.end()
        at = token.end()
    if prefixed == end:
        raise BadHex(f"{_place(text, end)}: digits must follow the prefix", HELP)
    return bytes(result)


def _place(text: str, at: int) -> str:
    """Return an index of the text in words: character, and line if there are several."""
    line = text.count("\n", 0, at)
    if "\n" not in text:
        return f"character {at + 1} of the bytes"
    return f"line {line + 1}, character {at - text.rfind(chr(10), 0, at)} of the bytes"


def _show(character: str) -> str:
    """Return a character for a message."""
    return f"`{character}`" if character.isprintable() else f"U+{ord(character):04X}"
