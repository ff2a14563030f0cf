"""Line numbers of vectors in a vector file.

Each vector occupies one line, so the line number identifies it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.vectors.make import MessageVectors, NodeVectors


@dataclass(slots=True)
class MessageLines:
    """Line numbers of one message: head (ids and length), fields, refused lengths and
    rows.
    """

    head: int
    fields: dict[str, int] = field(default_factory=dict)
    lengths: int = 0
    rows: list[int] = field(default_factory=list)


@dataclass(slots=True)
class NodeLines:
    """Line numbers of a vector file.

    ``head``: by key; ``ids``: by direction; ``shared``: in order; ``enums`` and
    ``messages``: by name.
    """

    head: dict[str, int] = field(default_factory=dict)
    ids: dict[str, int] = field(default_factory=dict)
    shared: list[int] = field(default_factory=list)
    enums: dict[str, int] = field(default_factory=dict)
    messages: dict[str, MessageLines] = field(default_factory=dict)


def line_numbers(vectors: NodeVectors, text: str) -> NodeLines:
    """Return the line numbers of ``text``, which `icdgen.vectors.write.text` wrote for
    these vectors.
    """
    numbers = NodeLines()
    # One iterator for all loops: each continues where the previous one ended.
    remaining_lines = enumerate(text.split("\n"), 1)
    for number, line in remaining_lines:
        if line.startswith('"ids": {'):
            break
        numbers.head[line.partition(":")[0].strip('"')] = number
    # The writer puts each direction on its own line.
    for direction in vectors.ids:
        numbers.ids[direction] = next(remaining_lines)[0]
    for _, line in remaining_lines:
        if line == '"shared_ids": [':
            numbers.shared = [next(remaining_lines)[0] for _ in vectors.shared]
        elif line == '"enums": [':
            numbers.enums = {
                enum.name: next(remaining_lines)[0] for enum, _ in vectors.enums
            }
        elif line == '"messages": [':
            break
    for message_vectors in vectors.messages:
        numbers.messages[message_vectors.message.name] = _message(
            message_vectors, remaining_lines
        )
    return numbers


def _message(vectors: MessageVectors, remaining_lines: enumerate[str]) -> MessageLines:
    numbers = MessageLines(
        next(number for number, line in remaining_lines if line.startswith('{"name":'))
    )
    for number, line in remaining_lines:
        if line == '"fields": [':
            numbers.fields = {
                field.name: next(remaining_lines)[0] for field in vectors.fields
            }
        elif line.startswith('"refused_lengths": '):
            numbers.lengths = number
        elif line == '"vectors": [':
            numbers.rows = [next(remaining_lines)[0] for _ in vectors.rows]
            break
    return numbers
