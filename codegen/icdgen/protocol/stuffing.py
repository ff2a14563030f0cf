"""Frames between delimiters: SLIP (RFC 1055), HDLC as asynchronous lines have it (RFC 1662), and COBS."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.protocol.envelope import COBS, HDLC, SLIP

_SLIP_END, _SLIP_ESCAPE = 0xC0, 0xDB
_SLIP_ESCAPED = {0xDC: _SLIP_END, 0xDD: _SLIP_ESCAPE}
_HDLC_FLAG, _HDLC_ESCAPE, _HDLC_FLIP = 0x7E, 0x7D, 0x20
_COBS_END, _COBS_WHOLE = 0, 0xFF  # a block of 254 bytes has no zero behind it


class Found(NamedTuple):
    """What stood between two delimiters: a frame, or what is wrong with it; ``size``: its bytes on the line."""

    frame: bytes
    size: int
    faults: list[str]


def stuffed(delimited_by: str, frame: bytes) -> bytes:
    """The frame between delimiters; as it is where there are none."""
    if delimited_by == SLIP:
        out = frame.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc")
        return b"\xc0" + out + b"\xc0"
    if delimited_by == HDLC:
        out = b"".join(bytes([0x7D, b ^ _HDLC_FLIP]) if b in (0x7D, 0x7E) else bytes([b]) for b in frame)
        return b"\x7e" + out + b"\x7e"
    return _cobs(frame) if delimited_by == COBS else frame


def _cobs(frame: bytes) -> bytes:
    out, block, is_whole = bytearray(), bytearray(), False
    for byte in frame:
        is_whole = False
        if byte:
            block.append(byte)
            is_whole = len(block) == _COBS_WHOLE - 1
        if is_whole or not byte:
            out += bytes([len(block) + 1]) + block
            block.clear()
    if not is_whole:
        out += bytes([len(block) + 1]) + block
    return bytes(out) + b"\0"


class Unstuffer:
    """Finds what stands between delimiters. ``run``: bytes of the stream since the last one."""

    def __init__(self, limit: int) -> None:
        self.limit, self.run = limit, 0
        self.clear()

    def clear(self) -> None:
        self.frame = bytearray()
        self.faults: list[str] = []

    def feed(self, byte: int) -> Iterator[Found]:
        """Takes the next byte."""
        self.run += 1
        if byte == self.end:
            self.ended()
            if self.frame or self.faults:
                yield Found(bytes(self.frame), self.run, self.faults)
            self.run = 0
            self.clear()
        elif not self.faults:
            self.inside(byte)

    end = 0

    def ended(self) -> None:
        """The delimiter came."""

    def inside(self, byte: int) -> None:
        """A byte that is no delimiter."""

    def put(self, byte: int) -> None:
        """A byte of the frame."""
        if len(self.frame) == self.limit:
            self.faults = ["overrun"]
        else:
            self.frame.append(byte)


class Escaped(Unstuffer):
    """SLIP and HDLC."""

    def __init__(self, limit: int, is_slip: bool) -> None:
        self.is_slip = is_slip
        self.end, self.escape = (_SLIP_END, _SLIP_ESCAPE) if is_slip else (_HDLC_FLAG, _HDLC_ESCAPE)
        super().__init__(limit)

    def clear(self) -> None:
        super().clear()
        self.is_escaped = False

    def ended(self) -> None:
        if self.is_escaped and not self.faults:
            self.faults = ["framing"]

    def inside(self, byte: int) -> None:
        if self.is_escaped:
            self.is_escaped = False
            meant = _SLIP_ESCAPED.get(byte) if self.is_slip else byte ^ _HDLC_FLIP
            if meant is None:
                self.faults = ["framing"]
            else:
                self.put(meant)
        elif byte == self.escape:
            self.is_escaped = True
        else:
            self.put(byte)


class Cobs(Unstuffer):
    """COBS. ``left``: bytes that the block still has; ``is_zero``: whether a zero follows it."""

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
        self.left, self.is_zero = byte - 1, byte != _COBS_WHOLE


def unstuffer(delimited_by: str, limit: int) -> Unstuffer | None:
    """What takes frames out of a stream; None where nothing delimits them."""
    if delimited_by == COBS:
        return Cobs(limit)
    return Escaped(limit, delimited_by == SLIP) if delimited_by in (SLIP, HDLC) else None
