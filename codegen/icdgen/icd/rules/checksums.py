"""Checksums of messages: what they make of a telecommand, and where nothing would heed them."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Message, Node
from icdgen.icd.rules.context import Context, section_of
from icdgen.icd.rules.protocol_limits import in_force
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import count, quote

CAN = "can"


@rule("ICD108", whole=True)
def checksums_make_no_other_telecommand(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for other in ctx.icd.nodes:
            extra = _extra_bytes(ctx, node) or _extra_bytes(ctx, other)
            if node is other or not extra or not _share_a_line(ctx, node, other):
                continue
            longer = {m.telecommand_id: m for m in other.messages if m.telecommand_id is not None}
            for message in node.messages:
                taken = longer.get(message.telecommand_id) if message.telecommand_id is not None else None
                if taken is not None and taken.length == message.length + extra and taken.name != message.name:
                    yield _fault(ctx, node, message, other, taken)


def _fault(ctx: Context, node: Node, message: Message, other: Node, taken: Message) -> Fault:
    given = ctx.protocol_of(node).get("crc8") or ctx.protocol_of(other).get("crc8", {})
    data = "" if message.length else f", {message.telecommand_id:02X} {given.get('empty', given.get('init', 0)):02X},"
    key = "set_id" if "set_id" in message.source else "id"
    text = (
        f"{quote(message.name)} of {node.name} with its checksum{data} is {quote(taken.name)} where {other.name} runs"
    )
    help = "give one of them another id or length, or accept it in an erratum, and send this one without a checksum"
    return Fault.at(message.source, key, text, help)


def _extra_bytes(ctx: Context, node: Node) -> int:
    """Bytes that a checksum adds to telecommands of the node; 0 without one."""
    given = ctx.fact(node, "crc8", "telecommand")
    extra = given.get("extra_bytes", 1) if isinstance(given, dict) else 0
    return extra if isinstance(extra, int) else 0


def _share_a_line(ctx: Context, node: Node, other: Node) -> bool:
    """Whether both are told of by one protocol section, as programs of one device are."""
    here = {id(one) for one in ctx.scope(node) if one.protocol}
    return any(id(one) in here for one in ctx.scope(other))


@rule("ICD175", whole=True)
def checksums_are_heeded(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        uses = [use for key in ("telecommand", "telemetry") if (use := section_of(node, "crc8", key)) is not None]
        yield from _bytes(uses)
        crc8 = section_of(node, "crc8")
        users = [one for one in ctx.icd.nodes if node in ctx.scope(one)]
        telemetry = section_of(node, "crc8", "telemetry")
        if crc8 is not None and telemetry is not None and any(in_force(ctx, one, CAN) is not None for one in users):
            yield from _on_can(crc8, telemetry)


def _bytes(uses: list[Map]) -> Iterator[Fault]:
    """The checksum has the same bytes in both directions."""
    given = [(use, size) for use in uses if isinstance(size := use.get("extra_bytes"), int)]
    for use, size in given[1:]:
        if size != given[0][1]:
            message = f"the checksum adds {count(size, 'byte')} to telemetry and {given[0][1]} to telecommands"
            yield Fault.at(use, "extra_bytes", message, "a checksum has one size: make them agree")


def _on_can(crc8: Map, telemetry: Map) -> Iterator[Fault]:
    buses = telemetry.get("buses")
    if buses is None or (isinstance(buses, Seq) and CAN in buses):
        place = crc8.key_at("telemetry") if buses is None else telemetry.at("buses")
        message = "frames are read from CAN without a checksum, so that nothing would heed this one there"
        yield Fault(telemetry, place, message, "name in `buses` the others that have it: uart, i2c")
