"""Checksums of messages on buses: telecommands that a checksum turns into others.

Rule ICD108 compares the telecommands of two nodes to which the same protocol section
applies. A telecommand with its checksum can have the id and length of a longer
telecommand of the other node. `buses` and `frame_checksums` check the declarations of
checksums, `protocol` the check values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.icd.fault import Fault
from icdgen.icd.model import (
    TELECOMMAND,
    Message,
    Node,
    framed_link,
)
from icdgen.icd.packets import declared_packets
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.wording import quote


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
        for row in (
            packet.fields_of_role("checksum")
            if TELECOMMAND in packet.directions
            else ()
        ):
            return row
    return {}


def _share_a_line(ctx: Context, node: Node, other: Node) -> bool:
    """Return whether a protocol section applies to both nodes, as for several programs
    of one device.
    """
    own = {id(owner) for owner in ctx.scope(node) if owner.protocol}
    return any(id(owner) in own for owner in ctx.scope(other))
