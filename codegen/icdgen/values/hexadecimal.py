"""Bytes from hexadecimal text in any usual spelling."""

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
    r"""The bytes of ``2efb 0a00``, ``0x2e,0xfb``, ``2E:FB``, ``{0x2e, 0xfb}``, ``\x2e\xfb``, over any number of lines.

    After a prefix one digit is a byte too (``0x5``). Raises `BadHex` with the place of what does not fit.
    """
    quoted = _QUOTED.fullmatch(text)
    at, end = quoted.span("inside") if quoted else (0, len(text))
    found = bytearray()
    prefixed = -1  # where a prefix ended
    while at < end:
        token = _TOKEN.match(text, at, end)
        if token is None:
            raise BadHex(f"{_place(text, at)}: {_show(text[at])} is not hexadecimal", HELP)
        digits = token["digits"]
        if prefixed == at and digits is None:
            raise BadHex(f"{_place(text, at)}: digits must follow the prefix", HELP)
        if digits is not None:
            if prefixed == at and len(digits) == 1:
                digits = "0" + digits
            after = text[token.end() : min(token.end() + 1, end)]
            if after.isalnum():
                raise BadHex(f"{_place(text, token.end())}: {_show(after)} is not hexadecimal", HELP)
            if len(digits) % 2:
                raise BadHex(f"{_place(text, at)}: `{digits[:20]}` is an odd number of digits", HELP)
            found += bytes.fromhex(digits)
        elif token["prefix"]:
            prefixed = token.end()
        at = token.end()
    if prefixed == end:
        raise BadHex(f"{_place(text, end)}: digits must follow the prefix", HELP)
    return bytes(found)


def _place(text: str, at: int) -> str:
    line = text.count("\n", 0, at)
    if "\n" not in text:
        return f"character {at + 1} of the bytes"
    return f"line {line + 1}, character {at - text.rfind(chr(10), 0, at)} of the bytes"


def _show(character: str) -> str:
    return f"`{character}`" if character.isprintable() else f"U+{ord(character):04X}"
