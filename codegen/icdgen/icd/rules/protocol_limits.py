"""Protocol section: numbers that must fit their bits and bytes, and lists that need
certain parts.

ICD099 to ICD101 check segments and identifiers of CAN, ICD102 packed time.
`section_in_effect` returns the section of a node or of a file that it includes,
`roles_occur_once` checks lists of parts; other modules use both.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil

from icdgen.diagnostics import Related
from icdgen.icd.buses import CAN, bus_link
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import (
    CAN_DATA_BYTES,
    CAN_PACKETS,
    KEYS_OF_IDS,
    TELECOMMAND,
    TELEMETRY,
    Message,
    Node,
    replaced_part,
)
from icdgen.icd.rules.context import PATH_OF_BUSES, Context, own_fact, section_of
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.trees import mappings
from icdgen.wording import count, listing, quote

BYTE = 255
TIME_PARTS = ("year", "month", "day", "hour", "minute", "second")
ROLES = ("type", "channel", "source", "destination")  # parts of a CAN identifier


def section_in_effect(ctx: Context, node: Node, *path: str) -> Map | None:
    """Return the mapping at a path of the protocol section in effect for a node: its
    own, or that of an included node.
    """
    for owner in reversed(ctx.scope(node)):
        if section_of(owner, *replaced_part(path)) is not None:
            return section_of(owner, *path)
    return None


@rule("ICD099")
def packet_counter_fits_a_byte(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        can = section_in_effect(ctx, node, *PATH_OF_BUSES, "can")
        extended = section_in_effect(ctx, node, *PATH_OF_BUSES, "can", "segments")
        size = extended.get("data_bytes") if extended is not None else None
        if can is None or extended is None or not isinstance(size, int) or size < 1:
            continue
        last = extended.get("packets_left_in_last", 0)
        most = extended.get("max_packets", CAN_PACKETS)
        if not isinstance(last, int) or not isinstance(most, int):
            continue
        # Without `max_packets`, only the messages below show how many packets there
        # are.
        if ("max_packets" in extended or last > BYTE) and last + most - 1 > BYTE:
            key = "max_packets" if "max_packets" in extended else "packets_left_in_last"
            text = f"the first of {count(most, 'packet')} would count {last + most - 1} left, a byte holds {BYTE}"
            help = f"correct `packets_left_in_last`, or `max_packets`: at most {max(BYTE + 1 - last, 0)}"
            yield Fault.at(extended, key, text, help)
            continue
        for message in _extended(ctx, node, can):
            packets = ceil(message.length / size)
            if last + packets - 1 > BYTE:
                takes = f"{quote(message.name)} takes {count(packets, 'CAN packet')}"
                text = f"{takes}, the first with {last + packets - 1} left: a byte holds {BYTE}"
                help = f"{count((BYTE + 1 - last) * size, 'byte')} can be sent: correct `length` or `segments` of `can`"
                yield Fault.at(message.source, "length", text, help)


def _extended(ctx: Context, node: Node, can: Map) -> Iterator[Message]:
    """Yield the messages that are sent as several packets."""
    room = can.get("max_data_bytes", CAN_DATA_BYTES)
    link = bus_link(ctx.protocol_of(node)["link"], CAN)
    directions = {
        direction
        for direction in (TELECOMMAND, TELEMETRY)
        if link.segment_of(link.carrying(direction)) is not None
    }
    for message in ctx.messages_of(node) if isinstance(room, int) else ():
        if message.length > room and any(
            direction in directions for _, direction in KEYS_OF_IDS[message.kind]
        ):
            yield message


@rule("ICD100")
def numbers_fit_their_bits(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        yield from _on_can(ctx, node)


def _on_can(ctx: Context, node: Node) -> Iterator[Fault]:
    """Yield the faults of numbers that do not fit their part of a CAN identifier."""
    own = section_of(node, *PATH_OF_BUSES, "can")
    can = section_in_effect(ctx, node, *PATH_OF_BUSES, "can")
    bits: dict[str, int] = {}  # of each part of a CAN identifier, by role or name
    for row in mappings(can.get("identifier")) if can is not None else ():
        if isinstance(row.get("bits"), int):
            bits[str(row.get("role", row.get("name")))] = row["bits"]
    if own is not None:
        for role in ("source", "destination"):
            yield from _fits(
                ctx, own, "node_address", bits.get(role), f"a {role} address"
            )
    packets = own_fact(node, "link", "packets")
    for section in mappings([*packets.values()]) if isinstance(packets, Map) else ():
        yield from _fits(ctx, section, "type", bits.get("type"), "a message type")
    for message in ctx.messages_of(node):
        for key, _ in KEYS_OF_IDS[message.kind]:
            yield from _fits(
                ctx,
                message.source,
                key,
                bits.get("channel"),
                "the channel of a CAN identifier",
            )


def _fits(
    ctx: Context, owner: Map, key: str, bits: int | None, what: str
) -> Iterator[Fault]:
    """Yield a fault if the number of a key has more than ``bits`` bits."""
    value = owner.get(key)
    if bits is not None and isinstance(value, int) and value >= 1 << bits:
        message = f"{what} has {count(bits, 'bit')}: 0 to {(1 << bits) - 1}, not {ctx.written(owner, key)}"
        yield Fault.at(
            owner, key, message, f"correct `{key}`, or `bits` of the identifier"
        )


def roles_occur_once(
    section: Map,
    key: str,
    roles: Sequence[str],
    lacks: str,
    help: str = "give the parts their `role`",
) -> Iterator[Fault]:
    """Yield the faults of a list of parts that must have each of the ``roles`` once.

    A part without the key `role` has its name as role. The list can be absent.
    """
    if not isinstance(section.get(key), Seq):
        return
    first_with: dict[str, Map] = {}
    for row in mappings(section[key]):
        key_of_role = "role" if "role" in row else "name"
        role = row.get(key_of_role)
        # The schema check reports the part. It may be the one that is missing, so
        # nothing else is reported.
        if not isinstance(role, str):
            return
        first = first_with.setdefault(role, row)
        if role in roles and first is not row:
            other = first.at("role" if "role" in first else "name")
            here = row.at(key_of_role)
            message = f"`{role}` is given twice, here and in {line_of(other, here)}"
            remedy = f"correct the `{key_of_role}` of one part, or remove it"
            yield Fault.at(
                row,
                key_of_role,
                message,
                remedy,
                related=Related(other, f"the first `{role}`"),
            )
    missing = [f"`{role}`" for role in roles if role not in first_with]
    if missing:
        yield Fault.at(section, key, f"{lacks} {listing(missing)}", help)


@rule("ICD101")
def can_identifier_has_all_parts(ctx: Context) -> Iterator[Fault]:
    for can in ctx.sections(*PATH_OF_BUSES, "can"):
        if {"commands", "requests", "identifier"} & can.keys():
            yield from roles_occur_once(
                can, "identifier", ROLES, "the identifier has no part for"
            )


@rule("ICD102")
def packed_time_has_all_parts(ctx: Context) -> Iterator[Fault]:
    for time in ctx.sections("msdos_time"):
        help = "add all parts from `year` to `second`"
        yield from roles_occur_once(
            time, "parts", TIME_PARTS, "the packed time lacks", help
        )
