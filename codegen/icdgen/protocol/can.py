"""CAN: messages <-> packets.

A message is split into one packet, or into several of an extended type, each of which counts the packets still to come.
The joiner takes packets in any order and from several senders at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import NamedTuple

from icdgen.protocol.errors import TooLongError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import CAN_WITH_DATA, Can

MESSAGE = "message"
DUPLICATE = "duplicate"  # a packet that was there already, dropped
INCOMPLETE = "incomplete"  # a message that was given up for want of packets
MALFORMED = "malformed"  # a packet that cannot be part of such a message
BUSY = "busy"  # more senders at once than there is room for, the packet is dropped
UNKNOWN_TYPE = "unknown_type"  # a message type that the ICD does not have


class Packet(NamedTuple):
    """A CAN frame: 29-bit identifier and data."""

    id: int
    data: bytes


class Message(NamedTuple):
    """A message: its kind, the id of the telecommand or telemetry, the addresses, the data."""

    kind: str
    id: int
    source: int
    destination: int
    data: bytes = b""


class Event(NamedTuple):
    """What the joiner found. ``id`` and ``source`` are those of the packet or message; ``missing`` of INCOMPLETE."""

    event: str
    id: int
    source: int
    message: Message | None = None
    missing: int = 0


def identifier(can: Can, **parts: int) -> int:
    """The 29-bit identifier made of its parts. Raises `ValueError` for one that does not fit."""
    value = 0
    for role, part in can.parts.items():
        if not 0 <= parts[role] < 1 << part.bits:
            raise ValueError(f"{role} takes 0 to {(1 << part.bits) - 1}, not {parts[role]}")
        value |= parts[role] << part.shift
    return value


def parts_of(can: Can, id: int) -> dict[str, int]:
    """The parts of an identifier by role."""
    return {role: id >> part.shift & (1 << part.bits) - 1 for role, part in can.parts.items()}


def split(facts: Facts, message: Message) -> list[Packet]:
    """The packets of a message, in the order in which they are sent. Raises `TooLongError`."""
    can = need(facts.can, "can")

    def packet(types: dict[str, int], data: bytes) -> Packet:
        type_ = need(types.get(message.kind), f"can: {message.kind}")
        id = identifier(can, type=type_, channel=message.id, source=message.source, destination=message.destination)
        return Packet(id, data)

    data, size = message.data, len(message.data)
    room = can.data_bytes if message.kind in CAN_WITH_DATA else 0
    if size <= room:
        return [packet(can.types, data)]
    form = can.extended
    if form is None or message.kind not in can.extended_types:
        raise TooLongError(room, size)
    if size > form.bytes:
        raise TooLongError(form.bytes, size)
    pieces = [data[at : at + form.data_bytes] for at in range(0, size, form.data_bytes)]
    width, fill = max(form.data_bytes, form.left_at), bytes([form.fill])
    lefts = range(form.left_in_last + len(pieces) - 1, form.left_in_last - 1, -1)
    filled = [piece.ljust(width, fill) + bytes([left]) for piece, left in zip(pieces, lefts, strict=True)]
    return [packet(can.extended_types, one) for one in filled]


@dataclass
class _Joining:
    """A message of several packets. ``count`` is that of all its packets."""

    key: tuple[int, int, int, int]  # type, id, source, destination
    kind: str
    count: int
    length: int | None  # of the data, where the ICD knows it
    packets: dict[int, bytes]
    last: int  # when the last packet came, ms
    in_order: int = 0  # packets 0 to run-1 came last, one after the other
    completed_by: int | None = None  # the packet that completed it

    def came(self, number: int, now: int) -> None:
        """Notes that a packet came, be it a repeated one."""
        self.last = now
        if number == self.in_order:
            self.in_order += 1
        elif number != self.in_order - 1:
            self.in_order = int(number == 0)


class Joiner:
    """Puts messages together. ``address``: whose messages (None: everybody's), ``senders``: joinings at once."""

    def __init__(self, facts: Facts, address: int | None = None, senders: int = 4) -> None:
        self.facts, self.can = facts, need(facts.can, "can")
        self.address, self.senders = address, senders
        self.room = ceil(facts.longest_data / self.can.extended.data_bytes) if self.can.extended else 0  # packets
        self.open: list[_Joining] = []

    def expire(self, now: int) -> list[Event]:
        """Gives up what has waited too long for its next packet, in the order in which the messages began."""
        form = self.can.extended
        late = [t for t in self.open if form and now - t.last >= form.packet_timeout]
        return [event for joining in late for event in self._give_up(joining)]

    def feed(self, now: int, packet: Packet) -> list[Event]:
        """Takes one packet; ``now`` in milliseconds."""
        events = self.expire(now)
        parts = parts_of(self.can, packet.id)
        type_, id, source, destination = (parts[role] for role in ("type", "channel", "source", "destination"))
        if self.address is not None and destination != self.address:
            return events
        kind = next((k for k, number in self.can.types.items() if number == type_), None)
        if kind is not None:
            if len(packet.data) > (self.can.data_bytes if kind in CAN_WITH_DATA else 0):
                return [*events, Event(MALFORMED, id, source)]
            return [*events, Event(MESSAGE, id, source, Message(kind, id, source, destination, packet.data))]
        kind = next((k for k, number in self.can.extended_types.items() if number == type_), None)
        if kind is None or self.can.extended is None:
            return [*events, Event(UNKNOWN_TYPE, id, source)]
        return events + self._extended((type_, id, source, destination), kind, packet.data, now)

    def _extended(self, key: tuple[int, int, int, int], kind: str, data: bytes, now: int) -> list[Event]:
        form = need(self.can.extended, "can.extended")
        _, id, source, destination = key
        old = next((t for t in self.open if t.key == key), None)
        if len(data) != form.left_at + 1:
            return [*self._give_up(old), Event(MALFORMED, id, source)]
        left, piece = data[form.left_at] - form.left_in_last, data[: form.data_bytes]
        length = self._length(kind, id)
        if length is not None:
            count = ceil(length / form.data_bytes)
        elif old and old.completed_by is None and left < old.count:
            count = old.count
        else:  # the first packet that comes tells how many there are
            count = left + 1
        if not 0 <= left < count <= self.room:
            return [*self._give_up(old), Event(MALFORMED, id, source)]
        number, events, kept = count - 1 - left, [], {}
        if old and (old.completed_by in (None, number)) and old.packets.get(number) == piece:
            old.came(number, now)
            return [Event(DUPLICATE, id, source)]
        # another message has begun, perhaps with the same packets as the old one up to here
        if old and (old.completed_by is not None or old.count != count or number in old.packets):
            if old.completed_by is None and number == old.in_order:
                kept = {n: old.packets[n] for n in range(number)}
            events += self._give_up(old)
            old = None
        if old is None:
            old = _Joining(key, kind, count, length, kept, now, len(kept))
            if not self._make_room(old):
                return [*events, Event(BUSY, id, source)]
        old.packets[number] = piece
        old.came(number, now)
        if len(old.packets) == old.count:
            old.completed_by = number
            joined = b"".join(old.packets[n] for n in range(old.count))[: old.length]
            events.append(Event(MESSAGE, id, source, Message(kind, id, source, destination, joined)))
        return events

    def _make_room(self, new: _Joining) -> bool:
        """Opens a joining, for which the oldest finished one makes room."""
        if len(self.open) == self.senders:
            finished = next((t for t in self.open if t.completed_by is not None), None)
            if finished is None:
                return False
            self.open.remove(finished)
        self.open.append(new)
        return True

    def _length(self, kind: str, id: int) -> int | None:
        """Bytes of the message, if the ICD knows it and it needs several packets."""
        known = (self.facts.telecommands if kind == "telecommand" else self.facts.telemetry).get(id)
        return known.length if known and known.length > self.can.data_bytes else None

    def _give_up(self, joining: _Joining | None) -> list[Event]:
        """Forgets a joining. One that is finished leaves no event: it was kept to know repeated packets."""
        if joining is None:
            return []
        self.open.remove(joining)
        if joining.completed_by is not None:
            return []
        _, id, source, _ = joining.key
        return [Event(INCOMPLETE, id, source, missing=joining.count - len(joining.packets))]
