"""Frames of ids that several messages have, and which message each is of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen import codec
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd, Message, Node
from icdgen.vectors import patterns


class SharedRow(NamedTuple):
    """A frame that came under an id. ``message`` is None where it is of none of that id; ``expected`` is the length that
    all of them have, if it is for another one."""

    direction: str
    id: int
    frame: bytes
    message: str | None
    expected: int | None = None


def ids(icd: Icd, node: Node, direction: str) -> dict[int, list[Message]]:
    """The messages of a direction that the node speaks, by their ids, in the order of the ICD."""
    found: dict[int, list[Message]] = {}
    for message in icd.messages_of(node):
        id = message.telecommand_id if direction == TELECOMMAND else message.telemetry_id
        if id is not None:
            found.setdefault(id, []).append(message)
    return dict(sorted(found.items()))


def rows(icd: Icd, node: Node) -> Iterator[SharedRow]:
    """Those of a node: what the reference codec makes of frames of each message and of frames beside them."""
    for direction in (TELECOMMAND, TELEMETRY):
        for id, messages in ids(icd, node, direction).items():
            if len(messages) > 1:
                for frame in dict.fromkeys(_frames(icd, messages)):
                    yield _row(icd, direction, id, messages, frame)


def _row(icd: Icd, direction: str, id: int, messages: list[Message], frame: bytes) -> SharedRow:
    try:
        found = codec.which(icd, messages, frame)
    except codec.LengthError as error:
        return SharedRow(direction, id, frame, None, error.expected)
    return SharedRow(direction, id, frame, found.name if found else None)


def _frames(icd: Icd, messages: list[Message]) -> Iterator[bytes]:
    """Of each message its constants among zeros, ones and random bytes, and each bit of them changed; other lengths."""
    lengths = sorted({message.length for message in messages})
    yield from (bytes(size) for size in sorted({near for n in lengths for near in (0, max(n - 1, 0), n, n + 1)}))
    yield from (b"\xff" * size for size in lengths)
    for message in messages:
        node = icd.node(message.node)
        constants = [field for field in message.owners if field.const is not None]
        for around in (bytes(message.length), b"\xff" * message.length, patterns.random_frame(message, "shared id")):
            whole = codec.decode(node, message, around) | {field.name: field.const or 0 for field in constants}
            yield codec.encode(node, message, whole)
        for field in constants:
            for bit in range(field.bits):
                mine = int(whole[field.name]) & (1 << field.bits) - 1 ^ 1 << bit
                signed = mine - (mine >> field.bits - 1 << field.bits if field.signed else 0)
                yield codec.encode(node, message, whole | {field.name: signed})
