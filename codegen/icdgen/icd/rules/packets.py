"""Packet formats of framed links: ``packets`` and ``requests`` of `link`.

The rules check that each message has one packet (ICD184) and that constants in headers
distinguish packets (ICD185). They also check requests of telemetry (ICD186, ICD187) and
units of lengths (ICD188). `framed_links` lists the links and checks single fields,
`responses` has the responses to telecommands, `buses` the links without framing.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message
from icdgen.icd.packets import DEVICE, HOST, Packet, is_requested, value_of
from icdgen.icd.pieces import bits_of
from icdgen.icd.responses import declared_responses
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.framed_links import (
    CONSTANT_ROLES,
    DIRECTIONS,
    DeclaredLink,
    LinkPacket,
    framed_links,
    has_one_length,
    messages_in_packet,
    messages_with_ids,
)
from icdgen.icd.rules.rule import rule
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings
from icdgen.wording import count, quote


@rule("ICD184")
def messages_have_one_packet(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        packets = link.section.get("packets")
        if not isinstance(packets, Map):
            continue
        yield from _lists(ctx, link, packets)
        for direction in DIRECTIONS:
            for _, message in messages_with_ids(ctx, link.node, direction):
                yield from _packet_of(link, message, direction)


def _lists(ctx: Context, link: DeclaredLink, packets: Map) -> Iterator[Fault]:
    """Yield the faults of the messages that packets list."""
    listed: dict[tuple[str, str], str] = {}
    broken = ctx.broken_messages(link.node)
    for packet in link.declared.all:
        section = packets[packet.name]
        if "reserved" in section and packet.name not in link.declared.responding:
            text = f"the packet {quote(packet.name)} carries messages or requests, so `reserved` has no effect"
            help = "remove it; the reserved bytes of a request are `requests: reserved`"
            yield Fault.at_key(section, "reserved", text, help)
        names = section.get("messages")
        sent: set[str] = set()
        for direction in packet.directions:
            messages = messages_with_ids(ctx, link.node, direction)
            sent.update(message.name for _, message in messages)
        for name, place in names.placed() if isinstance(names, Seq) else ():
            if not isinstance(name, str) or name in broken:
                continue
            if name not in sent:
                text = f"the node has no message {quote(name)} in the direction of the packet {quote(packet.name)}"
                remedy = suggestion(name, sent, "correct the name, or `from`")
                yield Fault.of_place(packets[packet.name], place, text, *remedy)
            for direction in packet.directions:
                other = listed.setdefault((direction, name), packet.name)
                if other != packet.name:
                    text = f"{quote(name)} is in the packet {quote(other)} already"
                    help = "list it in one packet"
                    yield Fault(packets[packet.name], place, text, help)


def _packet_of(link: DeclaredLink, message: Message, direction: str) -> Iterator[Fault]:
    """Yield the fault of a message that is in no packet, or in one of several."""
    packets = link.declared.packets_of_message(message.name, direction)
    if len(packets) == 1 or any(packet.messages for packet in packets):
        return
    what = f"{direction} {quote(message.name)}"
    if packets:
        names = " or ".join(quote(packet.name) for packet in packets)
        text = f"nothing says whether the {what} is sent in the packet {names}"
        help = "list the messages of one of them in `messages`"
    else:
        text = f"no packet carries the {what}"
        help = f"add a packet of the {'host' if direction == TELECOMMAND else 'device'}, or list the message in one"
    yield Fault.at(message.source, "name", text, help)


@rule("ICD185")
def packets_can_be_distinguished(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        for direction in DIRECTIONS:
            packets = [
                packet
                for packet in link.packets
                if direction in packet.declared.directions
            ]
            for first, second in combinations(packets, 2):
                if _precedes(link, first, second, direction):
                    name, other = first.declared.name, second.declared.name
                    text = f"{quote(other)} is received as {quote(name)}, which precedes it and has no other constants"
                    help = f"give them different constants in the header, or move {quote(other)} in front if its constants are more"
                    yield Fault.at(*link.place(second), text, help)
                    break


def _precedes(
    link: DeclaredLink, first: LinkPacket, second: LinkPacket, direction: str
) -> bool:
    """Return whether every packet of the second format also has the constants of the
    first.
    """
    bits = _constant_bits(link, second, direction)
    return all(
        bits.get(place) == value
        for place, value in _constant_bits(link, first, direction).items()
    )


def _constant_bits(
    link: DeclaredLink, packet: LinkPacket, direction: str
) -> dict[int, int]:
    """Return the constant bits of a header, by their place in it."""
    bits: dict[int, int] = {}
    for part, row in packet.fields_by_part:
        if part != "header" or row["role"] not in CONSTANT_ROLES:
            continue
        order = row.get("byte_order", link.node.byte_order)
        value = value_of(row, direction, order == "little")
        places = bits_of(row["at"], row["bits"], order, link.node.bit_order)
        bits.update((place, value >> bit & 1) for bit, place in enumerate(places))
    return bits


@rule("ICD186")
def telemetry_can_be_requested(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        requests = link.section.get("requests")
        telemetry = messages_with_ids(ctx, link.node, TELEMETRY)
        if not isinstance(requests, Map):
            for _, message in telemetry:
                if "requested" in message.source:
                    text = (
                        "`requested` has an effect on links with `link: requests` only"
                    )
                    yield Fault.at_key(message.source, "requested", text, "remove it")
            continue
        name = link.declared.requesting
        packet = link.declared.by_name(name)
        if packet is None:
            names = [each.name for each in link.declared.all if each.name]
            if isinstance(name, str):
                text = f"there is no packet {quote(name)}"
                yield Fault.at(
                    requests, "packet", text, *suggestion(name, names, "correct it")
                )
            else:
                text = "nothing says which packet of the host requests telemetry"
                help = "add `packet:` with its name"
                yield Fault.at_key(link.section, "requests", text, help)
            continue
        owner, key = (
            (requests, "packet") if "packet" in requests else (link.section, "requests")
        )
        if TELECOMMAND not in packet.directions:
            text = f"the device sends the packet {quote(packet.name)}, and a request comes from the host"
            yield Fault.at_key(owner, key, text, f"name a packet `from: {HOST}`")
        elif not packet.fields_of_role("id"):
            text = "the packet has no field with the role `id`, so a request could not say what it requests"
            yield Fault.at_key(owner, key, text, "add one, or name another packet")
        elif "response" not in requests:  # otherwise ICD187
            ids = [id for id, _ in messages_with_ids(ctx, link.node, TELECOMMAND)]
            if telemetry and not any(
                is_requested(link.declared, message, ids, ())
                for _, message in telemetry
            ):
                text = "no telemetry can be requested: its packets have no id, or telecommands have the same ids"
                help = "remove `requests`, or correct the packets"
                yield Fault.at_key(link.section, "requests", text, help)


@rule("ICD187")
def requested_telemetry_is_recognized(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        requests = link.section.get("requests")
        if not isinstance(requests, Map) or not isinstance(
            requests.get("response"), str
        ):
            continue
        name = requests["response"]
        packet = link.declared.by_name(name)
        if packet is None:
            names = [each.name for each in link.declared.all if each.name]
            text = f"there is no packet {quote(name)}"
            remedy = suggestion(name, names, "add it to `packets`")
            yield Fault.at(requests, "response", text, *remedy)
        elif TELEMETRY not in packet.directions:
            text = f"the host sends the packet {quote(name)}, and a response comes from the device"
            yield Fault.at(
                requests, "response", text, f"name a packet `from: {DEVICE}`"
            )
        elif packet.fields_of_role("id"):
            text = f"the packet {quote(name)} has an id, which says what telemetry it carries"
            yield Fault.at(requests, "response", text, "remove `response`")
        elif name in link.declared.responding:
            text = f"the packet {quote(name)} is a response without a message already"
            help = "name another packet, which carries the telemetry"
            yield Fault.at(requests, "response", text, help)
        elif link.declared.by_name(link.declared.requesting) is not None:
            yield from _nameless(ctx, link, requests, packet)


def _nameless(
    ctx: Context, link: DeclaredLink, requests: Map, packet: Packet
) -> Iterator[Fault]:
    """Yield the faults of telemetry in a packet without id.

    The host can identify such telemetry only by the request that it sent before.
    """
    telecommands = messages_with_ids(ctx, link.node, TELECOMMAND)
    ids = [id for id, _ in telecommands]
    commands = link.section.get("commands")
    commands = commands if isinstance(commands, Map) else {}
    # Telemetry that responds to a telecommand, with the telecommand.
    responding: dict[str, Message] = {}
    for _, message in telecommands:
        for row in declared_responses(commands, message).values():
            if isinstance(row.get("message"), str):
                responding[row["message"]] = message
    where = f"is sent in the packet {quote(packet.name)}, which does not say what it carries"
    carried = [
        message for _, message in messages_in_packet(ctx, link, packet, TELEMETRY)
    ]
    for message in carried:
        if message.name in responding:
            telecommand = quote(responding[message.name].name)
            text = f"{quote(message.name)} responds to {telecommand} and {where}"
            help = "list it in another packet, or let a packet respond"
            yield Fault.at(message.source, "name", text, help)
        elif not is_requested(link.declared, message, ids, ()):
            text = f"{quote(message.name)} {where}, and cannot be requested"
            help = "let it be requested, or list it in another packet"
            yield Fault.at(message.source, "name", text, help)
    if not carried:
        text = f"no telemetry is sent in the packet {quote(packet.name)}"
        help = "remove `response`, or correct the packets"
        yield Fault.at(requests, "response", text, help)
    for row in mappings(packet.fields_of_role("checksum")):
        declared = link.checksums.get(row.get("checksum", ""))
        if isinstance(declared, Map) and "seeds" in declared:
            text = "the checksum has a seed for each message, and the packet does not say which message it carries"
            yield Fault.at(row, "checksum", text, "remove `seeds`, or add an id")


@rule("ICD188")
def lengths_are_whole_units(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        reported: set[int] = set()
        for packet in link.packets:
            for row in packet.fields_with_roles("length", "response_length"):
                if id(row) in reported:
                    continue
                for fault in _units(ctx, link, packet, row):
                    reported.add(id(row))
                    yield fault
                    break


def _units(
    ctx: Context, link: DeclaredLink, packet: LinkPacket, row: Map
) -> Iterator[Fault]:
    """Yield the faults of a length that cannot be counted in its unit."""
    unit, around = row.get("unit", 1), 0
    messages: list[Message] = []
    for direction in packet.declared.directions:
        carried = messages_in_packet(ctx, link, packet.declared, direction)
        messages += (message for _, message in carried)
    is_of_response = row["role"] == "response_length"
    if is_of_response:
        if packet.declared.name != link.declared.requesting or messages:
            text = "a `response_length` is in a packet that only requests telemetry"
            help = "name the packet in `requests: packet`, and let another one carry telecommands"
            yield Fault.at(row, "role", text, help)
            return
        ids = [id for id, _ in messages_with_ids(ctx, link.node, TELECOMMAND)]
        messages = [
            message
            for _, message in messages_with_ids(ctx, link.node, TELEMETRY)
            if is_requested(link.declared, message, ids, ())
        ]
    elif unit == 1:
        return
    else:
        around = packet.overhead if row.get("counts") == "message" else 0
        reserved = link.declared.reserved_in(packet.declared)
        if not messages and (reserved + around) % unit:
            text = _not_a_multiple(reserved + around, unit)
            yield Fault.at(row, "unit", text, "correct `unit` or `reserved`")
    sizes: dict[tuple[str, int], int] = {}
    for message in messages:
        what = quote(message.name)
        id_of = next(
            id
            for id in (message.telemetry_id, message.telecommand_id)
            if id is not None
        )
        first = sizes.setdefault((message.kind, id_of), message.length)
        number = (message.length + around) // unit
        if not has_one_length(message) or first != message.length:
            text = f"{what} has no fixed length, which the {row['role']} needs"
            help = "let the message have a fixed length, or remove `unit`"
        elif (message.length + around) % unit:
            text = _not_a_multiple(message.length + around, unit, what)
            help = "correct `unit`, or the length of the message"
        elif is_of_response and number >> row["bits"]:
            text = f"a length of {count(row['bits'], 'bit')} does not hold {number}, that of {what}"
            help = "make the field wider, or the message shorter"
        else:
            continue
        yield Fault.at(row, "unit" if "unit" in row else "role", text, help)


def _not_a_multiple(size: int, unit: int, message: str = "") -> str:
    """Return the text about the bytes of a message, or of a packet without a message."""
    what = f"the {count(size, 'byte')} of {message}" if message else count(size, "byte")
    return f"{what} {'is' if size == 1 else 'are'} not a multiple of the unit {unit}"
