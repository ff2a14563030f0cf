"""CAN: conversion between messages and packets.

A message with more data than fits into one packet is split (`can_split`) and assembled
again (`CanJoiner`).
"""

from __future__ import annotations

from typing import Literal, NamedTuple, Optional

from .._errors import RangeError
from .errors import TooLongError, need
from .link import Can, CanKind, Extended, Link

EventName = Literal[
    "message", "duplicate", "incomplete", "malformed", "busy", "unknown_type"
]
_WITH_DATA = ("telecommand", "reply")


class CanPacket(NamedTuple):
    """A CAN frame: 29-bit identifier and data."""

    id: int
    data: bytes


class CanMessage(NamedTuple):
    """A message. ``id`` is the id of the telecommand or telemetry."""

    kind: CanKind
    id: int
    source: int
    destination: int
    data: bytes = b""


class CanEvent(NamedTuple):
    """A message, or an error of the message with this id and sender.

    ``duplicate``: the packet was already received. ``incomplete``: ``missing`` packets
    did not arrive. ``malformed``: the packet cannot be part of such a message.
    ``busy``: too many senders at once. ``unknown_type``: the ICD does not define the
    message type.
    """

    event: EventName
    id: int
    source: int
    message: Optional[CanMessage] = None
    missing: int = 0


def can_split(link: Link, message: CanMessage) -> list[CanPacket]:
    """Return the packets of a message, in the order of transmission.

    Raise `TooLongError`, `RangeError` for an id or address out of range, and
    `UnsupportedError`.
    """
    can, data = need(link.can, "can"), message.data
    room = can.data_bytes if message.kind in _WITH_DATA else 0
    if len(data) <= room:
        type = need(can.types.get(message.kind), f"can: {message.kind}")
        return [CanPacket(_identifier(can, type, message), data)]
    form, extended = can.extended, can.extended_types.get(message.kind)
    if form is None or extended is None:
        raise TooLongError(room, len(data))
    if len(data) > form.bytes:
        raise TooLongError(form.bytes, len(data))
    id, fill = _identifier(can, extended, message), bytes((form.fill,))
    count = -(-len(data) // form.data_bytes)
    packets = []
    for number in range(count):
        piece = data[number * form.data_bytes :][: form.data_bytes]
        left = form.left_in_last + count - 1 - number
        packets.append(CanPacket(id, piece.ljust(form.left_at, fill) + bytes((left,))))
    return packets


def _identifier(can: Can, type: int, message: CanMessage) -> int:
    values = {
        "type": type,
        "channel": message.id,
        "source": message.source,
        "destination": message.destination,
    }
    identifier = 0
    for role, part in can.parts.items():
        value = values.get(role, 0)
        if not 0 <= value < 1 << part.bits:
            raise RangeError(role, f"0 to {(1 << part.bits) - 1}", value)
        identifier |= value << part.shift
    return identifier


class _PartialMessage:
    """Received packets of one message.

    `CanJoiner` also stores complete messages, to detect duplicate packets.
    """

    def __init__(
        self, message: CanMessage, count: int, length: Optional[int], now: float
    ) -> None:
        self.message, self.count, self.length = message, count, length
        self.last = now
        self.pieces: dict[int, bytes] = {}
        # Length of the last run of packets in order, counted from the first packet.
        self.in_order = 0
        self.completed_by: Optional[int] = None

    def record(self, position: int, now: float) -> None:
        """Record a packet, new or repeated."""
        self.last = now
        if position == self.in_order:
            self.in_order += 1
        elif position != self.in_order - 1:
            self.in_order = 0 if position else 1

    def is_duplicate(self, position: int, piece: bytes) -> bool:
        """Return whether the packet is a duplicate rather than part of another message."""
        # A sender repeats a frame after an error in its last bit, but receivers accept
        # such a frame (ISO 11898-1, frame validation). They then receive it twice.
        expected = self.completed_by in (None, position)
        return expected and self.pieces.get(position) == piece

    def is_other_message(self, position: int, count: int) -> bool:
        """Return whether the packet belongs to another message."""
        if self.completed_by is not None or self.count != count:
            return True
        return position in self.pieces


class CanJoiner:
    """Assemble messages from packets in any order and from several senders.

    ``address``: destination of the messages (None for any). ``senders``: maximum number
    of extended messages at once.
    """

    def __init__(
        self, link: Link, address: Optional[int] = None, senders: int = 4
    ) -> None:
        self._link, self._can = link, need(link.can, "can")
        self._address, self._senders = address, senders
        self._open: dict[tuple[int, int, int, int], _PartialMessage] = {}
        self._kinds: dict[int, CanKind] = {
            number: kind for kind, number in self._can.types.items()
        }
        self._extended_kinds: dict[int, CanKind] = {
            number: kind for kind, number in self._can.extended_types.items()
        }

    def expire(self, now: float) -> list[CanEvent]:
        """Drop messages whose next packet is overdue. ``now`` is in milliseconds."""
        form = self._can.extended
        if form is None or not self._open:
            return []
        late = [
            key
            for key, joining in self._open.items()
            if now - joining.last >= form.packet_timeout
        ]
        return [event for key in late for event in self._give_up(key)]

    def feed(self, now: float, packet: CanPacket) -> list[CanEvent]:
        """Process one packet. ``now`` is in milliseconds."""
        events = self.expire(now)
        type, id, source, destination = key = self._parts(packet.id)
        if self._address is not None and destination != self._address:
            return events
        kind = self._kinds.get(type)
        if kind is not None:
            room = self._can.data_bytes if kind in _WITH_DATA else 0
            if len(packet.data) > room:
                return [*events, CanEvent("malformed", id, source)]
            message = CanMessage(kind, id, source, destination, packet.data)
            return [*events, CanEvent("message", id, source, message)]
        kind, form = self._extended_kinds.get(type), self._can.extended
        if kind is None or form is None:
            return [*events, CanEvent("unknown_type", id, source)]
        head = CanMessage(kind, id, source, destination)
        return events + self._extended(now, key, head, packet.data, form)

    def _parts(self, identifier: int) -> tuple[int, int, int, int]:
        def part(role: str) -> int:
            bits, shift = self._can.parts[role]
            return identifier >> shift & (1 << bits) - 1

        return part("type"), part("channel"), part("source"), part("destination")

    def _extended(
        self,
        now: float,
        key: tuple[int, int, int, int],
        head: CanMessage,
        data: bytes,
        form: Extended,
    ) -> list[CanEvent]:
        """Process one packet of an extended message."""
        malformed = CanEvent("malformed", head.id, head.source)
        if len(data) != form.left_at + 1:
            return [*self._give_up(key), malformed]
        joining = self._open.get(key)
        left, piece = data[form.left_at] - form.left_in_last, data[: form.data_bytes]
        length = self._length(head)
        if length is not None:
            count = -(-length // form.data_bytes)
        elif joining and joining.completed_by is None and left < joining.count:
            count = joining.count
        else:  # first received packet of a message of unknown length
            count = left + 1
        most = -(-self._link.longest_data // form.data_bytes)
        if not 0 <= left < count <= most:
            return [*self._give_up(key), malformed]
        position, events = count - 1 - left, []
        pieces: dict[int, bytes] = {}
        if joining and joining.is_duplicate(position, piece):
            joining.record(position, now)
            return [CanEvent("duplicate", head.id, head.source)]
        if joining and joining.is_other_message(position, count):
            if joining.completed_by is None and position == joining.in_order:
                # The sender started again. The repeated packets, which arrived in
                # order, belong to the new message.
                pieces = {n: joining.pieces[n] for n in range(position)}
            events = self._give_up(key)
            joining = None
        if joining is None:
            if not self._make_room():
                return [*events, CanEvent("busy", head.id, head.source)]
            joining = self._open[key] = _PartialMessage(head, count, length, now)
            joining.pieces, joining.in_order = pieces, len(pieces)
        joining.pieces[position] = piece
        joining.record(position, now)
        if len(joining.pieces) == joining.count:
            joining.completed_by = position
            joined = b"".join(joining.pieces[n] for n in range(joining.count))
            message = head._replace(data=joined[: joining.length])
            events.append(CanEvent("message", head.id, head.source, message))
        return events

    def _make_room(self) -> bool:
        """Drop the oldest complete message if there are too many.

        Return whether there is room.
        """
        if len(self._open) < self._senders:
            return True
        # Incomplete messages remain: the other packets of these messages may follow.
        for key, joining in self._open.items():
            if joining.completed_by is not None:
                del self._open[key]
                return True
        return False

    def _length(self, head: CanMessage) -> Optional[int]:
        """Return the bytes of a known message that needs several packets, otherwise
        None.
        """
        if head.kind == "telecommand":
            sent = self._link.commands.get(head.id)
            length = sent.length if sent else None
        else:
            length = self._link.frames.get(head.id)
        return length if length and length > self._can.data_bytes else None

    def _give_up(self, key: tuple[int, int, int, int]) -> list[CanEvent]:
        """Drop a message. Return an event if it was incomplete."""
        joining = self._open.pop(key, None)
        if joining is None or joining.completed_by is not None:
            return []
        missing = joining.count - len(joining.pieces)
        id, source = joining.message.id, joining.message.source
        return [CanEvent("incomplete", id, source, missing=missing)]
