"""Protocol section: id ranges, names of buses and CAN packets that a receiver could not
interpret.

ICD103 checks ranges and direction bits of ids, ICD106 that a bus named in ``buses`` is
declared. ICD107 checks that a message fits a CAN packet, unless it can be segmented.
ICD107 does not apply to nodes that also have another bus. `buses` has the rules of
message types and acknowledges.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.buses import CAN, bus_link
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import (
    CAN_DATA_BYTES,
    KEYS_OF_IDS,
    TELECOMMAND,
    TELEMETRY,
    buses_of,
)
from icdgen.icd.rules.context import PATH_OF_BUSES, Context, own_fact, section_of
from icdgen.icd.rules.protocol_limits import section_in_effect
from icdgen.icd.rules.protocol_sizes import numbers
from icdgen.icd.rules.rule import rule
from icdgen.wording import count, quote


@rule("ICD103")
def id_ranges_determine_the_direction(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        ranges = {}
        for direction in (TELECOMMAND, TELEMETRY):
            section = section_of(node, "link", "ids", direction)
            ends = numbers(section, "first", "last")
            if section is None or ends is None:
                continue
            ranges[direction] = section
            if ends[0] > ends[1]:
                last, first = (ctx.written(section, key) for key in ("last", "first"))
                message = f"the last id, {last}, comes before the first, {first}"
                yield Fault.at(section, "last", message, "correct `first` or `last`")
            yield from _bit(
                own_fact(node, "link", "ids", "direction_bit"),
                section,
                direction,
                *ends,
            )
        if len(ranges) == 2:
            yield from _overlap(ranges[TELECOMMAND], ranges[TELEMETRY])


def _bit(
    bit: object, section: Map, direction: str, first: int, last: int
) -> Iterator[Fault]:
    """Yield a fault if a range has an id with the direction bit of the other direction."""
    wanted = section.get("direction")
    if (
        not isinstance(bit, int)
        or bit < 0
        or wanted not in (0, 1)
        or not 0 <= first <= last <= 255
    ):
        return
    other = next((id for id in range(first, last + 1) if id >> bit & 1 != wanted), None)
    if other is not None:
        message = f"the range contains {other}, whose bit {bit} is {1 - wanted}; in a {direction} id it is {wanted}"
        key = "first" if other == first else "last"
        yield Fault.at(
            section, key, message, "correct the range, `direction` or `direction_bit`"
        )


def _overlap(telecommands: Map, telemetry: Map) -> Iterator[Fault]:
    """Yield a fault if the ranges of ids of the two directions overlap."""
    first = max(telecommands["first"], telemetry["first"])
    last = min(telecommands["last"], telemetry["last"])
    if first <= last:
        ids = f"ids {first} to {last} are" if first < last else f"id {first} is"
        message = f"{ids} in the range of telecommands, too"
        yield Fault.at(
            telemetry, "first", message, "correct the ranges: they must not overlap"
        )


@rule("ICD106", needs_complete=True)
def named_buses_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        users = [user for user in ctx.icd.nodes if node in ctx.scope(user)]
        packets = section_of(node, "link", "packets") or unread()
        for section in (*packets.values(), section_of(node, "unsolicited_log")):
            buses = section.get("buses") if isinstance(section, Map) else None
            for bus, place in buses.placed() if isinstance(buses, Seq) else ():
                if not any(bus in buses_of(ctx.protocol_of(user)) for user in users):
                    text = f"`link: buses` has no `{bus}`"
                    help = f"add it, or remove `{bus}`"
                    yield Fault(section, place, text, help)


@rule("ICD107", needs_complete=True)
def messages_fit_their_can_packets(ctx: Context) -> Iterator[Fault]:
    seen: set[int] = set()
    for node in ctx.icd.nodes:
        can = section_in_effect(ctx, node, *PATH_OF_BUSES, "can")
        # Messages that are too long for CAN can be sent over another bus.
        if can is None or not {"uart", "i2c"}.isdisjoint(
            buses_of(ctx.protocol_of(node))
        ):
            continue
        room = can.get("max_data_bytes", CAN_DATA_BYTES)
        link = bus_link(ctx.protocol_of(node)["link"], CAN)
        has_segments = isinstance(can.get("segments"), Map)
        short = set()  # directions in which a message is one packet
        for direction in (TELECOMMAND, TELEMETRY):
            packet = link.carrying(direction)
            if packet is not None and not (has_segments and link.segment_of(packet)):
                short.add(direction)
        for message in ctx.messages_of(node):
            is_short = any(
                direction in short for _, direction in KEYS_OF_IDS[message.kind]
            )
            if is_short and message.length > room and id(message.source) not in seen:
                seen.add(id(message.source))
                text = f"{quote(message.name)} has {count(message.length, 'byte')}, but a packet has up to {room}"
                help = "correct `length`, or say how CAN sends several packets: `segments` of `can`, and a packet with `segment_of`"
                yield Fault.at(message.source, "length", text, help)
