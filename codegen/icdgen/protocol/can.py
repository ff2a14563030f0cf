"""Splitting of messages into CAN packets and joining of packets to messages.

A message fits into one packet, or it is split into several packets of an extended type.
Each of these carries the number of packets that follow. The joiner accepts packets in
any order and from several senders at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import NamedTuple

from icdgen.protocol.errors import TooLongError
from icdgen.protocol.facts import Facts, need
from icdgen.protocol.sections import CAN_WITH_DATA, Can

MESSAGE = "message"
# Events of `Joiner`.
DUPLICATE = "duplicate"  # packet was received before; dropped
INCOMPLETE = "incomplete"  # packets of a message did not arrive in time; dropped
MALFORMED = "malformed"  # packet that cannot belong to such a message
BUSY = "busy"  # too many senders at once; packet dropped
UNKNOWN_TYPE = "unknown_type"  # message type that the ICD does not define


class Packet(NamedTuple):
    """CAN frame: 29-bit identifier and data."""

    id: int
    data: bytes


class Message(NamedTuple):
    """Message of one CAN kind with the id of its telecommand or telemetry, its
    addresses and its data.
    """

    kind: str
    id: int
    source: int
    destination: int
    data: bytes = b""


class Event(NamedTuple):
    """Event of the joiner.

    ``id`` and ``source`` belong to the packet or message. ``missing`` counts the
    packets that did not arrive (INCOMPLETE only).
    """

    event: str
    id: int
    source: int
    message: Message | None = None
    missing: int = 0


def identifier(can: Can, **parts: int) -> int:
    """Return the 29-bit identifier composed of its parts.

    Raises `ValueError` if a part does not fit its bits.
    """
    value = 0
    for role, part in can.parts.items():
        if not 0 <= parts[role] < 1 << part.bits:
            raise ValueError(
                f"{role} takes 0 to {(1 << part.bits) - 1}, not {parts[role]}"
            )
        value |= parts[role] << part.shift
    return value


def parts_of(can: Can, id: int) -> dict[str, int]:
    """Return the parts of an identifier by role."""
    return {
        role: id >> part.shift & (1 << part.bits) - 1
        for role, part in can.parts.items()
    }


def split(facts: Facts, message: Message) -> list[Packet]:
    """Return the packets of a message in sending order.

    Raises `TooLongError` if the message does not fit its kind.
    """
    can = need(facts.can, "can")

    def packet(types: dict[str, int], data: bytes) -> Packet:
        type_ = need(types.get(message.kind), f"can: {message.kind}")
        id = identifier(
            can,
            type=type_,
            channel=message.id,
            source=message.source,
            destination=message.destination,
        )
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
    # The counter byte has a fixed position, which may lie behind the data bytes of a
    # packet.
    width, fill = max(form.data_bytes, form.left_at), bytes([form.fill])
    packets_left = range(form.left_in_last + len(pieces) - 1, form.left_in_last - 1, -1)
    filled = [
        piece.ljust(width, fill) + bytes([count])
        for piece, count in zip(pieces, packets_left, strict=True)
    ]
    return [packet(can.extended_types, data) for data in filled]


@dataclass
class _PartialMessage:
    """Message of several packets that is being received."""

    key: tuple[int, int, int, int]  # type, id, source, destination
    kind: str
    count: int  # packets of the whole message
    length: int | None  # of the data in bytes; None if the ICD does not define it
    packets: dict[int, bytes]
    last: int  # time of the last packet in ms
    # Length of the last uninterrupted run of packets from packet 0 on
    in_order: int = 0
    completed_by: int | None = None  # number of the packet that completed the message

    def record_packet(self, number: int, now: int) -> None:
        """Record the arrival of a packet, repeated packets included."""
        self.last = now
        if number == self.in_order:
            self.in_order += 1
        elif number != self.in_order - 1:
            self.in_order = int(number == 0)


class Joiner:
    """Reassembly of messages from packets.

    ``address``: destination whose messages are joined (None: all). ``senders``: number
    of messages that can be under reassembly at once.
    """

    def __init__(
        self, facts: Facts, address: int | None = None, senders: int = 4
    ) -> None:
        self.facts, self.can = facts, need(facts.can, "can")
        self.address, self.senders = address, senders
        # In packets
        self.room = (
            ceil(facts.longest_data / self.can.extended.data_bytes)
            if self.can.extended
            else 0
        )
        self.open: list[_PartialMessage] = []

    def expire(self, now: int) -> list[Event]:
        """Discard messages whose next packet is overdue, in the order in which they
        began.
        """
        form = self.can.extended
        overdue = [
            message
            for message in self.open
            if form and now - message.last >= form.packet_timeout
        ]
        return [event for message in overdue for event in self._give_up(message)]

    def feed(self, now: int, packet: Packet) -> list[Event]:
        """Process one packet; ``now`` in milliseconds."""
        events = self.expire(now)
        parts = parts_of(self.can, packet.id)
        type_, id, source, destination = (
            parts[role] for role in ("type", "channel", "source", "destination")
        )
        # Packets for other receivers are no errors.
        if self.address is not None and destination != self.address:
            return events
        kind = next(
            (k for k, number in self.can.types.items() if number == type_), None
        )
        if kind is not None:
            if len(packet.data) > (self.can.data_bytes if kind in CAN_WITH_DATA else 0):
                return [*events, Event(MALFORMED, id, source)]
            return [
                *events,
                Event(
                    MESSAGE,
                    id,
                    source,
                    Message(kind, id, source, destination, packet.data),
                ),
            ]
        kind = next(
            (k for k, number in self.can.extended_types.items() if number == type_),
            None,
        )
        if kind is None or self.can.extended is None:
            return [*events, Event(UNKNOWN_TYPE, id, source)]
        return events + self._extended(
            (type_, id, source, destination), kind, packet.data, now
        )

    def _extended(
        self, key: tuple[int, int, int, int], kind: str, data: bytes, now: int
    ) -> list[Event]:
        form = need(self.can.extended, "can.extended")
        _, id, source, destination = key
        pending = next((message for message in self.open if message.key == key), None)
        # The counter is the last byte of an extended packet.
        if len(data) != form.left_at + 1:
            return [*self._give_up(pending), Event(MALFORMED, id, source)]
        left, piece = data[form.left_at] - form.left_in_last, data[: form.data_bytes]
        length = self._length(kind, id)
        if length is not None:
            count = ceil(length / form.data_bytes)
        elif pending and pending.completed_by is None and left < pending.count:
            count = pending.count
        else:  # the first packet that arrives fixes the number of packets
            count = left + 1
        if not 0 <= left < count <= self.room:
            return [*self._give_up(pending), Event(MALFORMED, id, source)]
        number, events, retained = count - 1 - left, [], {}
        # A repeated packet is a duplicate as long as it cannot begin the next message.
        if (
            pending
            and (pending.completed_by in (None, number))
            and pending.packets.get(number) == piece
        ):
            pending.record_packet(number, now)
            return [Event(DUPLICATE, id, source)]
        # Another message has begun. Its packets so far may equal those of the pending
        # message:
        if pending and (
            pending.completed_by is not None
            or pending.count != count
            or number in pending.packets
        ):
            # They are not sent again, so they must be retained.
            if pending.completed_by is None and number == pending.in_order:
                retained = {n: pending.packets[n] for n in range(number)}
            events += self._give_up(pending)
            pending = None
        if pending is None:
            pending = _PartialMessage(
                key, kind, count, length, retained, now, len(retained)
            )
            if not self._make_room(pending):
                return [*events, Event(BUSY, id, source)]
        pending.packets[number] = piece
        pending.record_packet(number, now)
        if len(pending.packets) == pending.count:
            pending.completed_by = number
            joined = b"".join(pending.packets[n] for n in range(pending.count))[
                : pending.length
            ]
            events.append(
                Event(
                    MESSAGE, id, source, Message(kind, id, source, destination, joined)
                )
            )
        return events

    def _make_room(self, new: _PartialMessage) -> bool:
        """Add a message under reassembly; the oldest complete message makes room for
        it. Return whether there is room.
        """
        if len(self.open) == self.senders:
            finished = next(
                (message for message in self.open if message.completed_by is not None),
                None,
            )
            if finished is None:
                return False
            self.open.remove(finished)
        self.open.append(new)
        return True

    def _length(self, kind: str, id: int) -> int | None:
        """Return the data length of a message of several packets; None if the ICD does
        not define it.
        """
        message = (
            self.facts.telecommands if kind == "telecommand" else self.facts.telemetry
        ).get(id)
        return (
            message.length if message and message.length > self.can.data_bytes else None
        )

    def _give_up(self, message: _PartialMessage | None) -> list[Event]:
        """Remove a message under reassembly.

        A complete message is only retained to recognize repeated packets; its removal
        is no event.
        """
        if message is None:
            return []
        self.open.remove(message)
        if message.completed_by is not None:
            return []
        _, id, source, _ = message.key
        return [
            Event(INCOMPLETE, id, source, missing=message.count - len(message.packets))
        ]
