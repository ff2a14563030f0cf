"""Delimited frames: SLIP (RFC 1055), asynchronous HDLC (RFC 1662) and COBS."""

from __future__ import annotations

from typing import NamedTuple, Optional

from .envelope import Delimiter

_SLIP_ESCAPED = {0xDC: 0xC0, 0xDD: 0xDB}
_HDLC_FLIP = 0x20


class Frame(NamedTuple):
    """A frame between delimiters, its number of bytes on the line, and its error or
    None.
    """

    bytes: bytes
    size: int
    fault: Optional[str]


def stuffed(delimited_by: Delimiter, frame: bytes) -> bytes:
    """Return the frame with its delimiters, or unchanged without delimiters."""
    if delimited_by == "slip":
        data = frame.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc")
        return b"\xc0" + data + b"\xc0"
    if delimited_by == "hdlc":
        data = frame.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e")
        return b"\x7e" + data + b"\x7e"
    return _cobs(frame) if delimited_by == "cobs" else frame


def _cobs(frame: bytes) -> bytes:
    out, is_whole = bytearray(), False
    for part in frame.split(b"\0"):
        at = 0
        while len(part) - at >= 254:
            # A full block: 254 bytes other than zero, and no implied zero after them.
            out.append(0xFF)
            out += part[at : at + 254]
            at += 254
        is_whole = 0 < len(part) == at
        remainder = part[at:]
        out.append(len(remainder) + 1)
        out += remainder
    if is_whole:  # a full last block does not need a block for an implied zero
        del out[-1]
    out.append(0)
    return bytes(out)


class Unstuffer:
    """Extract frames from a stream. The buffer has ``limit`` bytes."""

    def __init__(self, delimited_by: Delimiter, limit: int) -> None:
        self._limit = limit
        self._is_cobs, self._is_slip = delimited_by == "cobs", delimited_by == "slip"
        ends = {"slip": (0xC0, 0xDB), "hdlc": (0x7E, 0x7D)}
        self._end, self._escape = ends.get(delimited_by, (0, 0))
        self.pending = 0
        """Bytes of the stream since the last delimiter."""
        self._clear()

    def _clear(self) -> None:
        self._buffer = bytearray()
        self._fault: Optional[str] = None
        self._is_escaped = False
        self._left = 0  # remaining bytes of the COBS block
        self._is_zero = False  # whether a zero follows this block

    def feed(self, data: bytes) -> list[Frame]:
        """Process the next bytes. Return the frames that end in them."""
        frames = []
        for byte in data:
            self.pending += 1
            if byte == self._end:
                if self._is_escaped or self._left:
                    self._fault = self._fault or "framing"
                if self._buffer or self._fault:
                    frame = bytes(self._buffer)
                    frames.append(Frame(frame, self.pending, self._fault))
                self.pending = 0
                self._clear()
            elif self._fault is None:
                self._inside(byte)
        return frames

    def _inside(self, byte: int) -> None:
        if self._is_cobs:
            if self._left:
                self._left -= 1
                self._put(byte)
                return
            # The implied zero is data only if another block follows.
            if self._is_zero:
                self._put(0)
            self._left, self._is_zero = byte - 1, byte != 0xFF
        elif self._is_escaped:
            self._is_escaped = False
            meant = _SLIP_ESCAPED.get(byte) if self._is_slip else byte ^ _HDLC_FLIP
            if meant is None:
                self._fault = "framing"
            else:
                self._put(meant)
        elif byte == self._escape:
            self._is_escaped = True
        else:
            self._put(byte)

    def _put(self, byte: int) -> None:
        if len(self._buffer) == self._limit:
            self._fault = "overrun"
        else:
            self._buffer.append(byte)
