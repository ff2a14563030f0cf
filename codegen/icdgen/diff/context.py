"""What the rules of the diff look at, worked out once."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache, cached_property

from icdgen.diff.facts import differ, has_envelope
from icdgen.diff.generated import Generated
from icdgen.diff.moves import moves
from icdgen.diff.pairs import DeclaredPair, FieldPair, Match, MessagePair, NodePair, Position, position
from icdgen.icd.lines import lines
from icdgen.icd.model import Icd, Message, Node
from icdgen.protocol.envelope import DIRECTIONS


class Context:
    """Both ICDs side by side."""

    def __init__(self, match: Match) -> None:
        self.match = match
        self.moves = cache(moves)  # what moved within a message
        self.other_envelopes = cache(self._other_envelopes)

    @cached_property
    def generated(self) -> Generated:
        """Names and types of everything that changed."""
        return Generated(self.match, self.changed)

    @cached_property
    def changed(self) -> list[DeclaredPair]:
        """Messages and enumerations in which anything differs."""
        return [p for node in self.match.nodes for p in node.declared if p.changed]

    @cached_property
    def users(self) -> dict[int, list[str]]:
        """Fields that hold the values of an enumeration of the new ICD, by the enumeration's identity."""
        users: dict[int, list[str]] = {}
        for message in (m for node in self.match.new.nodes for m in node.messages):
            for field in lines(message.layout):
                if field.enum is not None:
                    users.setdefault(id(field.enum), []).append(f"{message.name}: {field.name}")
        return users

    def sides(self, node: NodePair) -> tuple[tuple[Icd, Node], tuple[Icd, Node]]:
        return (self.match.old, node.old), (self.match.new, node.new)

    def have_envelopes(self, node: NodePair) -> bool:
        """Whether messages of the node travel in envelopes in both ICDs."""
        return node.both and all(map(has_envelope, self.sides(node)))

    def _other_envelopes(self, node: NodePair) -> frozenset[str]:
        """The directions in which no message is as before, because its envelope is not: of nodes that have one in both ICDs."""
        if not self.have_envelopes(node):
            return frozenset()
        return frozenset(direction for direction in DIRECTIONS if differ(*self.sides(node), direction))

    def pair(self, message: Message) -> MessagePair:
        """The pair that a message is a side of."""
        return self.match.messages[id(message)]

    def at_the_end(self, pair: MessagePair) -> list[FieldPair]:
        """Fields that came with the bytes by which the frame grew, or went with those that it lost."""
        if pair.old.length == pair.new.length:
            return []
        end = min(pair.old.length, pair.new.length) * 8
        causes = self.moves(pair).causes
        rows = pair.gained if pair.new.length > pair.old.length else pair.lost
        return [p for p in rows if p.any.at >= end and id(p) not in causes]

    def is_said_of_the_message(self, pair: FieldPair) -> bool:
        """Whether another change already says that the field came or went."""
        return id(pair) in self.moves(pair.owner).causes or any(p is pair for p in self.at_the_end(pair.owner))

    def is_touched_before(self, pair: MessagePair, bit: int) -> bool:
        """Whether any field of the first ``bit`` bits came, went or lies elsewhere."""
        alone = (*pair.lost, *pair.gained)
        return any(p.any.at < bit for p in alone) or any(not p.same_bits for p in pair.common)

    def unspoken(self, node: NodePair, side: int) -> list[Message]:
        """Messages of one side that the node does not speak on the other, where they are still declared."""
        mine, other = (icd.messages_of(side_of_node) for icd, side_of_node in self.sides(node))
        if side:
            mine, other = other, mine
        spoken = {id(self.pair(m)) for m in other}
        pairs = ((m, self.pair(m)) for m in mine)
        return [m for m, pair in pairs if pair.both and id(pair) not in spoken]


def free_before(pair: FieldPair) -> bool:
    """Whether no field of the old frame lies on bits of the field that came."""
    message = pair.owner
    mine = _bits(position(message.new_node, pair.new))
    return not any(mine & _bits(position(message.old_node, f)) for f in lines(message.old.layout))


def _bits(position: Position) -> set[tuple[int, int]]:
    bits = set()
    for part in position:
        if isinstance(part, range):
            bits |= {(byte, bit) for byte in part for bit in range(8)}
        else:
            bits |= {(part.byte, part.shift + bit) for bit in range(part.bits)}
    return bits


def by_id(messages: Iterable[Message], key: str) -> dict[int, list[Message]]:
    """The messages of each id; ``key`` names it: ``telemetry_id``."""
    messages_by_id: dict[int, list[Message]] = {}
    for message in messages:
        number = getattr(message, key)
        if number is not None:
            messages_by_id.setdefault(number, []).append(message)
    return messages_by_id
