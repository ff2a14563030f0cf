"""Frames of ids that several messages share, with the message that each frame belongs
to.

`shared_rows` yields them for a node, for telecommands and telemetry: frames of each
message, frames with one inverted bit of a constant, and wrong lengths. The reference
codec determines the expected message. Ids of a single message are not included; the
vectors of the message (``make``) test them.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen import codec
from icdgen.frozen import NamedTuple
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd, Message, Node
from icdgen.icd.variants import constants
from icdgen.vectors import patterns


class SharedRow(NamedTuple):
    """Frame received with a shared id.

    ``message``: name of the message; None if the frame matches no message.
    ``expected``: common length of the messages, if the frame has another length.
    """

    direction: str
    id: int
    frame: bytes
    message: str | None
    expected: int | None = None


def messages_by_id(icd: Icd, node: Node, direction: str) -> dict[int, list[Message]]:
    """Return the messages of a direction that the node sends or receives, by id.

    The ids are in ascending order. Messages that share an id have the order of the ICD.
    """
    by_id: dict[int, list[Message]] = {}
    for message in icd.messages_of(node):
        id = (
            message.telecommand_id if direction == TELECOMMAND else message.telemetry_id
        )
        if id is not None:
            by_id.setdefault(id, []).append(message)
    return dict(sorted(by_id.items()))


def shared_rows(icd: Icd, node: Node) -> Iterator[SharedRow]:
    """Yield the frames of shared ids of a node: frames of each message, and frames that
    differ from them, as the reference codec assigns them.
    """
    for direction in (TELECOMMAND, TELEMETRY):
        for id, messages in messages_by_id(icd, node, direction).items():
            # Ids of one message are tested by the vectors of the message.
            if len(messages) == 1:
                continue
            for frame in dict.fromkeys(_frames(icd, messages)):
                row = _row(icd, direction, id, messages, frame)
                if row is not None:
                    yield row


def _row(
    icd: Icd, direction: str, id: int, messages: list[Message], frame: bytes
) -> SharedRow | None:
    """Return the row of a frame.

    None for a frame whose counter contradicts its length; the vectors of the message
    contain such frames.
    """
    try:
        match = codec.message_of_frame(icd, messages, frame)
    except codec.LengthError as error:
        return SharedRow(direction, id, frame, None, error.expected)
    if match is not None:
        try:
            codec.decode(icd.node(match.node), match, frame)
        except codec.LengthError:
            return None
    return SharedRow(direction, id, frame, match.name if match else None)


def _frames(icd: Icd, messages: list[Message]) -> Iterator[bytes]:
    """Yield frames of each message: its constants among zeros, ones and random bytes,
    each bit of a constant inverted, and wrong lengths.
    """
    lengths: set[int] = set()
    for message in messages:
        lengths |= {message.layout.shortest, message.length}
    sizes = {0}
    for length in lengths:
        sizes |= {max(length - 1, 0), length, length + 1}
    yield from (bytes(size) for size in sorted(sizes))
    yield from (b"\xff" * size for size in sorted(lengths))
    for message in messages:
        node = icd.node(message.node)
        constant_fields = constants(message, node)
        for background in (
            bytes(message.length),
            b"\xff" * message.length,
            patterns.random_frame(message, "shared id"),
        ):
            if message.may_end_early:
                yield from (background[:1], background[: (message.length + 1) // 2])
            for frame in _cut(message, node, background):
                # All other fields keep the values of the frame, counters among them.
                values = codec.decode(node, message, frame) | {
                    field.name: field.const or 0 for field in constant_fields
                }
                frame_with_constants = codec.encode_partial(node, message, values)
                yield frame_with_constants
                if message.may_end_early:
                    # The first byte is always sent, even if it is zero.
                    yield frame_with_constants.rstrip(b"\0") or frame_with_constants[:1]
        # A decoder that ignores any bit of a constant fails here.
        for field in constant_fields:
            # `values` are those of the last frame above, with random bytes around the
            # constants.
            for bit in range(field.bits):
                inverted = int(values[field.name]) & (1 << field.bits) - 1 ^ 1 << bit
                # The highest bit of a signed field counts negative.
                signed = inverted - (
                    inverted >> field.bits - 1 << field.bits if field.is_signed else 0
                )
                yield codec.encode_partial(node, message, values | {field.name: signed})


def _cut(message: Message, node: Node, frame: bytes) -> list[bytes]:
    """Return the longest frame and, for variable length, frames with the fewest, one
    more and half of the elements.
    """
    if not message.layout.parts:
        return [frame]
    few, most = message.layout.parts[-1].fewest, message.layout.parts[-1].most
    counts = dict.fromkeys((most, few, min(few + 1, most), max(few, (most + 1) // 2)))
    return [patterns.cut(message, node, frame, count) for count in counts]
