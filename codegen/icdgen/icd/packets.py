"""Packet formats of a framed link, as the ICD declares them: ``packets`` of a `link`,
or its ``header`` and ``trailer`` alone.

`icdgen.icd.rules.packets` checks them; `icdgen.protocol.framed_links` makes tables of
them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message
from icdgen.icd.responses import Section, declared_responses, responses_in

HOST, DEVICE, BOTH = "host", "device", "both"
SENDERS = {HOST: (TELECOMMAND,), DEVICE: (TELEMETRY,), BOTH: (TELECOMMAND, TELEMETRY)}
"""Value of ``from`` -> directions of a packet."""

ID_ROLE = "id"


class Packet(NamedTuple):
    """Packet format as the ICD declares it.

    ``name`` is empty if the link has one format for both directions.
    """

    name: str
    section: Section
    header: Sequence[Section]
    trailer: Sequence[Section]

    @property
    def directions(self) -> tuple[str, ...]:
        """Return the directions in which the packet is sent."""
        sender = self.section.get("from", BOTH)
        return SENDERS.get(sender, ()) if isinstance(sender, str) else ()

    @property
    def messages(self) -> Sequence[str] | None:
        """Return the names of the messages that are listed; None without a list."""
        names = self.section.get("messages")
        return names if isinstance(names, list | tuple) else None

    @property
    def segment_of(self) -> object:
        """Return the name of the packet whose message this is a part of; None for a
        whole message.
        """
        return self.section.get("segment_of")

    @property
    def reserved(self) -> int:
        """Return the bytes of data without meaning, in a packet without a message."""
        reserved: int = self.section.get("reserved", 0)
        return reserved

    @property
    def rows(self) -> list[Section]:
        """Return the fields of header and trailer."""
        return [*self.header, *self.trailer]

    def fields_of_role(self, role: str) -> list[Section]:
        """Return the fields of a role."""
        return [row for row in self.rows if row.get("role") == role]

    def named(self, name: str) -> Section | None:
        """Return the first field with a name or role; None without one."""
        for row in self.rows:
            if name in (row.get("name"), row.get("role")):
                return row
        return None


class Packets(NamedTuple):
    """Packet formats of a link, and what each carries."""

    all: tuple[Packet, ...]
    responding: frozenset[str]  # packets without a message, named by responses
    requesting: str | None  # packet by which telemetry is requested; None without
    requested_bytes: int = 0  # bytes of data of a request of telemetry
    # Packet without id that carries the telemetry that was requested; None without
    answering: str | None = None

    def number_of(self, name: object) -> int | None:
        """Return the number of a packet; None if there is no such packet."""
        names = [packet.name for packet in self.all]
        return names.index(name) if isinstance(name, str) and name in names else None

    def by_name(self, name: object) -> Packet | None:
        """Return a packet by its name; None if there is no such packet."""
        number = self.number_of(name)
        return None if number is None else self.all[number]

    def carrying(self, direction: str) -> list[Packet]:
        """Return the packets with messages of a direction.

        Packets that only respond, only request telemetry, or carry a part of a long
        message are excluded.
        """
        return [
            packet
            for packet in self.all
            if direction in packet.directions
            and packet.name not in self.responding
            and packet.segment_of is None
            and not (direction == TELECOMMAND and self.only_requests(packet))
        ]

    def only_requests(self, packet: Packet) -> bool:
        """Return whether telecommands have packets of their own."""
        return packet.name == self.requesting and any(
            TELECOMMAND in other.directions
            and other.name not in (self.requesting, *self.responding)
            for other in self.all
        )

    def reserved_in(self, packet: Packet) -> int:
        """Return the bytes of data of a packet if it has no message."""
        is_of_request = packet.name == self.requesting
        return self.requested_bytes if is_of_request else packet.reserved

    def packets_of_message(self, message: str, direction: str) -> list[Packet]:
        """Return the packets in which a message can be sent: packets that list the
        message, or else packets without a list of messages.
        """
        carrying = self.carrying(direction)
        listed = [packet for packet in carrying if message in (packet.messages or ())]
        return listed or [packet for packet in carrying if packet.messages is None]


def declared_packets(link: Section, messages: Iterable[Message] = ()) -> Packets:
    """Return the packet formats of a `link`.

    ``messages`` are the messages of the node. Their responses can name packets.
    """
    own = link.get("packets")
    header, trailer = (_fields(link.get(part)) for part in ("header", "trailer"))
    if not isinstance(own, Mapping):
        packets = [Packet("", link, header, trailer)]
    else:
        packets = []
        for name, row in own.items():
            if not isinstance(row, Mapping):
                continue
            # A packet without a header or trailer of its own has that of the link.
            own_header = _fields(row["header"]) if "header" in row else header
            own_trailer = _fields(row["trailer"]) if "trailer" in row else trailer
            packets.append(Packet(name, row, own_header, own_trailer))
    requests = link.get("requests")
    requesting, requested_bytes, answering = None, 0, None
    if isinstance(requests, Mapping):
        requested_bytes = requests.get("reserved", 0)
        from_host = [each for each in packets if TELECOMMAND in each.directions]
        only = from_host[0].name if len(from_host) == 1 else None
        name = requests.get("packet", only)
        requesting = name if isinstance(name, str) else None
        # Rule ICD186 reports another packet.
        from_device = [each.name for each in packets if TELEMETRY in each.directions]
        answering = next(
            (each for each in from_device if each == requests.get("response")), None
        )
    responses = _responses(link, messages)
    named = [row.get("packet") for row in responses]  # may be no text
    # The other ones that responses name are mistakes, which rule ICD176 reports.
    responding = {
        packet.name
        for packet in packets
        if packet.name in named
        and packet.messages is None
        and TELEMETRY in packet.directions
    }
    return Packets(
        tuple(packets), frozenset(responding), requesting, requested_bytes, answering
    )


def place_fields(link: object) -> None:
    """Give fields of headers and trailers that have no position the end of the field in
    front of them.

    ``link``: the section of an ICD, or anything else, which the schema check reports.
    """
    packets = link.get("packets") if isinstance(link, Mapping) else None
    own = packets.values() if isinstance(packets, Mapping) else ()
    for section in (each for each in (link, *own) if isinstance(each, Mapping)):
        for part in ("header", "trailer"):
            end = 0
            for row in _fields(section.get(part)):
                # In the tree itself, so that rules and tables of the link read the same
                # positions.
                at, bits = row.setdefault("at", end), row.get("bits")
                # Not `isinstance`, because `true` is an `int` in Python.
                if type(at) is int and type(bits) is int:
                    end = at + bits


def _fields(rows: object) -> list[Any]:
    """Return the fields of a header or trailer; the schema check reports the others."""
    fields = rows if isinstance(rows, list | tuple) else ()
    return [row for row in fields if isinstance(row, Mapping)]


def _responses(link: Section, messages: Iterable[Message]) -> Iterator[Section]:
    """Yield all responses of a link."""
    commands = link.get("commands", {})
    for section in (commands, link.get("requests", {})):
        if isinstance(section, Mapping):
            yield from responses_in(section).values()
    for message in messages:
        if isinstance(commands, Mapping) and message.telecommand_id is not None:
            yield from declared_responses(commands, message).values()


def value_of(row: Section, direction: str, is_little: bool) -> int:
    """Return the value of a constant, or the default of another field, in a direction.

    A list of bytes is in the order of transmission.
    """
    value = row.get("value", 0)
    if isinstance(value, Mapping):
        value = value.get(direction, 0)
    if isinstance(value, list):
        return int.from_bytes(bytes(value), "little" if is_little else "big")
    number: int = value
    return number


def id_shifts(rows: Sequence[Section]) -> Iterator[tuple[Section, int]]:
    """Yield the fields of the id, and how far the id is shifted right to give each: the
    first has the most significant bits.
    """
    parts = [row for row in rows if row.get("role") == ID_ROLE]
    left = sum(row["bits"] for row in parts)
    for row in parts:
        left -= row["bits"]
        yield row, left


def is_requested(
    packets: Packets,
    message: Message,
    telecommand_ids: Iterable[int],
    excluded_ids: Iterable[int],
) -> bool:
    """Return whether telemetry can be requested by the packet of ``requests``.

    ``telecommand_ids``: ids of all telecommands. ``excluded_ids``: ids of the telemetry
    that a telecommand requests, or that only responds.
    """
    id, requesting = message.telemetry_id, packets.requesting
    packet = packets.by_name(requesting)
    if packet is None or id is None or not message.requested or id in excluded_ids:
        return False
    sent_in = packets.packets_of_message(message.name, TELEMETRY)
    if packets.answering is None:
        is_recognized = any(each.fields_of_role(ID_ROLE) for each in sent_in)
    else:
        is_recognized = any(each.name == packets.answering for each in sent_in)
    # A telecommand in the same packet has the id for itself.
    is_free = packets.only_requests(packet) or id not in telecommand_ids
    return is_recognized and is_free and bool(packet.fields_of_role(ID_ROLE))
