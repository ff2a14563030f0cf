"""Delimited frames: SLIP (RFC 1055), asynchronous HDLC (RFC 1662), COBS, and escape
characters.

`stuffed` adds the delimiters to a frame. `unstuffer` returns the object that finds the
frames in received bytes; links without delimiters have none. It checks no checksum.
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Union

from .packet_formats import Delimiter, Escaping, Stream

_SLIP_ESCAPED = {0xDC: 0xC0, 0xDD: 0xDB}
_HDLC_FLIP = 0x20


class Frame(NamedTuple):
    """A frame between delimiters, its number of bytes on the line, and its error or
    None.

    ``noise``: bytes that are not in a frame.
    """

    bytes: bytes
    size: int
    fault: Optional[str]


def stuffed(form: Stream, frame: bytes) -> bytes:
    """Return the frame with its delimiters, or unchanged without delimiters."""
    delimited_by = form.delimited_by
    if delimited_by == "escape" and form.escaping:
        return _escaped(form.escaping, frame)
    if delimited_by == "slip":
        data = frame.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc")
        return b"\xc0" + data + b"\xc0"
    if delimited_by == "hdlc":
        data = frame.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e")
        return b"\x7e" + data + b"\x7e"
    return _cobs(frame) if delimited_by == "cobs" else frame


def _escaped(escaping: Escaping, frame: bytes) -> bytes:
    escape = bytes((escaping.escape,))
    # Without a start byte, the first byte of the frame follows the first escape byte.
    start = b"" if escaping.start is None else bytes((escaping.start,))
    data = frame.replace(escape, bytes((escaping.escape, escaping.data)))
    return escape + start + data + escape + bytes((escaping.end,))


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
    """Extract frames of SLIP, HDLC and COBS from a stream. The buffer has ``limit``
    bytes.
    """

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

    @property
    def begun(self) -> bytes:
        """Return the bytes of the frame whose end has not come."""
        return bytes(self._buffer)

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


class Unescaper:
    """Extract frames between escape characters from a stream. The buffer has ``limit``
    bytes.
    """

    def __init__(self, escaping: Escaping, limit: int) -> None:
        self._escaping, self._limit = escaping, limit
        self._escape = bytes((escaping.escape,))
        self._buffer = bytearray()
        self._fault: Optional[str] = None
        self._is_inside = False
        self._is_escaped = False
        self.pending = 0
        """Bytes of the frame that has begun, and an escape byte that may begin one."""

    @property
    def begun(self) -> bytes:
        """Return the bytes of the frame whose end has not come."""
        return bytes(self._buffer)

    def feed(self, data: bytes) -> list[Frame]:
        """Process the next bytes. Return the frames that end in them, and noise."""
        frames: list[Frame] = []
        at = 0
        while at < len(data):
            if self._is_escaped:
                self._after_escape(data[at], frames)
                at += 1
                continue
            escape = data.find(self._escape, at)
            end = len(data) if escape < 0 else escape
            if not self._is_inside:
                _add_noise(end - at, frames)
            else:
                self.pending += end - at
                self._put(data[at:end])
            at = end
            if escape >= 0:
                self._is_escaped = True
                self.pending += 1
                at += 1
        return frames

    def _after_escape(self, byte: int, frames: list[Frame]) -> None:
        escaping = self._escaping
        self._is_escaped = False
        self.pending += 1
        if escaping.begins(byte):
            if self._is_inside:  # the end of the frame before was lost
                self._end("framing", 2, frames)
            self._is_inside, self.pending = True, 2
            if escaping.start is None:
                self._put(bytes((byte,)))
        elif not self._is_inside:
            # The last one of several escape bytes can begin a frame.
            self._is_escaped = byte == escaping.escape
            _add_noise(1 if self._is_escaped else 2, frames)
            self.pending = int(self._is_escaped)
        elif byte == escaping.end:
            self._end(None, 0, frames)
        elif byte == escaping.data:
            self._put(self._escape)
        elif not escaping.ignores_other:
            self._fault = self._fault or "framing"
            self._is_escaped = byte == escaping.escape

    def _end(self, fault: Optional[str], after: int, frames: list[Frame]) -> None:
        """End the frame ``after`` bytes before the last one."""
        size = self.pending - after
        frames.append(Frame(bytes(self._buffer), size, self._fault or fault))
        self.pending, self._is_inside, self._fault = 0, False, None
        self._buffer.clear()

    def _put(self, data: bytes) -> None:
        if self._fault is None:
            room = self._limit - len(self._buffer)
            self._buffer += data[:room]
            if len(data) > room:
                self._fault = "overrun"


def _add_noise(size: int, frames: list[Frame]) -> None:
    if size:
        frames.append(Frame(b"", size, "noise"))


def unstuffer(form: Stream, limit: int) -> Union[Unstuffer, Unescaper, None]:
    """Return what extracts the frames from a stream; None without delimiters."""
    if form.delimited_by in ("length", "datagram"):
        return None
    if form.escaping:
        return Unescaper(form.escaping, limit)
    return Unstuffer(form.delimited_by, limit)
