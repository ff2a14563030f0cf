"""Byte stuffing of delimited frames: SLIP (RFC 1055), asynchronous HDLC (RFC 1662) and
COBS (Cheshire and Baker, 1999).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.protocol.envelope import COBS, HDLC, SLIP

_SLIP_END, _SLIP_ESCAPE = 0xC0, 0xDB
_SLIP_ESCAPED = {0xDC: _SLIP_END, 0xDD: _SLIP_ESCAPE}
_HDLC_FLAG, _HDLC_ESCAPE, _HDLC_FLIP = 0x7E, 0x7D, 0x20
# Code 0xFF: block of 254 bytes without a following zero
_COBS_END, _COBS_FULL = 0, 0xFF


class Delimited(NamedTuple):
    """Bytes between two delimiters: a frame, or its faults.

    ``size``: number of transmitted bytes, delimiter included.
    """

    frame: bytes
    size: int
    faults: list[str]


def stuffed(delimited_by: str, frame: bytes) -> bytes:
    """Return the frame with byte stuffing and delimiters; unchanged if the format has
    none.
    """
    if delimited_by == SLIP:
        # The escape byte is replaced first: the other replacement inserts escape bytes.
        out = frame.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc")
        return b"\xc0" + out + b"\xc0"
    if delimited_by == HDLC:
        out = b"".join(
            bytes([0x7D, b ^ _HDLC_FLIP]) if b in (0x7D, 0x7E) else bytes([b])
            for b in frame
        )
        return b"\x7e" + out + b"\x7e"
    return _cobs(frame) if delimited_by == COBS else frame


def _cobs(frame: bytes) -> bytes:
    out, block, is_full = bytearray(), bytearray(), False
    for byte in frame:
        is_full = False
        if byte:
            block.append(byte)
            # A full block of 254 bytes implies no zero; it must not be closed a second
            # time.
            is_full = len(block) == _COBS_FULL - 1
        if is_full or not byte:
            out += bytes([len(block) + 1]) + block
            block.clear()
    if not is_full:
        out += bytes([len(block) + 1]) + block
    return bytes(out) + b"\0"


class Unstuffer:
    """Decoder of byte stuffing, fed byte by byte.

    ``run``: number of bytes since the last delimiter.
    """

    def __init__(self, limit: int) -> None:
        self.limit, self.run = limit, 0
        self.clear()

    def clear(self) -> None:
        self.frame = bytearray()
        self.faults: list[str] = []

    def feed(self, byte: int) -> Iterator[Delimited]:
        """Process the next byte."""
        self.run += 1
        if byte == self.end:
            self.ended()
            if self.frame or self.faults:
                yield Delimited(bytes(self.frame), self.run, self.faults)
            self.run = 0
            self.clear()
        elif not self.faults:
            self.inside(byte)

    end = 0

    def ended(self) -> None:
        """Process the delimiter."""

    def inside(self, byte: int) -> None:
        """Process a byte other than the delimiter."""

    def put(self, byte: int) -> None:
        """Append a byte to the frame."""
        if len(self.frame) == self.limit:
            self.faults = ["overrun"]
        else:
            self.frame.append(byte)


class Escaped(Unstuffer):
    """Decoder of SLIP and HDLC."""

    def __init__(self, limit: int, is_slip: bool) -> None:
        self.is_slip = is_slip
        self.end, self.escape = (
            (_SLIP_END, _SLIP_ESCAPE) if is_slip else (_HDLC_FLAG, _HDLC_ESCAPE)
        )
        super().__init__(limit)

    def clear(self) -> None:
        super().clear()
        self.is_escaped = False

    def ended(self) -> None:
        # A delimiter directly after an escape byte is invalid (RFC 1662, 4.3).
        if self.is_escaped and not self.faults:
            self.faults = ["framing"]

    def inside(self, byte: int) -> None:
        if self.is_escaped:
            self.is_escaped = False
            original = _SLIP_ESCAPED.get(byte) if self.is_slip else byte ^ _HDLC_FLIP
            if original is None:
                self.faults = ["framing"]
            else:
                self.put(original)
        elif byte == self.escape:
            self.is_escaped = True
        else:
            self.put(byte)


class Cobs(Unstuffer):
    """Decoder of COBS.

    ``left``: remaining bytes of the block. ``is_zero``: whether a zero follows the
    block.
    """

    def clear(self) -> None:
        super().clear()
        self.left, self.is_zero = 0, False

    def ended(self) -> None:
        if self.left and not self.faults:
            self.faults = ["framing"]

    def inside(self, byte: int) -> None:
        if self.left:
            self.left -= 1
            self.put(byte)
            return
        if self.is_zero:
            self.put(0)
        self.left, self.is_zero = byte - 1, byte != _COBS_FULL


def unstuffer(delimited_by: str, limit: int) -> Unstuffer | None:
    """Return the decoder of the byte stuffing; None if the format has no delimiters."""
    if delimited_by == COBS:
        return Cobs(limit)
    return (
        Escaped(limit, delimited_by == SLIP) if delimited_by in (SLIP, HDLC) else None
    )
