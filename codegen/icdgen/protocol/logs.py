"""Telemetry logs: the file form and the unsolicited form."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from icdgen.protocol.errors import LengthError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import LogBit


class Frame(NamedTuple):
    """One frame of an entry. ``id`` is None where the ICD assigns no frame to the bit; ``data`` is the slot then."""

    bit: int
    id: int | None
    data: bytes


class Entry(NamedTuple):
    """An entry of a log file: Unix time and milliseconds, and the frames in the order of the mask bits."""

    seconds: int
    milliseconds: int
    frames: tuple[Frame, ...]


class Log(NamedTuple):
    """A log file. ``mask`` is None if the header is incomplete; ``truncated``: bytes of an incomplete last part."""

    mask: bytes | None
    entries: list[Entry]
    truncated: int


def decode(facts: Facts, data: bytes) -> Log:
    """What a log file holds."""
    reader = Reader(facts)
    entries = reader.feed(data)
    return Log(reader.mask, entries, reader.truncated)


class Reader:
    """Reads a log file in pieces of any size."""

    def __init__(self, facts: Facts) -> None:
        self.facts, self.form, self.layout = facts, need(facts.log_file, "telemetry_log"), need(facts.mask, "log_mask")
        self.mask: bytes | None = None
        self.slots: list[LogBit] = []
        self.buffer = b""

    @property
    def entry_bytes(self) -> int:
        return self.form.frames_at + len(self.slots) * self.layout.slot_bytes

    @property
    def truncated(self) -> int:
        """At the end of the file: bytes that belong to no whole entry."""
        return len(self.buffer)

    def feed(self, data: bytes) -> list[Entry]:
        """The entries that are complete now."""
        self.buffer += data
        entries = []
        if self.mask is None and len(self.buffer) >= self.form.header_bytes:
            self.mask = self.buffer[self.form.mask_at : self.form.mask_at + self.layout.size]
            self.slots = self.layout.selected(self.mask)
            self.buffer = self.buffer[self.form.header_bytes :]
        while self.mask is not None and len(self.buffer) >= self.entry_bytes:
            entries.append(self._entry(self.buffer[: self.entry_bytes]))
            self.buffer = self.buffer[self.entry_bytes :]
        return entries

    def _entry(self, data: bytes) -> Entry:
        (seconds, size), (milliseconds, rest) = self.form.seconds, self.form.milliseconds
        return Entry(
            self.facts.number(data[seconds : seconds + size]),
            self.facts.number(data[milliseconds : milliseconds + rest]),
            frames(self.facts, self.slots, data[self.form.frames_at :]),
        )


def frames(facts: Facts, slots: Iterable[LogBit], data: bytes) -> tuple[Frame, ...]:
    """The frames in the slots, which fill ``data``."""
    size = need(facts.mask, "log_mask").slot_bytes
    return tuple(Frame(s.bit, s.id, data[n * size : n * size + s.length]) for n, s in enumerate(slots))


def encode(facts: Facts, mask: bytes, entries: Iterable[tuple[int, int, Iterable[bytes]]]) -> bytes:
    """A log file. An entry is seconds, milliseconds and the data of each frame. Raises `LengthError`, `OverflowError`."""
    form = need(facts.log_file, "telemetry_log")
    out = bytearray(form.header_bytes)
    out[form.mask_at : form.mask_at + len(_mask(facts, mask))] = mask
    for seconds, milliseconds, data in entries:
        head = bytearray(form.frames_at)
        for (at, size), number in ((form.seconds, seconds), (form.milliseconds, milliseconds)):
            head[at : at + size] = facts.bytes_of(number, size)
        out += head + _slots(facts, mask, data)
    return bytes(out)


def decode_message(facts: Facts, message: bytes) -> tuple[bytes, tuple[Frame, ...]]:
    """Mask and frames of an unsolicited log message, which begins with its id. Raises `LengthError`."""
    form, layout = need(facts.log_message, "unsolicited_log"), need(facts.mask, "log_mask")
    if len(message) < form.frames_at:
        raise LengthError(form.frames_at, len(message))
    mask = message[form.mask_at : form.mask_at + layout.size]
    slots = layout.selected(mask)
    whole = form.frames_at + len(slots) * layout.slot_bytes
    if len(message) != whole:
        raise LengthError(whole, len(message))
    return mask, frames(facts, slots, message[form.frames_at :])


def encode_message(facts: Facts, mask: bytes, data: Iterable[bytes]) -> bytes:
    """An unsolicited log message with its id. Raises `LengthError`."""
    form = need(facts.log_message, "unsolicited_log")
    out = bytearray(form.frames_at)
    out[0] = form.id
    out[form.mask_at : form.mask_at + len(_mask(facts, mask))] = mask
    return bytes(out) + _slots(facts, mask, data)


def _mask(facts: Facts, mask: bytes) -> bytes:
    layout = need(facts.mask, "log_mask")
    if len(mask) != layout.size:
        raise LengthError(layout.size, len(mask))
    return mask


def _slots(facts: Facts, mask: bytes, data: Iterable[bytes]) -> bytes:
    layout = need(facts.mask, "log_mask")
    slots, given, out = layout.selected(mask), list(data), b""
    if len(slots) != len(given):
        raise LengthError(len(slots), len(given))
    for slot, one in zip(slots, given, strict=True):
        if len(one) != slot.length:
            raise LengthError(slot.length, len(one))
        out += one.ljust(layout.slot_bytes, bytes([layout.fill]))
    return out
