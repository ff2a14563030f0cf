"""Words of the `procedures` of an ICD, which rules and readers share."""

from __future__ import annotations

BYTES = "bytes"  # type of an input that is sent in blocks
FLAG = "bool"  # type of an input that is true or false
SEND = "send"  # direction of a `map`
AGAIN = "again"  # `else` of a `verify`: transfer the block again
BLOCK = "block"  # `of` of a checksum: of the block
PACKET_DATA = "packet.data"  # value of a field: the bytes of the packet

EFFECTS = ("list", "read", "write", "erase", "copy", "describe")
"""Effects of a procedure on objects of the device."""

FIXED_NAMES = (
    ("block", "offset"),
    ("block", "length"),
    ("block", "is_empty"),
    ("packet", "number"),
    ("packet", "offset"),
)
"""Numbers that each procedure with blocks has, in the order of their registers."""

FIXED_OWNERS = (BLOCK, "packet")


def name_of(value: str) -> tuple[str, str]:
    """Return the owner and the own name of a value: ``ready.Block Length`` is a field of
    the telemetry ``ready``, ``block.offset`` a number of the block; an input has no
    owner.
    """
    owner, separator, own = value.partition(".")
    return (owner, own) if separator else ("", owner)
