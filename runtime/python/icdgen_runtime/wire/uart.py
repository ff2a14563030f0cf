"""UART: conversion between messages and a byte stream.

A message is the id and the data. An escape byte precedes the bytes that begin and end a
message; in the data, a byte of the ICD follows each escape byte.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Literal, NamedTuple, Optional

from .._errors import LengthError
from .._hints import Buffer
from .errors import need
from .link import Framing, Link

EventName = Literal["message", "unexpected_start", "protocol_error", "overrun", "empty"]
Kind = Literal["reply", "acknowledge", "packet", "log", "other"]


class UartEvent(NamedTuple):
    """A message, or an error.

    ``unexpected_start``: a message began within another one, which is dropped.
    ``protocol_error``: an invalid byte followed the escape byte. ``overrun``: the
    message is longer than the buffer. ``empty``: it has no id.
    """

    event: EventName
    message: bytes = b""


_UNEXPECTED_START = UartEvent("unexpected_start")
_PROTOCOL_ERROR = UartEvent("protocol_error")
_OVERRUN = UartEvent("overrun")
_EMPTY = UartEvent("empty")


def uart_encode(link: Link, message: Buffer) -> bytes:
    """Encode a message, which begins with its id.

    Raise `LengthError` if it is empty.
    """
    framing, message = need(link.framing, "uart"), bytes(message)
    if not message:
        raise LengthError("a message", 1, 0)
    plain = 0 if framing.escapes_id else 1
    escape = bytes((framing.escape,))
    data = message[plain:].replace(escape, bytes((framing.escape, framing.escaped)))
    start, end = bytes((framing.escape, framing.start)), bytes((framing.end,))
    return start + message[:plain] + data + escape + end


def uart_kind(link: Link, message: bytes) -> Kind:
    """Return the kind of a message from the node, by its id and length."""
    id, log = message[0], link.log_message
    if log and link.mask and id == log.id:
        mask = message[log.mask_at : log.mask_at + link.mask.size]
        slots = link.mask.selected(mask.ljust(link.mask.size, b"\0"))
        length = log.frames_at + len(slots) * link.mask.slot_bytes
        return "log" if len(message) == length else "other"
    if link.telemetry_ids[0] <= id <= link.telemetry_ids[1]:
        return "reply"
    if len(message) == link.acknowledge_bytes:
        return "acknowledge"
    if id in link.unsolicited:
        length = 1 + link.frames[link.unsolicited[id]]
        return "packet" if len(message) == length else "other"
    return "other"


@cache
def _complete_message(framing: Framing) -> re.Pattern[bytes]:
    """Return a pattern for a complete message.

    Its groups are the id, if that is not escaped, and the remaining bytes.
    """
    escape, start, end, escaped = (
        re.escape(bytes((byte,)))
        for byte in (framing.escape, framing.start, framing.end, framing.escaped)
    )
    id = b"()" if framing.escapes_id else b"(.)"
    plain = b"[^" + escape + b"]*"
    data = plain + b"(?:" + escape + escaped + plain + b")*"
    pattern = escape + start + id + b"(" + data + b")" + escape + end
    return re.compile(pattern, re.DOTALL)


class UartDecoder:
    """Decode the messages in a byte stream, from pieces of any size.

    The buffer has ``limit`` bytes, by default the length of the longest message of the
    node.
    """

    def __init__(self, link: Link, limit: Optional[int] = None) -> None:
        self._framing = framing = need(link.framing, "uart")
        self._limit = link.longest if limit is None else limit
        self._buffer = bytearray()
        self._is_inside = False
        self._is_escaped = False
        self.discarded = 0
        """Number of received bytes that are not part of a message."""
        self.pending = 0
        """Number of received bytes that may still become part of a message."""
        escape = bytes((framing.escape,))
        self._escape = escape
        self._opening = escape + bytes((framing.start,))
        self._escaped_data = escape + bytes((framing.escaped,))
        self._complete_message = _complete_message(framing)
        # Bytes of a message on the line, with start and end, if each byte is escaped.
        self._most = 2 * self._limit + 4

    def feed(self, data: Buffer) -> list[UartEvent]:
        """Process the next bytes of the stream."""
        data = bytes(data)
        events: list[UartEvent] = []
        position = 0
        while position < len(data):
            step = self._inside if self._is_inside else self._outside
            position = step(data, position, events)
        return events

    def _outside(self, data: bytes, position: int, events: list[UartEvent]) -> int:
        """Outside of a message: advance to the next start, and past a complete message."""
        if self._is_escaped:
            if data[position] == self._framing.start:
                self._begin()
                return position + 1
            self._leave(False)
        start = data.find(self._opening, position)
        if start < 0:
            self.pending = len(data) - position
            self._leave(data[-1] == self._framing.escape)
            return len(data)
        self.discarded += start - position
        match = self._complete_message.match(data, start, start + self._most)
        if match:
            id, escaped_data = match.groups()
            if self._escape in escaped_data:
                escaped_data = escaped_data.replace(self._escaped_data, self._escape)
            message = id + escaped_data
            if 0 < len(message) <= self._limit:
                events.append(UartEvent("message", message))
                return match.end()
        self._begin()
        return start + 2

    def _inside(self, data: bytes, position: int, events: list[UartEvent]) -> int:
        """Inside a message: advance to the next escape byte, or past it."""
        if self._is_escaped:
            return self._after_escape(data, position, events)
        if self._buffer or self._framing.escapes_id:
            end = data.find(self._escape, position)
            end = len(data) if end < 0 else end
        else:  # the id, which is not escaped
            end = position + 1
        room = self._limit - len(self._buffer)
        if end - position > room:
            self.pending += room + 1
            self._drop(_OVERRUN, events)
            return position + room + 1
        is_id = not self._buffer and not self._framing.escapes_id
        self._buffer += data[position:end]
        self.pending += end - position
        if is_id or end == len(data):
            return end
        self._is_escaped = True
        self.pending += 1
        return end + 1

    def _after_escape(self, data: bytes, position: int, events: list[UartEvent]) -> int:
        """Process the byte after an escape byte inside a message."""
        framing, byte = self._framing, data[position]
        self._is_escaped = False
        self.pending += 1
        if byte == framing.start:
            events.append(_UNEXPECTED_START)
            self.discarded += self.pending - 2
            self._begin()
        elif byte == framing.end:
            if self._buffer:
                events.append(UartEvent("message", bytes(self._buffer)))
                self.pending = 0
                self._leave(False)
            else:
                self._drop(_EMPTY, events)
        elif byte == framing.escaped:
            if len(self._buffer) == self._limit:
                self._drop(_OVERRUN, events)
            else:
                self._buffer += self._escape
        elif not framing.ignores_other:
            self._drop(_PROTOCOL_ERROR, events, byte == framing.escape)
        return position + 1

    def _begin(self) -> None:
        self.pending, self._is_inside, self._is_escaped = 2, True, False
        self._buffer.clear()

    def _drop(
        self, event: UartEvent, events: list[UartEvent], is_escape: bool = False
    ) -> None:
        events.append(event)
        self._leave(is_escape)

    def _leave(self, is_escape: bool) -> None:
        """Discard the pending bytes. A last escape byte may still begin a message."""
        self.discarded += self.pending - is_escape
        self.pending, self._is_inside = int(is_escape), False
        self._is_escaped = is_escape
        self._buffer.clear()
