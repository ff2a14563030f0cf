"""Checksums of messages on buses: telecommands that a checksum turns into others.

Rule ICD108 compares the telecommands of two nodes to which the same protocol section
applies. A telecommand with its checksum can have the id and length of a longer
telecommand of the other node. `buses` and `frame_checksums` check the declarations of
checksums, `protocol` the check values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.icd import checksum
from icdgen.icd.fault import Fault
from icdgen.icd.model import (
    TELECOMMAND,
    Message,
    Node,
    framed_link,
)
from icdgen.icd.packets import ID_ROLE, declared_packets
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import at_path
from icdgen.wording import quote

# Parameters of a CRC, in the order of `icdgen.icd.checksum.crc`.
_PARAMETERS = ("width", "polynomial", "init", "reflect_in", "reflect_out", "xor_out")


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
    data = "" if message.length else _shown_data(ctx, node, other, message)
    key = "set_id" if "set_id" in message.source else "id"
    sent = f"{quote(message.name)} of {node.name} with its checksum{data}"
    help = "give one of them another id or length, or accept it in an erratum, and send this one without a checksum"
    return Fault.at(
        message.source,
        key,
        f"{sent} is {quote(longer.name)} where {other.name} runs",
        help,
    )


def _shown_data(ctx: Context, node: Node, other: Node, message: Message) -> str:
    """Return the bytes of a message without data, with its checksum; empty if the
    checksum is not declared, which ICD173 reports.
    """
    sender = node if _of_telecommands(ctx, node) else other
    row, id = _of_telecommands(ctx, sender), message.telecommand_id or 0
    declared = ctx.fact(sender, "link", "checksums", row.get("checksum", ""))
    if not isinstance(declared, Mapping) or declared.get("kind") != checksum.CRC:
        return ""
    covers_id = at_path(row, ("covers", "from")) == ID_ROLE
    if "empty" in declared and not covers_id:
        value = declared["empty"]
    else:
        covered = bytes([id]) if covers_id else b""
        value = checksum.crc(covered, *(declared[key] for key in _PARAMETERS))
    digits = 2 * _extra_bytes(ctx, sender)
    return f", {id:02X} {value:0{digits}X},"


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
