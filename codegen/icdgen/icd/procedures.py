"""Words of the `procedures` of an ICD, which rules and readers share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

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


def nested_steps(steps: object) -> Iterator[Mapping[str, Any]]:
    """Yield the steps of a list, and the steps within them, in their order. Anything
    else, which the schema check reports, is passed over.
    """
    for step in steps if isinstance(steps, list) else ():
        if not isinstance(step, Mapping):
            continue
        yield step
        yield from nested_steps(step.get("repeat"))
        for loop in (step.get("blocks"), step.get("missing")):
            if isinstance(loop, Mapping):
                yield from nested_steps(loop.get("each"))
                yield from nested_steps(loop.get("steps"))
