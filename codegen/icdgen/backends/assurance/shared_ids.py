"""Detection of changes of messages and nodes by the vectors of shared ids.

Constants distinguish the messages of a shared id. A changed message can match the
frames of another message, so all messages of the id are compared with each frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from icdgen import codec
from icdgen.icd.model import Icd, Message, Node
from icdgen.vectors.lines import NodeLines
from icdgen.vectors.make import NodeVectors
from icdgen.vectors.shared import SharedRow, messages_by_id


class SharedIds:
    """Frames of shared ids of all nodes. Each is a vector with a line number."""

    def __init__(
        self, icd: Icd, vectors: dict[str, NodeVectors], lines: dict[str, NodeLines]
    ) -> None:
        self._icd = icd
        self._rows: dict[str, list[tuple[int, SharedRow, list[Message]]]] = {}
        for node in icd.nodes:
            rows, numbers = vectors[node.name].shared, lines[node.name].shared
            by_direction = {
                direction: messages_by_id(icd, node, direction)
                for direction in {row.direction for row in rows}
            }
            # The messages of an id are needed again for each change, so they are looked
            # up once.
            shared_rows = [
                (n, row, by_direction[row.direction][row.id])
                for n, row in zip(numbers, rows, strict=True)
            ]
            if shared_rows:
                self._rows[node.name] = shared_rows

    def detect_message(self, message: Message, now: Message) -> dict[str, list[int]]:
        """Return the lines that detect a changed message, by node."""
        return self._detecting_rows(
            self._icd,
            lambda other: now if other is message else other,
            lambda messages: any(other is message for other in messages),
        )

    def detect_node(self, node: Node, now: Node) -> dict[str, list[int]]:
        """Return the lines that detect a changed node with unchanged messages, by node."""
        nodes = tuple(now if other is node else other for other in self._icd.nodes)
        icd = replace(self._icd, nodes=nodes)
        return self._detecting_rows(
            icd,
            lambda message: message,
            lambda messages: any(message.node == node.name for message in messages),
        )

    def _detecting_rows(
        self,
        icd: Icd,
        now: Callable[[Message], Message],
        concerns: Callable[[Sequence[Message]], bool],
    ) -> dict[str, list[int]]:
        detected: dict[str, list[int]] = {}
        for name, rows in self._rows.items():
            for number, row, messages in rows:
                # A row expects a message, or that its length is refused.
                expected = row.message if row.expected is None else row.expected
                if (
                    concerns(messages)
                    and _codec_result(icd, row, [now(message) for message in messages])
                    != expected
                ):
                    detected.setdefault(name, []).append(number)
        return detected


def _codec_result(icd: Icd, row: SharedRow, messages: Sequence[Message]) -> object:
    """Return the name of the message that the frame belongs to, its expected length, or
    None.

    An empty tuple stands for any other response.
    """
    candidates = [
        message
        for message in messages
        if getattr(message, f"{row.direction}_id") == row.id
    ]
    # The id identifies the message: the dispatcher decodes all frames
    if len(candidates) == 1:
        return (
            ()
            if len(row.frame) in candidates[0].layout.lengths
            else candidates[0].layout.longest
        )
    try:
        message = (
            codec.message_of_frame(icd, candidates, row.frame) if candidates else None
        )
    except codec.LengthError as error:
        return error.expected
    except (ValueError, OverflowError):
        return ()
    return message.name if message is not None else None
