"""UART: messages <-> a stream of bytes.

A message is the id and the data. The decoder is fed any pieces of a stream and gives events; what it gives does not
depend on how the stream was cut.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import Framing

MESSAGE = "message"
UNEXPECTED_START = "unexpected_start"  # a message began within another one, which is dropped
PROTOCOL_ERROR = "protocol_error"  # the escape byte before a byte that has no meaning there
OVERRUN = "overrun"  # a message longer than the buffer
EMPTY = "empty"  # a message without an id

REPLY, ACKNOWLEDGE, PACKET, LOG, OTHER = "reply", "acknowledge", "packet", "log", "other"


class Event(NamedTuple):
    """What the decoder found: a message, or what went wrong."""

    event: str
    message: bytes = b""


def encode(framing: Framing, message: bytes) -> bytes:
    """The bytes of a message, id first, on the line."""
    out = bytearray((framing.escape, framing.start))
    for position, byte in enumerate(message):
        if byte == framing.escape and (position or framing.escapes_id):
            out += bytes((framing.escape, framing.escaped))
        else:
            out.append(byte)
    return bytes(out) + bytes((framing.escape, framing.end))


class Decoder:
    """Finds the messages in a stream. ``limit``: bytes of the longest message, and of the buffer."""

    def __init__(self, framing: Framing, limit: int) -> None:
        self.framing, self.limit = framing, limit
        self.buffer = bytearray()
        self.inside = False
        self.escaped = False
        self.pending = 0  # bytes of the stream about which nothing is decided yet
        self.discarded = 0  # bytes of the stream that became part of no message

    def feed(self, data: bytes) -> list[Event]:
        """Takes the next bytes of the stream."""
        return [event for byte in data for event in self._byte(byte)]

    def _byte(self, byte: int) -> Iterator[Event]:
        framing = self.framing
        self.pending += 1
        if not self.inside:
            if self.escaped and byte == framing.start:
                self._start()
            else:
                self._outside(byte == framing.escape)
        elif self.escaped:
            self.escaped = False
            if byte == framing.start:
                yield Event(UNEXPECTED_START)
                self._start()
            elif byte == framing.end:
                yield from self._end()
            elif byte == framing.escaped:
                yield from self._data(framing.escape)
            elif not framing.ignores_other:
                yield Event(PROTOCOL_ERROR)
                self._outside(byte == framing.escape)
        elif byte == framing.escape and (self.buffer or framing.escapes_id):
            self.escaped = True
        else:
            yield from self._data(byte)

    def _start(self) -> None:
        self.discarded += self.pending - 2  # all but the two bytes of the start itself
        self.pending, self.inside, self.escaped = 2, True, False
        self.buffer.clear()

    def _outside(self, escaped: bool) -> None:
        """Drops what was decided to be no message; an escape byte may still begin one."""
        self.discarded += self.pending - escaped
        self.pending, self.inside, self.escaped = int(escaped), False, escaped
        self.buffer.clear()

    def _data(self, byte: int) -> Iterator[Event]:
        if len(self.buffer) == self.limit:
            yield Event(OVERRUN)
            self._outside(False)
        else:
            self.buffer.append(byte)

    def _end(self) -> Iterator[Event]:
        if self.buffer:
            yield Event(MESSAGE, bytes(self.buffer))
            self.pending = 0
        else:
            yield Event(EMPTY)
        self._outside(False)


def kind(facts: Facts, message: bytes) -> str:
    """What a message from the node is, as far as its id and its length tell."""
    id = message[0]
    log, mask = facts.log_message, facts.mask
    if log and mask and id == log.id:
        selected = mask.selected(message[log.mask_at : log.mask_at + mask.size].ljust(mask.size, b"\0"))
        return LOG if len(message) == log.frames_at + len(selected) * mask.slot_bytes else OTHER
    if facts.telemetry_ids.first <= id <= facts.telemetry_ids.last:
        return REPLY
    if facts.acknowledge and len(message) == facts.acknowledge.length:
        return ACKNOWLEDGE
    files = facts.files
    if files and id == files.packet_ids.get("uart") and len(message) == 1 + files.counter_bytes + files.packet_bytes:
        return PACKET
    return OTHER


def acknowledged(facts: Facts, message: bytes) -> tuple[int, int]:
    """Id of the telecommand and error code of an acknowledge."""
    form = need(facts.acknowledge, "uart.acknowledge")
    return message[form.id_at], message[form.error_at]
