"""Which vectors of ids that several messages share notice a change of one of these, or of its node."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from icdgen import codec
from icdgen.icd.model import Icd, Message, Node
from icdgen.vectors.lines import NodeLines
from icdgen.vectors.make import NodeVectors
from icdgen.vectors.shared import SharedRow, ids


class SharedIds:
    """The frames of shared ids of all nodes, each the vector of a line."""

    def __init__(self, icd: Icd, vectors: dict[str, NodeVectors], lines: dict[str, NodeLines]) -> None:
        self._icd = icd
        self._rows: dict[str, list[tuple[int, SharedRow, list[Message]]]] = {}
        for node in icd.nodes:
            rows, numbers = vectors[node.name].shared, lines[node.name].shared
            known = {direction: ids(icd, node, direction) for direction in {row.direction for row in rows}}
            found = [(n, row, known[row.direction][row.id]) for n, row in zip(numbers, rows, strict=True)]
            if found:
                self._rows[node.name] = found

    def of_message(self, message: Message, now: Message) -> dict[str, list[int]]:
        """By node, the lines that notice that a message is another."""
        return self._noticing(
            self._icd,
            lambda one: now if one is message else one,
            lambda known: any(one is message for one in known),
        )

    def of_node(self, node: Node, now: Node) -> dict[str, list[int]]:
        """Those that notice that a node is another, whose messages are the same."""
        nodes = tuple(now if one is node else one for one in self._icd.nodes)
        icd = replace(self._icd, nodes=nodes)
        return self._noticing(icd, lambda one: one, lambda known: any(one.node == node.name for one in known))

    def _noticing(
        self, icd: Icd, now: Callable[[Message], Message], concerns: Callable[[Sequence[Message]], bool]
    ) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for name, rows in self._rows.items():
            for number, row, known in rows:
                demanded = row.message if row.expected is None else row.expected
                if concerns(known) and _answer(icd, row, [now(one) for one in known]) != demanded:
                    found.setdefault(name, []).append(number)
        return found


def _answer(icd: Icd, row: SharedRow, messages: Sequence[Message]) -> object:
    """The name of the message that the frame is, the length that it should have, or None."""
    known = [one for one in messages if getattr(one, f"{row.direction}_id") == row.id]
    if len(known) == 1:  # the id alone tells: frames are answered with all values
        return () if len(row.frame) in known[0].lengths else known[0].length
    try:
        found = codec.which(icd, known, row.frame) if known else None
    except codec.LengthError as error:
        return error.expected
    except (ValueError, OverflowError):
        return ()
    return found.name if found is not None else None
