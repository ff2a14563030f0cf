"""Checksums of messages: telecommands that a checksum turns into others, and checksums
without effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

from icdgen.icd import checksum
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import (
    TELECOMMAND,
    TELEMETRY,
    Message,
    Node,
    buses_of,
    framed_link,
)
from icdgen.icd.packets import ID_ROLE, declared_packets
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.envelopes import DATA, links, links_on_buses
from icdgen.icd.rules.protocol_effects import NAMES_OF_BUSES
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import mappings
from icdgen.wording import quote

CAN = "can"


@rule("ICD108", needs_complete=True)
def ids_and_checksums_form_no_other_telecommand(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for other in ctx.icd.nodes:
            extra = _extra_bytes(ctx, node) or _extra_bytes(ctx, other)
            if node is other or not extra or not _share_a_line(ctx, node, other):
                continue
            # With its checksum, a telecommand has the length of one with as many more
            # bytes of data.
            by_id = {
                each.telecommand_id: each
                for each in other.messages
                if each.telecommand_id is not None
            }
            for message in node.messages:
                longer = (
                    by_id.get(message.telecommand_id)
                    if message.telecommand_id is not None
                    else None
                )
                if (
                    longer is not None
                    and longer.length == message.length + extra
                    and longer.name != message.name
                ):
                    yield _fault(ctx, node, message, other, longer)


def _fault(
    ctx: Context, node: Node, message: Message, other: Node, longer: Message
) -> Fault:
    """Return the fault of a message that, with its checksum, equals the ``longer``
    message of another node.
    """
    given = next(
        ctx.fact(each, "link", "checksums", row.get("checksum", ""))
        for each in (node, other)
        if (row := _of_telecommands(ctx, each))
    )
    data = (
        ""
        if message.length
        else f", {message.telecommand_id:02X} {given.get('empty', given.get('init', 0)):02X},"
    )
    key = "set_id" if "set_id" in message.source else "id"
    sent = f"{quote(message.name)} of {node.name} with its checksum{data}"
    help = "give one of them another id or length, or accept it in an erratum, and send this one without a checksum"
    return Fault.at(
        message.source,
        key,
        f"{sent} is {quote(longer.name)} where {other.name} runs",
        help,
    )


def _extra_bytes(ctx: Context, node: Node) -> int:
    """Return the bytes that a checksum adds to telecommands of a node; 0 without a
    checksum.
    """
    bits: object = _of_telecommands(ctx, node).get("bits")
    return bits // 8 if isinstance(bits, int) else 0


def _of_telecommands(ctx: Context, node: Node) -> Mapping[str, Any]:
    """Return the field with the checksum of telecommands on buses; empty without one."""
    protocol = ctx.protocol_of(node)
    link = protocol.get("link")
    if not isinstance(link, Mapping) or framed_link(protocol):
        return {}
    for packet in declared_packets(link).all:
        for row in packet.of("checksum") if TELECOMMAND in packet.directions else ():
            return row
    return {}


def _share_a_line(ctx: Context, node: Node, other: Node) -> bool:
    """Return whether a protocol section applies to both nodes, as for several programs
    of one device.
    """
    own = {id(owner) for owner in ctx.scope(node) if owner.protocol}
    return any(id(owner) in own for owner in ctx.scope(other))


# Keys of a packet on buses, and of its checksum, that have an effect. The position of
# the checksum follows from the data.
ON_BUSES = ("source", "from", "buses", "trailer", "summary", "assumptions")
OF_CHECKSUM = ("at", "bits", "role", "name", "checksum", "covers", "optional", "summary")  # fmt: skip
# Keys that only packets on buses have.
ONLY_ON_BUSES = ("buses", "optional")


@rule("ICD175", needs_complete=True)
def packets_on_buses_have_an_effect(ctx: Context) -> Iterator[Fault]:
    for link in links(ctx):
        packets = link.section.get("packets")
        own = [*packets.values()] if isinstance(packets, Map) else []
        for section in (*mappings(own), *(row for _, row in link.rows)):
            for key in ONLY_ON_BUSES:
                if key in section:
                    text = f"`{key}` has no effect on framed links"
                    yield Fault.at_key(section, key, text, "remove it")
    for link in links_on_buses(ctx):
        sections = link.section.get("packets")
        if not isinstance(sections, Map):
            continue
        taken: dict[tuple[str, str], str] = {}
        first: Map | None = None
        for packet in link.declared.all:
            section = sections[packet.name]
            yield from _unused_keys(section)
            for direction, bus in product(packet.directions, _buses(section)):
                other = taken.setdefault((direction, bus), packet.name)
                if other != packet.name:
                    text = f"{direction} on `{bus}` is in the packet {quote(other)} already"
                    help = "leave out the bus, or one of the packets"
                    yield Fault.at(section, "from", text, help)
                elif (direction, bus) == (TELEMETRY, CAN) and _uses_can(ctx, link.node):
                    yield _on_can(section)
            for row in mappings(section.get("trailer")):
                if row.get("role") != "checksum":
                    text = "on buses, nothing but a checksum is sent behind the data"
                    yield Fault.at(row, "role", text, "remove the field")
                    continue
                yield from _field(ctx, link.node, row)
                first = row if first is None else first
                yield from _differences(row, first)


def _unused_keys(section: Map) -> Iterator[Fault]:
    """Yield the faults of the keys of a packet that have no effect on buses."""
    for key in section:
        if key not in ON_BUSES:
            text = f"`{key}` has no effect on buses, where a message is its id and its data"
            yield Fault.at_key(section, key, text, "remove it")
    if "trailer" not in section:
        text = "the packet adds nothing to the id and the data"
        yield Fault.at(section, "from", text, "add a `trailer`, or remove the packet")


def _buses(section: Map) -> list[str]:
    """Return the buses on which a packet is sent."""
    buses = section.get("buses")
    return [bus for bus in NAMES_OF_BUSES if not isinstance(buses, Seq) or bus in buses]


def _uses_can(ctx: Context, node: Node) -> bool:
    """Return whether a node, or one that includes it, is on CAN."""
    return any(CAN in buses_of(ctx.protocol_of(user)) for user in ctx.users(node))


def _on_can(section: Map) -> Fault:
    """Return the fault of a checksum of telemetry on CAN."""
    message = "frames on CAN have no checksum, so the checksum of telemetry has no effect there"
    if "buses" in section:
        return Fault.at(section, "buses", message, "remove `can` from `buses`")
    help = "add `buses`, with the links that have a checksum"
    return Fault.at(section, "from", message, help)


def _field(ctx: Context, node: Node, row: Map) -> Iterator[Fault]:
    """Yield the faults of a checksum that buses cannot have."""
    for key in row:
        if key not in OF_CHECKSUM:
            text = f"`{key}` has no effect on buses"
            yield Fault.at_key(row, key, text, "remove it")
    if isinstance(bits := row.get("bits"), int) and bits % 8:
        text = "on buses, a checksum has whole bytes"
        yield Fault.at(row, "bits", text, "correct `bits` and `width`")
    covers = row.get("covers")
    bounds = (covers.get("from"), covers.get("to")) if isinstance(covers, Map) else ()
    if bounds not in ((ID_ROLE, DATA), (DATA, DATA)):
        text = "on buses, a checksum covers the data, or id and data"
        help = "write `covers: {from: data, to: data}`, or `from: id`"
        yield Fault.at(row, "covers" if "covers" in row else "role", text, help)
    declared = ctx.fact(node, "link", "checksums", str(row.get("checksum")))
    if isinstance(declared, Mapping) and declared.get("kind") != checksum.CRC:
        yield Fault.at(row, "checksum", "on buses, a checksum is a CRC", "name a CRC")
    elif isinstance(declared, Mapping) and "seeds" in declared:
        text = "`seeds` have no effect on buses"
        yield Fault.at(row, "checksum", text, "name a checksum without `seeds`")


def _differences(row: Map, first: Map) -> Iterator[Fault]:
    """Yield the faults of a checksum that is not that of the first packet."""
    for key in ("checksum", "bits", "covers"):
        if row.get(key) != first.get(key):
            text = (
                f"`{key}` is not that of the other packets, and a node has one checksum"
            )
            help = f"give all packets the same `{key}`"
            yield Fault.at(row, key if key in row else "role", text, help)
            return
