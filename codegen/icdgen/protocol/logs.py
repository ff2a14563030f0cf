"""Telemetry logs: files, and unsolicited log messages."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from icdgen.protocol.errors import LengthError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import LogBit


class Frame(NamedTuple):
    """Frame of a log entry.

    If the ICD assigns no frame to the mask bit, ``id`` has the value None and ``data``
    is the content of the slot.
    """

    bit: int
    id: int | None
    data: bytes


class Entry(NamedTuple):
    """Entry of a log file: Unix time in seconds, milliseconds, and the frames in the
    order of the mask bits.
    """

    seconds: int
    milliseconds: int
    frames: tuple[Frame, ...]


class Log(NamedTuple):
    """Content of a log file.

    ``mask``: None for an incomplete header. ``truncated``: bytes of an incomplete
    last entry.
    """

    mask: bytes | None
    entries: list[Entry]
    truncated: int


def decode(facts: Facts, data: bytes) -> Log:
    """Return the content of a log file."""
    form, layout = need(facts.log_file, "telemetry_log"), need(facts.mask, "log_mask")
    head, body = data[: form.header_bytes], data[form.header_bytes :]
    if len(head) < form.header_bytes:
        return Log(None, [], len(data))
    mask = head[form.mask_at : form.mask_at + layout.size]
    slots = layout.selected(mask)
    # All entries have the same size: the mask of the header applies to the whole file.
    size = form.frames_at + len(slots) * layout.slot_bytes
    starts = range(0, len(body) - size + 1, size)
    return Log(
        mask,
        [_entry(facts, slots, body[at : at + size]) for at in starts],
        len(body) % size,
    )


def _entry(facts: Facts, slots: Iterable[LogBit], data: bytes) -> Entry:
    form = need(facts.log_file, "telemetry_log")
    seconds, milliseconds = (
        facts.number(data[at : at + size])
        for at, size in (form.seconds, form.milliseconds)
    )
    return Entry(seconds, milliseconds, frames(facts, slots, data[form.frames_at :]))


def frames(facts: Facts, slots: Iterable[LogBit], data: bytes) -> tuple[Frame, ...]:
    """Return the frames of the slots in ``data``."""
    size = need(facts.mask, "log_mask").slot_bytes
    return tuple(
        Frame(s.bit, s.id, data[n * size : n * size + s.length])
        for n, s in enumerate(slots)
    )


def encode(
    facts: Facts, mask: bytes, entries: Iterable[tuple[int, int, Iterable[bytes]]]
) -> bytes:
    """Return the bytes of a log file.

    ``entries``: seconds, milliseconds and the data of each frame. Raises `LengthError`
    and `OverflowError`.
    """
    form = need(facts.log_file, "telemetry_log")
    out = _head(facts, form.header_bytes, form.mask_at, mask)
    for seconds, milliseconds, data in entries:
        head = bytearray(form.frames_at)
        for (at, size), number in (
            (form.seconds, seconds),
            (form.milliseconds, milliseconds),
        ):
            head[at : at + size] = facts.bytes_of(number, size)
        out += head + _slots(facts, mask, data)
    return bytes(out)


def decode_message(facts: Facts, message: bytes) -> tuple[bytes, tuple[Frame, ...]]:
    """Return mask and frames of an unsolicited log message, which begins with its id.

    Raises `LengthError`.
    """
    form, layout = need(facts.log_message, "unsolicited_log"), need(
        facts.mask, "log_mask"
    )
    if len(message) < form.frames_at:
        raise LengthError(form.frames_at, len(message))
    mask = message[form.mask_at : form.mask_at + layout.size]
    slots = layout.selected(mask)
    expected = form.frames_at + len(slots) * layout.slot_bytes
    if len(message) != expected:
        raise LengthError(expected, len(message))
    return mask, frames(facts, slots, message[form.frames_at :])


def encode_message(facts: Facts, mask: bytes, data: Iterable[bytes]) -> bytes:
    """Return an unsolicited log message with its id.

    Raises `LengthError`.
    """
    form = need(facts.log_message, "unsolicited_log")
    out = _head(facts, form.frames_at, form.mask_at, mask)
    out[0] = form.id
    return bytes(out) + _slots(facts, mask, data)


def _head(facts: Facts, size: int, at: int, mask: bytes) -> bytearray:
    """Return ``size`` zero bytes with the mask at position ``at``."""
    expected = need(facts.mask, "log_mask").size
    if len(mask) != expected:
        raise LengthError(expected, len(mask))
    head = bytearray(size)
    head[at : at + expected] = mask
    return head


def _slots(facts: Facts, mask: bytes, data: Iterable[bytes]) -> bytes:
    layout = need(facts.mask, "log_mask")
    slots, frames_data, out = layout.selected(mask), list(data), b""
    if len(slots) != len(frames_data):
        raise LengthError(len(slots), len(frames_data))
    for slot, frame_data in zip(slots, frames_data, strict=True):
        if len(frame_data) != slot.length:
            # A short frame leaves the end of its slot unused.
            raise LengthError(slot.length, len(frame_data))
        out += frame_data.ljust(layout.slot_bytes, bytes([layout.fill]))
    return out
