"""Links on buses (UART, I2C and CAN), as the ICD declares them.

A `link` without ``framing`` declares ``packets``, ``commands`` and ``requests``. Each
of its ``buses`` can override ``commands`` and ``requests``.

`icdgen.icd.rules.buses` checks them; `icdgen.protocol.reading` makes tables of them.
"""

from __future__ import annotations

from collections.abc import Mapping

from icdgen.frozen import NamedTuple
from icdgen.icd.model import TELECOMMAND, TELEMETRY
from icdgen.icd.packets import ID_ROLE, Packet, Packets, declared_packets
from icdgen.icd.responses import ACK, ID, NAK, Section, responses_in

UART, I2C, CAN = BUSES = ("uart", "i2c", "can")


class BusLink(NamedTuple):
    """Packet formats and responses of a `link` on one bus."""

    packets: Packets
    commands: Mapping[str, Section]  # responses to telecommands, by kind
    requests: Mapping[str, Section]  # responses to requests of telemetry, by kind
    reasons: Section  # of refusals, by cause

    def carrying(self, direction: str) -> Packet | None:
        """Return the packet of the messages of a direction that no packet lists; None
        without one: such messages have no format of their own.
        """
        for packet in self.packets.carrying(direction):
            if packet.messages is None and packet.name != self.packets.requesting:
                return packet
        return None

    def responding(self, response: Section | None) -> Packet | None:
        """Return the packet of a response; None without one."""
        return self.packets.by_name((response or {}).get("packet"))

    @property
    def responses(self) -> Packets:
        """Return the packets without a message in the order in which the runtimes number
        them: acknowledge, negative acknowledge, negative acknowledge of a request.

        A packet that the bus does not have is empty, to keep the numbers of the others.
        """
        rows = self.commands.get(ACK), self.commands.get(NAK), self.requests.get(NAK)
        packets = (self.responding(row) or Packet("", {}, (), ()) for row in rows)
        return self.packets._replace(all=tuple(packets))

    def segment_of(self, packet: Packet | None) -> Packet | None:
        """Return the packet with a part of a message that needs several packets; None
        without one.
        """
        for each in self.packets.all:
            if packet is not None and each.segment_of == packet.name:
                return each
        return None


def buses_with(packet: Section) -> tuple[str, ...]:
    """Return the buses on which a packet is sent: all, unless it lists some."""
    listed = packet.get("buses")
    if not isinstance(listed, list | tuple):
        return BUSES
    return tuple(bus for bus in BUSES if bus in listed)


def bus_link(link: Section, bus: str) -> BusLink:
    """Return the packet formats and responses of a `link` on a bus.

    If the bus and the link both declare a response of a kind, the bus takes precedence.
    """
    packets, buses = _mapping(link, "packets"), _mapping(link, "buses")
    section: dict[str, Section] = {
        "packets": {
            name: packet
            for name, packet in packets.items()
            if isinstance(packet, Mapping) and bus in buses_with(packet)
        }
    }
    own = _mapping(buses, bus)
    for key in ("commands", "requests"):
        if key in link or key in own:
            section[key] = {**_mapping(link, key), **_mapping(own, key)}
    commands = section.get("commands", {})
    link_on_bus = BusLink(
        declared_packets(section),
        responses_in(commands),
        responses_in(section.get("requests", {})),
        _mapping(commands, "reasons"),
    )
    return _with_ids(link_on_bus) if bus == CAN else link_on_bus


def _with_ids(link: BusLink) -> BusLink:
    """Return a link on CAN with the id, which the identifier of a packet has, in front of
    the data, and with responses that repeat it.
    """
    header = ({"at": 0, "bits": 8, "role": ID_ROLE},)
    packets = tuple(packet._replace(header=header) for packet in link.packets.all)
    commands, requests = (
        {kind: {"echo": ID, **row} for kind, row in rows.items()}
        for rows in (link.commands, link.requests)
    )
    return BusLink(link.packets._replace(all=packets), commands, requests, link.reasons)


def can_packets(link: BusLink) -> dict[str, Packet]:
    """Return the packets on CAN by what each is for, in the words of
    `icdgen.protocol.sections.CAN_KINDS`.
    """
    packets = {
        "telecommand": link.carrying(TELECOMMAND),
        "acknowledge": link.responding(link.commands.get(ACK)),
        "refusal": link.responding(link.commands.get(NAK)),
        "request": link.packets.by_name(link.packets.requesting),
        "reply": link.carrying(TELEMETRY),
        "request_refusal": link.responding(link.requests.get(NAK)),
    }
    return {kind: packet for kind, packet in packets.items() if packet is not None}


def _mapping(section: Section, key: str) -> Section:
    """Return the mapping of a key; empty for anything else, which the schema check
    reports.
    """
    value = section.get(key)
    return value if isinstance(value, Mapping) else {}
