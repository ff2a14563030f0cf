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
    form, layout = need(facts.log_file, "telemetry_log"), need(facts.mask, "log_mask")
    head, rest = data[: form.header_bytes], data[form.header_bytes :]
    if len(head) < form.header_bytes:
        return Log(None, [], len(data))
    mask = head[form.mask_at : form.mask_at + layout.size]
    slots = layout.selected(mask)
    size = form.frames_at + len(slots) * layout.slot_bytes
    starts = range(0, len(rest) - size + 1, size)
    return Log(mask, [_entry(facts, slots, rest[at : at + size]) for at in starts], len(rest) % size)


def _entry(facts: Facts, slots: Iterable[LogBit], data: bytes) -> Entry:
    form = need(facts.log_file, "telemetry_log")
    seconds, milliseconds = (facts.number(data[at : at + size]) for at, size in (form.seconds, form.milliseconds))
    return Entry(seconds, milliseconds, frames(facts, slots, data[form.frames_at :]))


def frames(facts: Facts, slots: Iterable[LogBit], data: bytes) -> tuple[Frame, ...]:
    """The frames in the slots, which fill ``data``."""
    size = need(facts.mask, "log_mask").slot_bytes
    return tuple(Frame(s.bit, s.id, data[n * size : n * size + s.length]) for n, s in enumerate(slots))


def encode(facts: Facts, mask: bytes, entries: Iterable[tuple[int, int, Iterable[bytes]]]) -> bytes:
    """A log file. An entry is seconds, milliseconds and the data of each frame. Raises `LengthError`, `OverflowError`."""
    form = need(facts.log_file, "telemetry_log")
    out = _head(facts, form.header_bytes, form.mask_at, mask)
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
    out = _head(facts, form.frames_at, form.mask_at, mask)
    out[0] = form.id
    return bytes(out) + _slots(facts, mask, data)


def _head(facts: Facts, size: int, at: int, mask: bytes) -> bytearray:
    """So many bytes, with the mask at its place."""
    expected = need(facts.mask, "log_mask").size
    if len(mask) != expected:
        raise LengthError(expected, len(mask))
    head = bytearray(size)
    head[at : at + expected] = mask
    return head


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
