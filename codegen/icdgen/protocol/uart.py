"""Framing of messages on the UART: encoder, decoder and classification.

A message consists of id and data. The decoder accepts pieces of a stream of any size;
its events do not depend on the sizes.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import Framing

# Events of `Decoder`.
MESSAGE = "message"
# Message began within another one, which is discarded
UNEXPECTED_START = "unexpected_start"
PROTOCOL_ERROR = "protocol_error"  # escape byte before an undefined byte
OVERRUN = "overrun"  # a message longer than the buffer
EMPTY = "empty"  # a message without an id

REPLY, ACKNOWLEDGE, PACKET, LOG, OTHER = (
    "reply",
    "acknowledge",
    "packet",
    "log",
    "other",
)


class Event(NamedTuple):
    """Event of the decoder: a message or an error."""

    event: str
    message: bytes = b""


def encode(framing: Framing, message: bytes) -> bytes:
    """Return the transmitted bytes of a message, which begins with its id."""
    out = bytearray((framing.escape, framing.start))
    # Some devices do not escape the id (`escaped_in: [data]`).
    for position, byte in enumerate(message):
        if byte == framing.escape and (position or framing.escapes_id):
            out += bytes((framing.escape, framing.escaped))
        else:
            out.append(byte)
    return bytes(out) + bytes((framing.escape, framing.end))


class Decoder:
    """Decoder of a stream.

    ``limit``: bytes of the longest message, and size of the buffer.
    """

    def __init__(self, framing: Framing, limit: int) -> None:
        self.framing, self.limit = framing, limit
        self.buffer = bytearray()
        self.inside = False
        self.escaped = False
        self.pending = 0  # number of bytes not yet assigned to a message or discarded
        self.discarded = 0  # number of bytes outside of messages

    def feed(self, data: bytes) -> list[Event]:
        """Process the next bytes of the stream."""
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
        # An unescaped id is the first byte of the buffer.
        elif byte == framing.escape and (self.buffer or framing.escapes_id):
            self.escaped = True
        else:
            yield from self._data(byte)

    def _start(self) -> None:
        self.discarded += self.pending - 2  # all but the two bytes of the start itself
        self.pending, self.inside, self.escaped = 2, True, False
        self.buffer.clear()

    def _outside(self, escaped: bool) -> None:
        """Discard pending bytes that are no message.

        An escape byte may still begin one.
        """
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
    """Classify a message of the node by its id and length."""
    id = message[0]
    log, mask = facts.log_message, facts.mask
    if log and mask and id == log.id:
        selected = mask.selected(
            message[log.mask_at : log.mask_at + mask.size].ljust(mask.size, b"\0")
        )
        return (
            LOG
            if len(message) == log.frames_at + len(selected) * mask.slot_bytes
            else OTHER
        )
    if facts.telemetry_ids.first <= id <= facts.telemetry_ids.last:
        return REPLY
    if facts.acknowledge and len(message) == facts.acknowledge.length:
        return ACKNOWLEDGE
    files = facts.files
    if (
        files
        and id == files.packet_ids.get("uart")
        and len(message) == 1 + files.counter_bytes + files.packet_bytes
    ):
        return PACKET
    return OTHER


def acknowledged(facts: Facts, message: bytes) -> tuple[int, int]:
    """Return the id of the telecommand and the error code of an acknowledge."""
    form = need(facts.acknowledge, "uart.acknowledge")
    return message[form.id_at], message[form.error_at]
