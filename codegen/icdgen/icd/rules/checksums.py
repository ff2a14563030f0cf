"""Checksums of messages: telecommands that a checksum turns into others, and checksums
without effect.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.model import Message, Node, buses_of
from icdgen.icd.rules.context import Context, own_fact, section_of
from icdgen.icd.rules.rule import rule
from icdgen.wording import count, quote

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
    given = ctx.protocol_of(node).get("crc8") or ctx.protocol_of(other).get("crc8", {})
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
    given = ctx.fact(node, "crc8", "telecommand")
    extra: int = 0 if given is None else given.get("extra_bytes", 1)
    return extra


def _share_a_line(ctx: Context, node: Node, other: Node) -> bool:
    """Return whether a protocol section applies to both nodes, as for several programs
    of one device.
    """
    own = {id(owner) for owner in ctx.scope(node) if owner.protocol}
    return any(id(owner) in own for owner in ctx.scope(other))


@rule("ICD175", needs_complete=True)
def checksums_have_an_effect(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        telemetry = section_of(node, "crc8", "telemetry")
        if telemetry is None:
            continue
        size, other = (
            telemetry.get("extra_bytes"),
            own_fact(node, "crc8", "telecommand", "extra_bytes"),
        )
        if size is not None and other is not None and size != other:
            message = f"the checksum adds {count(size, 'byte')} to telemetry and {other} to telecommands"
            yield Fault.at(
                telemetry,
                "extra_bytes",
                message,
                "a checksum has one size: correct one of the two",
            )
        uses_can = any(
            CAN in buses_of(ctx.protocol_of(user))
            for user in ctx.icd.nodes
            if node in ctx.scope(user)
        )
        if uses_can and CAN in telemetry.get("buses", (CAN,)):
            crc8 = node.source["protocol"]["crc8"]
            place = (
                telemetry.at("buses")
                if "buses" in telemetry
                else crc8.key_at("telemetry")
            )
            message = "frames on CAN have no checksum, so the checksum of telemetry has no effect there"
            help = (
                "remove `can` from `buses`"
                if "buses" in telemetry
                else "add `buses`, with the links that have a checksum"
            )
            yield Fault(telemetry, place, message, help)
