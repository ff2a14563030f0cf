"""Printed CAN packets: candump, its log files, and the lines of slcan adapters.

`packets` parses a text with one packet per line; `icdgen.recognize.bus` finds the
messages in them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from icdgen.frozen import NamedTuple

# Time, interface, direction.
_BEFORE = r"(?:\((?P<time>[\d.:\s-]+)\)\s*)?(?:[A-Za-z]+\d+\s+)?(?:[TR]X\s[-BEP ]*)?"
_ID = r"(?P<id>[0-9A-Fa-f]{8}|[0-9A-Fa-f]{3})"
_SLCAN = r"(?P<size>[0-8])(?P<data>(?:[0-9A-Fa-f]{2})*)"
# candump; its log files (`##` and a digit are CAN FD, `R` is a remote request); slcan
# adapters with identifiers of 29 and 11 bits (`r` and `R` are remote requests).
_FORMS = (
    re.compile(
        _BEFORE
        + _ID
        + r"\s*\[(?P<size>\d{1,2})\]\s*(?P<data>(?:[0-9A-Fa-f]{2}(?:\s+|$))*|remote request)(?:'.*)?"
    ),
    re.compile(
        _BEFORE
        + _ID
        + r"#(?:#[0-9A-Fa-f])?(?P<data>(?:[0-9A-Fa-f]{2}\.?)*|R[0-8]?)(?:\s+[TR])?"
    ),
    re.compile(r"(?P<slcan>[TR])(?P<id>[0-9A-Fa-f]{8})" + _SLCAN),
    re.compile(r"(?P<slcan>[tr])(?P<id>[0-9A-Fa-f]{3})" + _SLCAN),
)
# Bytes of the time that an slcan adapter may append: milliseconds of the minute
# (Lawicel manual, command Z).
_STAMP = 2


class Printed(NamedTuple):
    """A packet. ``extended``: the identifier has 29 bits instead of 11.

    ``time`` is the text of candump, or the seconds of an slcan adapter within the
    minute. It may be empty.
    """

    id: int
    data: bytes
    extended: bool
    time: str = ""

    @property
    def identifier(self) -> str:
        """The identifier with 3 or 8 hexadecimal digits."""
        return f"0x{self.id:0{8 if self.extended else 3}X}"


def packets(text: str) -> list[Printed] | None:
    """Return one packet per line.

    Return None if a line is not a packet, or if its number of bytes is wrong.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    result = [packet for line in lines for packet in _packet(line)]
    return result if result and len(result) == len(lines) else None


def _packet(line: str) -> Iterator[Printed]:
    match = next(filter(None, (form.fullmatch(line) for form in _FORMS)), None)
    if match is None:
        return
    groups = match.groupdict()
    text, slcan = groups["data"], groups.get("slcan")
    data = b"" if text[:1] in ("R", "r") else bytes.fromhex(text.replace(".", ""))
    # A remote request has no data; its size is that of the response (ISO 11898-1).
    is_remote = text == "remote request" or slcan in ("r", "R")
    size = 0 if is_remote else int(groups.get("size") or len(data))
    if len(data) != size and not (slcan and len(data) == size + _STAMP):
        return
    time = (groups.get("time") or "").strip()
    # The bytes beyond the size are the time of the adapter.
    if len(data) > size:
        time = f"{int.from_bytes(data[size:], 'big') / 1000:.3f}"
    # Tools print an identifier of 29 bits with 8 digits, even if its value is small.
    yield Printed(int(match["id"], 16), data[:size], len(match["id"]) == 8, time)
