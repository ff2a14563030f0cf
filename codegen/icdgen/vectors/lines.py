"""In which line of a file of vectors each of them stands: one a line, so a line is their name."""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.vectors.make import MessageVectors, NodeVectors


@dataclass(slots=True)
class MessageLines:
    """Those of one message: its head (ids and length), each field, the lengths that are refused, each row."""

    head: int
    fields: dict[str, int] = field(default_factory=dict)
    lengths: int = 0
    rows: list[int] = field(default_factory=list)


@dataclass(slots=True)
class NodeLines:
    """``head``: key of the file's head -> line; ``ids``: direction -> line; ``shared``: in order; the others by name."""

    head: dict[str, int] = field(default_factory=dict)
    ids: dict[str, int] = field(default_factory=dict)
    shared: list[int] = field(default_factory=list)
    enums: dict[str, int] = field(default_factory=dict)
    messages: dict[str, MessageLines] = field(default_factory=dict)


def lines(vectors: NodeVectors, text: str) -> NodeLines:
    """The lines of ``text``, which `icdgen.vectors.write.text` made of these vectors."""
    found = NodeLines()
    rest = enumerate(text.split("\n"), 1)
    for number, line in rest:
        if line.startswith('"ids": {'):
            break
        found.head[line.partition(":")[0].strip('"')] = number
    for direction in vectors.ids:
        found.ids[direction] = next(rest)[0]
    for _, line in rest:
        if line == '"shared_ids": [':
            found.shared = [next(rest)[0] for _ in vectors.shared]
        elif line == '"enums": [':
            found.enums = {enum.name: next(rest)[0] for enum, _ in vectors.enums}
        elif line == '"messages": [':
            break
    for one in vectors.messages:
        found.messages[one.message.name] = _message(one, rest)
    return found


def _message(vectors: MessageVectors, rest: enumerate[str]) -> MessageLines:
    found = MessageLines(next(number for number, line in rest if line.startswith('{"name":')))
    for number, line in rest:
        if line == '"fields": [':
            found.fields = {one.name: next(rest)[0] for one in vectors.fields}
        elif line.startswith('"refused_lengths": '):
            found.lengths = number
        elif line == '"vectors": [':
            found.rows = [next(rest)[0] for _ in vectors.rows]
            break
    return found
