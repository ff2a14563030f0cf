"""What the reference codec says of generated messages."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen.icd.model import Message, Node
from tests.python.packages import Package


class Case(NamedTuple):
    """A message of the ICD, the node whose orders it has, and its generated class."""

    node: Node
    message: Message
    cls: Any

    @property
    def infos(self) -> dict[str, Any]:
        """What the class says of its fields, by the manual's name."""
        return {info.name: info for info in self.cls.FIELDS}


def cases(package: Package) -> Iterator[Case]:
    """Every message of every node, under each of its ids."""
    for node in package.icd.nodes:
        module = package.module(node.name)
        for message in package.icd.messages_of(node):
            for id, found in (
                (message.telecommand_id, module.TELECOMMANDS),
                (message.telemetry_id, module.TELEMETRY),
            ):
                if id is not None:
                    yield Case(package.icd.node(message.node), message, found[id])


def frames(length: int, count: int = 10) -> Iterator[bytes]:
    """Zeros, ones, frames in which each bit has a code of its own, single bits, random
    ones.
    """
    yield bytes(length)
    yield b"\xff" * length
    places = range(length * 8)
    for weight in range(len(places).bit_length()):
        code = sum(1 << place for place in places if place >> weight & 1)
        yield code.to_bytes(length, "little")
        yield ((1 << len(places)) - 1 - code).to_bytes(length, "little")
    for place in places[:64]:
        yield (1 << place).to_bytes(length, "little")
    source = random.Random(length)
    for _ in range(count):
        yield source.randbytes(length)


def raw(package: Package, info: Any, value: Any) -> Any:
    """A raw value of a generated message as the reference codec has it."""
    if info.type != "float":
        return value
    floats = package.module("_floats")
    return floats.float32_bits(value) if info.bits == 32 else floats.float64_bits(value)
