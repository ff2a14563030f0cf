"""Framing of `link` by escape characters.

Rule ICD196 reports keys of ``framing`` that have no effect. Without `start`, the first
byte of a packet follows the escape byte. The rule therefore computes this byte for each
packet and id, and reports bytes that have another meaning there. ICD096 in
`protocol_sizes` reports equal characters.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.packets import id_shifts, value_of
from icdgen.icd.pieces import bits_of
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.framed_links import (
    CONSTANT_ROLES,
    DIRECTIONS,
    DeclaredLink,
    LinkPacket,
    framed_links,
    messages_in_packet,
    messages_with_ids,
)
from icdgen.icd.rules.rule import rule
from icdgen.wording import quote

_KEYS = ("escape", "start", "end", "data", "other")  # only for `by: escape`


@rule("ICD196")
def escape_characters_fit(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        framing = link.section.get("framing")
        if not isinstance(framing, Map):
            continue
        if link.framing != "escape":
            for key in _KEYS:
                if key in framing:
                    text = f"`{key}` has no effect without `by: escape`"
                    help = "remove it, or correct `by`"
                    yield Fault.at_key(framing, key, text, help)
        elif "start" not in framing:
            if "other" in framing:
                text = "`other` has no effect without `start`, because every other byte begins a packet"
                yield Fault.at_key(framing, "other", text, "remove it, or add `start`")
            yield from _first_bytes(ctx, link, framing)


def _first_bytes(ctx: Context, link: DeclaredLink, framing: Map) -> Iterator[Fault]:
    """Yield the faults of packets whose first byte has another meaning after the escape
    byte.
    """
    # A packet begins after the escape byte. There the receiver takes these bytes as an
    # escaped data byte or as the end of a packet, and not as its first byte.
    reserved = [framing.get(key) for key in ("escape", "end", "data")]
    for packet in link.packets:
        place = link.place(packet)
        # Each id and each constant can give another first byte, so all of them are
        # tried.
        for direction, id, name in _contents(ctx, link, packet):
            byte = _first_byte(link, packet, direction, id)
            if byte is None:
                text = f"without `start`, the first byte{packet.of_packet or ' of packets'} must be an id or a constant"
                help = "begin `header` with one of 8 bits, or add `start` to `framing`"
                yield Fault.at(*place, text, help)
                break
            if byte in reserved:
                text = f"without `start`, no packet can begin with 0x{byte:02X}, as that of {name} does"
                help = "add `start` to `framing`, or correct its bytes, the id or the constant"
                yield Fault.at(*place, text, help)
                break


def _contents(
    ctx: Context, link: DeclaredLink, packet: LinkPacket
) -> Iterator[tuple[str, int, str]]:
    """Yield direction, id and name of what a packet can contain."""
    for direction in packet.declared.directions:
        carried = [
            (id, quote(message.name))
            for id, message in messages_in_packet(ctx, link, packet.declared, direction)
        ]
        # A packet without messages can have the id of any.
        if not carried:
            for each in DIRECTIONS:
                messages = messages_with_ids(ctx, link.node, each)
                carried += ((id, quote(message.name)) for id, message in messages)
        for id, name in carried or [(0, "each message")]:
            yield direction, id, name


def _first_byte(
    link: DeclaredLink, packet: LinkPacket, direction: str, id: int
) -> int | None:
    """Return the first byte of a packet; None if it is not only ids and constants."""
    shifts = (
        shift for _, shift in id_shifts([row for _, row in packet.fields_by_part])
    )
    order, byte, determined = link.node.bit_order, 0, 0
    for part, row in packet.fields_by_part:
        row_order: str = row.get("byte_order", link.node.byte_order)
        if row["role"] == "id":
            # An id can have several parts, the most significant bits first.
            value = id >> next(shifts)
        elif row["role"] in CONSTANT_ROLES:
            value = value_of(row, direction, row_order == "little")
        else:
            continue
        places = bits_of(row["at"], row["bits"], row_order, order)
        for bit, place in enumerate(places):
            if part == "header" and place < 8:
                shift = place if order == "lsb0" else 7 - place
                # `places` counts bits in the bit order of the node.
                byte |= (value >> bit & 1) << shift
                determined |= 1 << shift
    return byte if determined == 0xFF else None
