"""Protocol section: numbers that depend on each other, and the keys of assumptions.

ICD096 reports bytes of a framing with two meanings. ICD097 compares sizes that must
agree: in CAN identifiers, CAN segments and log masks. ICD098 checks that `assumptions`,
also those of messages, name keys of the same mapping. `protocol_limits` has the numbers
that must fit a field.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Node
from icdgen.icd.rules.context import PATH_OF_BUSES, Context, own_fact
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import at_path, mappings
from icdgen.wording import count as counted

CAN_IDENTIFIER_BITS = 29  # of an extended CAN frame


def numbers(section: Map | None, *keys: str) -> tuple[int, ...] | None:
    """Return the numbers of several keys; None if one of them is absent or not a
    number.
    """
    values = tuple(at_path(section, [key]) for key in keys)
    return values if all(isinstance(value, int) for value in values) else None


def of_one_number(section: Map, *keys: str) -> Iterator[tuple[str, str, int]]:
    """Yield (earlier key, key, number) for each key with the same number as an earlier
    key.
    """
    seen: dict[int, str] = {}
    for key in keys:
        value = section.get(key)
        if isinstance(value, int) and seen.setdefault(value, key) != key:
            yield seen[value], key, value


@rule("ICD096")
def markers_differ(ctx: Context) -> Iterator[Fault]:
    for path in (("link", "framing"), (*PATH_OF_BUSES, "uart", "framing")):
        for framing in ctx.sections(*path):
            yield from _equal_markers(framing, "start", "end", "data")


def _equal_markers(section: Map, *keys: str) -> Iterator[Fault]:
    """Yield the faults of bytes with two meanings. ``keys``: start, end and data, which
    follow the escape byte.
    """
    for first, key, value in of_one_number(section, *keys):
        message = (
            f"after the escape byte 0x{value:02X} stands for both `{first}` and `{key}`"
        )
        yield Fault.at(section, key, message, "use a different byte for each")
    for _, key, value in of_one_number(section, "escape", *keys[:2]):
        # Other equal values are reported above.
        if value == section.get("escape"):
            message = f"the escape byte 0x{value:02X} is also `{key}`"
            help = "choose another byte: after a lost byte, the start of a message could not be found"
            yield Fault.at(section, key, message, help)


@rule("ICD097")
def sizes_agree(ctx: Context) -> Iterator[Fault]:
    for can in ctx.sections(*PATH_OF_BUSES, "can"):
        yield from _identifier(can)
        extended = can.get("segments")
        if isinstance(extended, Map):
            yield from _product(extended, "max_bytes", "max_packets", "data_bytes")
            yield from _packets_left(can, extended)
    for node in ctx.icd.nodes:
        yield from _log_mask(ctx, node)


def _product(section: Map, total: str, count: str, part: str) -> Iterator[Fault]:
    """Yield a fault if the number of the key ``total`` is not the product of the other
    two.
    """
    values = numbers(section, total, count, part)
    if values and values[0] != values[1] * values[2]:
        message = f"`{total}` is {values[0]}, but `{count}` times `{part}` is {values[1] * values[2]}"
        yield Fault.at(
            section, total, message, f"correct `{total}`, `{count}` or `{part}`"
        )


def _identifier(can: Map) -> Iterator[Fault]:
    """Yield a fault if the parts of a CAN identifier do not have 29 bits together."""
    parts = can.get("identifier")
    if not isinstance(parts, Seq):
        return
    widths = [part.get("bits") for part in mappings(parts)]
    valid = [width for width in widths if isinstance(width, int)]
    if len(valid) == len(widths) and sum(valid) != CAN_IDENTIFIER_BITS:
        message = f"the parts of the identifier have {sum(valid)} bits in all, not {CAN_IDENTIFIER_BITS}"
        yield Fault.at(can, "identifier", message, "correct `bits` of a part")


def _packets_left(can: Map, extended: Map) -> Iterator[Fault]:
    """Yield a fault if the byte that counts the packets left is in the data, or outside
    of the packet.
    """
    data = extended.get("data_bytes")
    left = extended.get("packets_left_byte")
    room = can.get("max_data_bytes")
    if isinstance(data, int) and isinstance(left, int) and left < data:
        message = f"byte {left} counts packets, but the data take bytes 0 to {data - 1}"
        yield Fault.at(
            extended,
            "packets_left_byte",
            message,
            f"correct it: the first byte after the data is {data}",
        )
    elif isinstance(left, int) and isinstance(room, int) and left >= room:
        message = f"byte {left} is outside a packet of {room} bytes"
        yield Fault.at(
            extended, "packets_left_byte", message, "correct it or `max_data_bytes`"
        )


def _log_mask(ctx: Context, node: Node) -> Iterator[Fault]:
    """Yield a fault if the mask in a log does not have the size of `log_mask`, which
    readers of logs use.
    """
    size = ctx.fact(node, "log_mask", "bytes")
    for path in (("telemetry_log", "header"), ("unsolicited_log", "message")):
        for row in mappings(own_fact(node, *path)) if isinstance(size, int) else ():
            given = row.get("bytes")
            if (
                row.get("role", row.get("name")) == "mask"
                and isinstance(given, int)
                and given != size
            ):
                message = (
                    f"the mask has {counted(given, 'byte')} here, {size} by `log_mask`"
                )
                yield Fault.at(row, "bytes", message, "correct one of them")


@rule("ICD098")
def assumptions_name_existing_keys(ctx: Context) -> Iterator[Fault]:
    owners = [section for node in ctx.icd.nodes for section in sections(node)]
    owners += [message.source for message, _ in ctx.messages]
    for owner in owners:
        assumptions = owner.get("assumptions")
        if not isinstance(assumptions, Map):
            continue
        for key in assumptions:
            if key == "assumptions" or key not in owner:
                message = (
                    f"`assumptions` lists `{key}`, which is not a key of this mapping"
                )
                yield Fault(
                    owner,
                    assumptions.key_at(key),
                    message,
                    "write a key whose value is assumed, and why: `reply_timeout_ms: measured`",
                )
