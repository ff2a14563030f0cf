"""Checksums of messages: what they make of a telecommand, and where nothing would heed them."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.model import Message, Node
from icdgen.icd.rules.context import Context, own_fact, section_of
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
    sent = f"{quote(message.name)} of {node.name} with its checksum{data}"
    help = "give one of them another id or length, or accept it in an erratum, and send this one without a checksum"
    return Fault.at(message.source, key, f"{sent} is {quote(taken.name)} where {other.name} runs", help)


def _extra_bytes(ctx: Context, node: Node) -> int:
    """Bytes that a checksum adds to telecommands of the node; 0 without one."""
    given = ctx.fact(node, "crc8", "telecommand")
    extra: int = 0 if given is None else given.get("extra_bytes", 1)
    return extra


def _share_a_line(ctx: Context, node: Node, other: Node) -> bool:
    """Whether both are told of by one protocol section, as programs of one device are."""
    here = {id(one) for one in ctx.scope(node) if one.protocol}
    return any(id(one) in here for one in ctx.scope(other))


@rule("ICD175", whole=True)
def checksums_are_heeded(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        telemetry = section_of(node, "crc8", "telemetry")
        if telemetry is None:
            continue
        size, other = telemetry.get("extra_bytes"), own_fact(node, "crc8", "telecommand", "extra_bytes")
        if size is not None and other is not None and size != other:
            message = f"the checksum adds {count(size, 'byte')} to telemetry and {other} to telecommands"
            yield Fault.at(telemetry, "extra_bytes", message, "a checksum has one size: correct one of the two")
        speak_can = any(CAN in ctx.protocol_of(one) for one in ctx.icd.nodes if node in ctx.scope(one))
        if speak_can and CAN in telemetry.get("buses", (CAN,)):
            crc8 = node.source["protocol"]["crc8"]
            place = telemetry.at("buses") if "buses" in telemetry else crc8.key_at("telemetry")
            message = "frames on CAN have no checksum, so this one has no effect there"
            help = (
                "remove `can` from `buses`"
                if "buses" in telemetry
                else "add `buses`, with the links that have a checksum"
            )
            yield Fault(telemetry, place, message, help)
