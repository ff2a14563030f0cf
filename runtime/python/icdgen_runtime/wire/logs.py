"""Telemetry logs: the file form and the unsolicited form.

A mask selects the frames of a log; each selected bit has a slot of fixed size in every
entry.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, Optional

from .._base import Message
from .._errors import LengthError, RangeError
from .._hints import Buffer
from .errors import UnsupportedError, need
from .link import Link, LogBit, LogMask


class LogFrame(NamedTuple):
    """One frame of a log.

    If the ICD does not assign a frame to the bit, there is no ``id``, and ``data`` is
    the whole slot.
    """

    bit: int
    id: Optional[int]
    data: bytes

    def message(self, link: Link) -> Message:
        """Decode the frame. Raise `UnsupportedError` for an unassigned bit."""
        if self.id not in link.frames:
            raise UnsupportedError(f"the ICD has no frame for bit {self.bit} of a log")
        return link.TELEMETRY[self.id].from_bytes(self.data)


class LogEntry(NamedTuple):
    """An entry of a log file: Unix time, and frames in ascending order of the mask
    bits.
    """

    seconds: int
    milliseconds: int
    frames: tuple[LogFrame, ...]


class LogMessage(NamedTuple):
    """An unsolicited log, without time."""

    mask: bytes
    frames: tuple[LogFrame, ...]

    @classmethod
    def decode(cls, link: Link, message: bytes) -> LogMessage:
        """Decode a log message, which begins with its id.

        Raise `LengthError` and `UnsupportedError`.
        """
        form = need(link.log_message, "unsolicited_log")
        layout = need(link.mask, "log_mask")
        if len(message) < form.frames_at:
            raise LengthError("a log message", form.frames_at, len(message))
        mask = message[form.mask_at : form.mask_at + layout.size]
        slots = layout.selected(mask)
        length = form.frames_at + len(slots) * layout.slot_bytes
        if len(message) != length:
            raise LengthError("the log message", length, len(message))
        pieces = _pieces(slots, layout, form.frames_at)
        return cls(mask, _frames(pieces, message, 0))

    @staticmethod
    def encode(link: Link, mask: bytes, frames: Iterable[bytes]) -> bytes:
        """Encode a log message with its id.

        Raise `LengthError` and `UnsupportedError`.
        """
        form = need(link.log_message, "unsolicited_log")
        head = bytearray(form.frames_at)
        head[0] = form.id
        slots = _selected(need(link.mask, "log_mask"), mask)
        head[form.mask_at : form.mask_at + len(mask)] = mask
        return bytes(head) + _filled(link, slots, frames)


class LogReader:
    """Read a log file in pieces of any size. Raise `UnsupportedError`."""

    def __init__(self, link: Link) -> None:
        self._form = need(link.log_file, "telemetry_log")
        self._layout = need(link.mask, "log_mask")
        self._order: Literal["little", "big"] = link.order
        self._rest = b""
        self._pieces: list[tuple[int, Optional[int], int, int]] = []
        self._entry_bytes = 0
        self.mask: Optional[bytes] = None
        """The mask of the file; None until its header is complete."""

    @property
    def truncated(self) -> int:
        """Number of bytes at the end of the file that are not a complete entry."""
        return len(self._rest)

    def feed(self, data: Buffer) -> list[LogEntry]:
        """Process the next bytes of the file.

        Return the entries that are now complete.
        """
        form, data = self._form, self._rest + bytes(data)
        position = 0
        if self.mask is None:
            if len(data) < form.header_bytes:
                self._rest = data
                return []
            self.mask = data[form.mask_at : form.mask_at + self._layout.size]
            slots = self._layout.selected(self.mask)
            # Once per file: only the header has a mask, which applies to all entries.
            self._pieces = _pieces(slots, self._layout, form.frames_at)
            self._entry_bytes = form.frames_at + len(slots) * self._layout.slot_bytes
            position = form.header_bytes
        complete = (len(data) - position) // self._entry_bytes * self._entry_bytes
        starts = range(position, position + complete, self._entry_bytes)
        entries = [self._entry(data, start) for start in starts]
        self._rest = data[position + complete :]
        return entries

    def _entry(self, data: bytes, start: int) -> LogEntry:
        def number(at: int, size: int) -> int:
            return int.from_bytes(data[start + at : start + at + size], self._order)

        return LogEntry(
            number(*self._form.seconds),
            number(*self._form.milliseconds),
            _frames(self._pieces, data, start),
        )


class LogWriter:
    """Create a log file with the frames that ``mask`` selects.

    Raise `LengthError` for a mask of another length, and `UnsupportedError`.
    """

    def __init__(self, link: Link, mask: bytes) -> None:
        self._link, self._form = link, need(link.log_file, "telemetry_log")
        self._slots = _selected(need(link.mask, "log_mask"), mask)
        self._mask = mask

    def header(self) -> bytes:
        """Return the header of the file."""
        out = bytearray(self._form.header_bytes)
        out[self._form.mask_at : self._form.mask_at + len(self._mask)] = self._mask
        return bytes(out)

    def entry(self, seconds: int, milliseconds: int, frames: Iterable[bytes]) -> bytes:
        """Encode an entry from the data of each frame, in the order of the mask bits.

        Raise `LengthError`, and `RangeError` for a time out of range.
        """
        head = bytearray(self._form.frames_at)
        places = {
            "seconds": self._form.seconds,
            "milliseconds": self._form.milliseconds,
        }
        for name, value in (("seconds", seconds), ("milliseconds", milliseconds)):
            at, size = places[name]
            if not 0 <= value < 1 << 8 * size:
                raise RangeError(name, f"0 to {(1 << 8 * size) - 1}", value)
            head[at : at + size] = value.to_bytes(size, self._link.order)
        return bytes(head) + _filled(self._link, self._slots, frames)


def _selected(layout: LogMask, mask: bytes) -> list[LogBit]:
    if len(mask) != layout.size:
        raise LengthError("the mask", layout.size, len(mask))
    return layout.selected(mask)


def _pieces(
    slots: Sequence[LogBit], layout: LogMask, start: int
) -> list[tuple[int, Optional[int], int, int]]:
    """Return bit, id, begin and end of each frame."""
    pieces = []
    for number, slot in enumerate(slots):
        begin = start + number * layout.slot_bytes
        pieces.append((slot.bit, slot.id, begin, begin + slot.length))
    return pieces


def _frames(
    pieces: Sequence[tuple[int, Optional[int], int, int]], data: bytes, start: int
) -> tuple[LogFrame, ...]:
    return tuple(
        [
            LogFrame(bit, id, data[start + begin : start + end])
            for bit, id, begin, end in pieces
        ]
    )


def _filled(link: Link, slots: Sequence[LogBit], frames: Iterable[bytes]) -> bytes:
    layout, given = need(link.mask, "log_mask"), list(frames)
    if len(given) != len(slots):
        raise LengthError("an entry, in frames,", len(slots), len(given))
    fill, out = bytes((layout.fill,)), bytearray()
    for slot, frame in zip(slots, given):
        if len(frame) != slot.length:
            raise LengthError(slot.name or "the frame", slot.length, len(frame))
        out += frame.ljust(layout.slot_bytes, fill)
    return bytes(out)
