"""Pair generated message classes with the messages of the ICD, and make frames.

Tests compare the generated classes with the reference codec, `icdgen.codec`.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen.icd.model import Message, Node
from tests.python.packages import Package


class Case(NamedTuple):
    """A message of the ICD, the node that defines its orders, and its class."""

    node: Node
    message: Message
    cls: Any

    @property
    def infos(self) -> dict[str, Any]:
        """Generated information about the fields, by the name in the manual."""
        return {info.name: info for info in self.cls.FIELDS}


def cases(package: Package) -> Iterator[Case]:
    """Yield every message of every node, once for each of its ids."""
    for node in package.icd.nodes:
        module = package.module(node.name)
        for message in package.icd.messages_of(node):
            for id, classes in (
                (message.telecommand_id, module.TELECOMMANDS),
                (message.telemetry_id, module.TELEMETRY),
            ):
                if id is not None:
                    yield Case(package.icd.node(message.node), message, classes[id])


def frames(length: int, count: int = 10) -> Iterator[bytes]:
    """Yield zeros, ones, frames in which each bit has its own code, frames with a
    single bit set, and ``count`` random frames.
    """
    yield bytes(length)
    yield b"\xff" * length
    positions = range(length * 8)
    for weight in range(len(positions).bit_length()):
        code = sum(1 << position for position in positions if position >> weight & 1)
        yield code.to_bytes(length, "little")
        yield ((1 << len(positions)) - 1 - code).to_bytes(length, "little")
    for position in positions[:64]:
        yield (1 << position).to_bytes(length, "little")
    generator = random.Random(length)
    for _ in range(count):
        yield generator.randbytes(length)


def raw(package: Package, info: Any, value: Any) -> Any:
    """Convert a raw value of a generated message to that of the reference codec.

    The reference codec represents floats by their bits.
    """
    if info.type != "float":
        return value
    floats = package.module("_floats")
    return floats.float32_bits(value) if info.bits == 32 else floats.float64_bits(value)
