"""Packet formats of a link on the page of its protocol: fields, sender and content.

`packet_views` returns one view per format, and `packet_urls` the links to them. Fields
and boxes come from `icdgen.backends.html.packet_formats`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from icdgen.backends.html import packet_formats
from icdgen.backends.html.links import free_name, slug
from icdgen.backends.html.relations import PageLink, Relations
from icdgen.frozen import NamedTuple
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message, Node, framed_link
from icdgen.icd.packets import BOTH, DEVICE, HOST, Packet, Packets, declared_packets
from icdgen.icd.responses import declared_responses, responses_in
from icdgen.protocol.packet_formats import (
    NOTHING,
    REQUEST,
    REQUESTED,
    PacketFormat,
    Stream,
)
from icdgen.wording import count

_SENDERS = {HOST: "host", DEVICE: "device", BOTH: "host and device"}


class PacketContent(NamedTuple):
    """Something that a packet carries, in words, with links to the messages."""

    label: str
    text: str
    messages: list[PageLink]


class PacketView(NamedTuple):
    """Packet format as its page shows it.

    ``name`` and ``contents`` are empty if the link has one format.
    """

    name: str
    anchor: str
    summary: str
    contents: list[PacketContent]
    boxes: list[tuple[str, str, float, str]]
    places: list[packet_formats.FormatField]


def packet_views(relations: Relations, node: Node, stream: Stream) -> list[PacketView]:
    """Return the packet formats of a link, in the order of the ICD."""
    packets, urls = _declared_packets(relations, node), packet_urls(relations, node)
    enum_urls = {
        enum.name: relations.links.enum(enum)
        for owner in (*relations.icd.included(node), node)
        for enum in owner.enums
    }
    views = []
    for packet, form in zip(packets.all, stream.packets, strict=True):
        summary, contents = "", list[PacketContent]()
        # A link with one format has no name for it: its section is the page itself.
        if packet.name:
            summary = packet.section.get("summary", "")
            contents = _contents(relations, node, packets, packet, form, stream)
        views.append(
            PacketView(
                packet.name,
                urls[packet.name].partition("#")[2],
                summary,
                contents,
                packet_formats.packet_boxes(packet, form),
                packet_formats.format_fields(packet, enum_urls),
            )
        )
    return views


def packet_urls(relations: Relations, node: Node) -> dict[str, str]:
    """Return the links to the packet formats of a framed link, by name; the name is
    empty if there is one.
    """
    if not framed_link(relations.icd.protocol_of(node)):
        return {}
    page, taken = relations.links.protocol(node.name), set[str]()
    return {
        packet.name: f"{page}#{_anchor(packet.name, node, taken)}"
        for packet in _declared_packets(relations, node).all
    }


def _anchor(packet: str, node: Node, taken: set[str]) -> str:
    if not packet:
        return "packets"
    return free_name(f"packet-{slug(packet, node.vocabulary)}", taken)


def _section(relations: Relations, node: Node) -> Mapping[str, Any]:
    """Return the `link` of a node; empty without one."""
    section: Mapping[str, Any] = relations.icd.protocol_of(node).get("link", {})
    return section


def _declared_packets(relations: Relations, node: Node) -> Packets:
    messages = relations.icd.messages_of(node)
    return declared_packets(_section(relations, node), messages)


def _contents(
    relations: Relations,
    node: Node,
    packets: Packets,
    packet: Packet,
    form: PacketFormat,
    stream: Stream,
) -> list[PacketContent]:
    """Return the sender of a packet, and what it carries."""
    messages = relations.icd.messages_of(node)
    contents = [PacketContent("Sent by", _SENDERS[packet.section["from"]], [])]
    # A packet without message responds to telecommands or to requests.
    if form.content == NOTHING:
        section = _section(relations, node)
        refused = _responded_to(section.get("commands", {}), messages, packet.name)
        rows = responses_in(section.get("requests", {})).values()
        is_of_request = any(row.get("packet") == packet.name for row in rows)
        text = "requests of telemetry" if is_of_request else ""
        return [
            *contents,
            PacketContent("Carries", "no message", []),
            PacketContent("Responds to", text, [*map(relations.place, refused)]),
        ]
    carried = [
        relations.place(message)
        for message in messages
        if form.content != REQUEST and packet in _packets_of(packets, message)
    ]
    if carried:
        # The receiver knows from its request which telemetry this is.
        is_nameless = form.content == REQUESTED
        text = "the requested telemetry, without its id" if is_nameless else ""
        contents.append(PacketContent("Carries", text, carried))
    if packet.name == packets.requesting:
        ids = {row.id for row in stream.telemetry if row.is_requested}
        requested = [
            relations.place(each) for each in messages if each.telemetry_id in ids
        ]
        reserved = form.reserved
        text = f"with {count(reserved, 'byte')} of zeros as data" if reserved else ""
        contents.append(PacketContent("Requests", text, requested))
    return contents


def _packets_of(packets: Packets, message: Message) -> list[Packet]:
    """Return the packets in which a message is sent."""
    ids = {TELECOMMAND: message.telecommand_id, TELEMETRY: message.telemetry_id}
    return [
        packet
        for direction, id in ids.items()
        if id is not None
        for packet in packets.packets_of_message(message.name, direction)
    ]


def _responded_to(
    commands: Mapping[str, Any], messages: Iterable[Message], packet: str
) -> Iterator[Message]:
    """Yield the telecommands to which a packet responds."""
    for message in messages:
        rows = declared_responses(commands, message).values()
        if message.telecommand_id is not None and any(
            row.get("packet") == packet for row in rows
        ):
            yield message
