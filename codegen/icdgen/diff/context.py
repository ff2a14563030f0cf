"""Data of a comparison that several rules of the diff need, computed once.

Every rule receives the `ComparisonContext` as its last argument.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache, cached_property

from icdgen.diff.facts import has_packet_format, packet_formats_differ
from icdgen.diff.generated import Generated
from icdgen.diff.moves import moves
from icdgen.diff.pairs import (
    DeclaredPair,
    FieldPair,
    Match,
    MessagePair,
    NodePair,
    Position,
    position,
)
from icdgen.icd.lines import lines
from icdgen.icd.model import Icd, Message, Node
from icdgen.protocol.packet_formats import DIRECTIONS


class ComparisonContext:
    """Pair of ICDs with cached results."""

    def __init__(self, match: Match) -> None:
        self.match = match
        # `cache` by identity: pairs compare by identity (`eq=False`).
        self.moves = cache(moves)  # moved fields of a message
        self.changed_packet_formats = cache(self._directions_with_changed_packets)

    @cached_property
    def generated(self) -> Generated:
        """Names and types in generated code."""
        return Generated(self.match)

    @cached_property
    def changed(self) -> list[DeclaredPair]:
        """Messages and enumerations with any difference."""
        return [p for node in self.match.nodes for p in node.declared if p.changed]

    @cached_property
    def users(self) -> dict[int, list[str]]:
        """Fields that use an enumeration of the new ICD, by the identity of the
        enumeration.
        """
        users: dict[int, list[str]] = {}
        for node in self.match.new.nodes:
            for message in node.messages:
                for field in lines(message.layout):
                    if field.enum is not None:
                        users.setdefault(id(field.enum), []).append(
                            f"{message.name}: {field.name}"
                        )
        return users

    def sides(self, node: NodePair) -> tuple[tuple[Icd, Node], tuple[Icd, Node]]:
        return (self.match.old, node.old), (self.match.new, node.new)

    def have_packet_formats(self, node: NodePair) -> bool:
        """Return whether messages of the node have a packet format in both ICDs."""
        return node.both and all(map(has_packet_format, self.sides(node)))

    def _directions_with_changed_packets(self, node: NodePair) -> frozenset[str]:
        """Return the directions whose packet format changed, for nodes that have one in
        both ICDs.
        """
        if not self.have_packet_formats(node):
            return frozenset()
        return frozenset(
            direction
            for direction in DIRECTIONS
            if packet_formats_differ(*self.sides(node), direction)
        )

    def pair(self, message: Message) -> MessagePair:
        """Return the pair that contains a message."""
        return self.match.messages[id(message)]

    def at_the_end(self, pair: MessagePair) -> list[FieldPair]:
        """Return the fields that were added or removed at the end of the frame together
        with its bytes.
        """
        if pair.old.length == pair.new.length:
            return []
        # Only fields beyond the shorter frame; a moved field may lie there too
        # (`causes`).
        end = min(pair.old.length, pair.new.length) * 8
        causes = self.moves(pair).causes
        rows = pair.gained if pair.new.length > pair.old.length else pair.lost
        return [p for p in rows if p.any.at >= end and id(p) not in causes]

    def is_reported_for_message(self, pair: FieldPair) -> bool:
        """Return whether another change reports the addition or removal of the field."""
        return id(pair) in self.moves(pair.owner).causes or any(
            p is pair for p in self.at_the_end(pair.owner)
        )

    def is_touched_before(self, pair: MessagePair, bit: int) -> bool:
        """Return whether any field of the first ``bit`` bits was added, removed or
        moved.
        """
        unpaired = (*pair.lost, *pair.gained)
        return any(p.any.at < bit for p in unpaired) or any(
            not p.same_bits for p in pair.common
        )

    def messages_not_used(self, node: NodePair, side: int) -> list[Message]:
        """Return the messages of one side that the node does not use on the other side,
        although they are still declared.
        """
        used_messages = [
            icd.messages_of(side_of_node) for icd, side_of_node in self.sides(node)
        ]
        used_on_other_side = {id(self.pair(m)) for m in used_messages[1 - side]}
        return [
            message
            for message in used_messages[side]
            if self.pair(message).both
            and id(self.pair(message)) not in used_on_other_side
        ]


def free_before(pair: FieldPair) -> bool:
    """Return whether the bits of an added field were free in the old frame."""
    message = pair.owner
    new_bits = _bits(position(message.new_node, pair.new))
    return not any(
        new_bits & _bits(position(message.old_node, f))
        for f in lines(message.old.layout)
    )


def _bits(position: Position) -> set[tuple[int, int]]:
    bits = set()
    for part in position:
        # Byte strings are ranges of bytes, numbers are pieces of bits.
        if isinstance(part, range):
            bits |= {(byte, bit) for byte in part for bit in range(8)}
        else:
            bits |= {(part.byte, part.shift + bit) for bit in range(part.bits)}
    return bits


def by_id(messages: Iterable[Message], key: str) -> dict[int, list[Message]]:
    """Return the messages by id.

    ``key``: name of the id, for example ``telemetry_id``.
    """
    messages_by_id: dict[int, list[Message]] = {}
    for message in messages:
        number = getattr(message, key)
        if number is not None:
            messages_by_id.setdefault(number, []).append(message)
    return messages_by_id
