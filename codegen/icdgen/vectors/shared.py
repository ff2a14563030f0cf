"""Frames of ids that several messages have, and which message each is of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen import codec
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd, Message, Node
from icdgen.icd.variants import constants
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
                rows = (_row(icd, direction, id, messages, frame) for frame in dict.fromkeys(_frames(icd, messages)))
                yield from (row for row in rows if row is not None)


def _row(icd: Icd, direction: str, id: int, messages: list[Message], frame: bytes) -> SharedRow | None:
    """None if the frame does not have as many elements as it says: the vectors of the message have such frames."""
    try:
        found = codec.message_of_frame(icd, messages, frame)
    except codec.LengthError as error:
        return SharedRow(direction, id, frame, None, error.expected)
    if found is not None:
        try:
            codec.decode(icd.node(found.node), found, frame)
        except codec.LengthError:
            return None
    return SharedRow(direction, id, frame, found.name if found else None)


def _frames(icd: Icd, messages: list[Message]) -> Iterator[bytes]:
    """Of each message its constants among zeros, ones and random bytes, and each bit of them changed; other lengths."""
    lengths = sorted({length for message in messages for length in (message.layout.shortest, message.length)})
    yield from (bytes(size) for size in sorted({near for n in lengths for near in (0, max(n - 1, 0), n, n + 1)}))
    yield from (b"\xff" * size for size in lengths)
    for message in messages:
        node = icd.node(message.node)
        known = constants(message, node)
        for around in (bytes(message.length), b"\xff" * message.length, patterns.random_frame(message, "shared id")):
            if message.may_end_early:
                yield from (around[:1], around[: (message.length + 1) // 2])
            for frame in _cut(message, node, around):
                whole = codec.decode(node, message, frame) | {field.name: field.const or 0 for field in known}
                made = codec.frame_with(node, message, whole)
                yield made
                if message.may_end_early:
                    yield made.rstrip(b"\0") or made[:1]
        for field in known:
            for bit in range(field.bits):
                mine = int(whole[field.name]) & (1 << field.bits) - 1 ^ 1 << bit
                signed = mine - (mine >> field.bits - 1 << field.bits if field.is_signed else 0)
                yield codec.frame_with(node, message, whole | {field.name: signed})


def _cut(message: Message, node: Node, frame: bytes) -> list[bytes]:
    """The longest frame; where frames differ in length, also without an element, with one and with half of them."""
    if not message.layout.parts:
        return [frame]
    few, most = message.layout.parts[-1].fewest, message.layout.parts[-1].most
    counts = dict.fromkeys((most, few, min(few + 1, most), max(few, (most + 1) // 2)))
    return [patterns.cut(message, node, frame, count) for count in counts]
