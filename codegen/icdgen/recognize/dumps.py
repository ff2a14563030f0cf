"""Hexadecimal dumps with addresses: xxd, hexdump, hexdump -C, od and packet analysers.

`dump` returns the bytes of such a text, or None if the text is anything else.
"""

from __future__ import annotations

import re
from itertools import pairwise

from icdgen.frozen import NamedTuple

_LINE = re.compile(
    r"(?:0x)?(?P<at>[0-9A-Fa-f]{4,8})(?P<mark>:?)(?P<space>\s*)"
    r"(?P<data>(?:[0-9A-Fa-f]{2}){0,4}(?:\s{1,2}(?:[0-9A-Fa-f]{2}){1,4}(?=\s|$))*)(?P<text>\s*\|.*\|?|\s{2,}.*)?"
)
_WORDS = 7  # digits of an address of hexdump and od


class _Row(NamedTuple):
    """Line of a dump: its address as printed, and its bytes."""

    at: str
    data: bytes
    is_sure: bool  # the first number is certainly an address


def dump(text: str) -> bytes | None:
    """Return the bytes of a dump.

    Return None if it is no dump, or its addresses have gaps.

    hexdump and od print 16-bit words of a little-endian machine after a 7-digit
    address.
    """
    rows: list[_Row] = []
    for line in text.splitlines():
        if line.strip():
            row = _row(line.strip())
            if row is None:
                return None
            rows.append(row)
    # The first number of a single line can be data as well. In several lines, addresses
    # that count the bytes leave no doubt.
    if not rows or (len(rows) == 1 and not rows[0].is_sure):
        return None
    for base in (16, 8):  # od prints octal addresses by default
        try:
            places = [int(row.at, base) for row in rows]
        except ValueError:
            continue
        if all(
            later - at == len(row.data)
            # The last line has no address behind it.
            for (at, later), row in zip(pairwise(places), rows, strict=False)
        ):
            return b"".join(row.data for row in rows)
    return None


def _row(line: str) -> _Row | None:
    """Return address and bytes of a line, or None if it is not a line of a dump."""
    match = _LINE.fullmatch(line)
    if match is None or (match["data"] and not match["space"]):
        return None
    at, words = match["at"], match["data"].split()
    swapped = (
        len(at) == _WORDS
        and not match["mark"]
        and all(len(word) == 4 for word in words)
    )
    # The dump has words as numbers: the first byte is the second pair of digits.
    data = b"".join(bytes.fromhex(word)[:: -1 if swapped else 1] for word in words)
    is_sure = bool(match["mark"]) or len(at) == _WORDS or len(match["space"]) > 1
    return _Row(at, data, is_sure or (match["text"] or "").strip().startswith("|"))
