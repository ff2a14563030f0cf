"""Pairs of old and new objects: the data structures that `icdgen.diff.match` fills and
that the rules read.

An object that exists in one ICD only has None on the other side. This module also
defines when two fields occupy the same bits (`FieldPair.same_bits`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Generic, TypeVar

from icdgen.diagnostics import Place
from icdgen.diff.where import Places, Where
from icdgen.icd.annex import Loggable
from icdgen.icd.layout import LayoutNode
from icdgen.icd.lines import Line
from icdgen.icd.model import Enum, Erratum, Icd, Member, Message, Node, Struct
from icdgen.icd.pieces import Piece, pieces_at

# Names of ICD keys in the output of ``icdgen show``, which is a possible input of the
# diff.
_SHOWN = {
    "at": ("offset",),
    "formula": ("scale", "coefficients", "points"),
    "table": ("source",),
    "source": ("table",),
    "min": ("limits",),
}


Thing = TypeVar("Thing", bound=Node | Message | Line | Enum | Member)
Part = TypeVar("Part")
Row = TypeVar("Row")


@dataclass(eq=False)
class SideBySide(Generic[Thing]):
    """Object in both ICDs.

    ``confidence``: that both are the same object, 0 to 1; 1 for equal names.
    """

    before: Thing | None
    after: Thing | None
    confidence: float = 1.0
    # Declaration that moved to another node
    is_of_another_node: bool = field(default=False, kw_only=True)

    @property
    def old(self) -> Thing:
        """Old side. The caller ensures that it exists."""
        assert self.before is not None, "an added object has no old side"
        return self.before

    @property
    def new(self) -> Thing:
        """New side. The caller ensures that it exists."""
        assert self.after is not None, "a removed object has no new side"
        return self.after

    @property
    def changed(self) -> bool:
        """Whether there is any difference."""
        return self.before != self.after

    @property
    def both(self) -> bool:
        return self.before is not None and self.after is not None

    @property
    def any(self) -> Thing:
        """New side if it exists, otherwise the old side."""
        return self.old if self.after is None else self.after

    @property
    def is_of_struct(self) -> bool:
        """Whether it is a field that a struct declares.

        Its names belong to the struct; see DIF313.
        """
        return False

    def where(self) -> Where:
        raise NotImplementedError

    def places(self, keys: tuple[str, ...]) -> Places:
        """Return the places of the first existing key in the old and in the new ICD."""
        return place_of(self.before, keys), place_of(self.after, keys)


@dataclass(eq=False)
class _DeclaredPair(SideBySide[Thing], Generic[Thing, Part]):
    """Message or enumeration with the nodes that declare it.

    ``old_node`` and ``new_node`` are equal if it exists on one side only. ``parts`` are
    its fields or members.
    """

    old_node: Node = field(kw_only=True)
    new_node: Node = field(kw_only=True)
    parts: list[Part] = field(default_factory=list)

    @property
    def node(self) -> Node:
        """Node that declares it."""
        return self.old_node if self.after is None else self.new_node

    @property
    def has_another_vocabulary(self) -> bool:
        """Whether the vocabularies, which split words of names, differ.

        Then generated names may differ.
        """
        return self.old_node.vocabulary != self.new_node.vocabulary


@dataclass(eq=False)
class MemberPair(SideBySide[Member]):
    owner: EnumPair = field(kw_only=True)

    def where(self) -> Where:
        return self.owner.where()._replace(member=self.any.name)


@dataclass(eq=False)
class FieldPair(SideBySide[Line]):
    owner: MessagePair = field(kw_only=True)

    def where(self) -> Where:
        return self.owner.where()._replace(field=self.any.name)

    @property
    def changed(self) -> bool:
        return (
            not self.both
            or self.old.content != self.new.content
            or self.owner.has_another_vocabulary
        )

    @cached_property
    def same_bits(self) -> bool:
        """Whether both sides occupy the same bits, independent of bit numbering.

        For a variable-length part, the bits of one element are compared.
        """
        was = _comparable(self.owner.old_node, self.owner.old, self.old, self.is_open)
        now = _comparable(self.owner.new_node, self.owner.new, self.new, self.is_open)
        return was == now

    @cached_property
    def is_open(self) -> bool:
        """Whether the field belongs to a variable-length part on either side."""
        sides = (self.owner.old, self.old), (self.owner.new, self.new)
        return any(
            line.levels[0].node is node
            for message, line in sides
            for node in message.layout.sequence
        )

    @property
    def is_of_struct(self) -> bool:
        return self.any.is_of_struct

    @property
    def moved(self) -> bool:
        """Whether the position differs for a reason other than byte or bit order."""
        return self.old.at != self.new.at and not self.same_bits


@dataclass(eq=False)
class EnumPair(_DeclaredPair[Enum, MemberPair]):
    @cached_property
    def changed(self) -> bool:
        return self.before != self.after or self.has_another_vocabulary

    def where(self) -> Where:
        return Where(self.node.name, enum=self.any.name)


@dataclass(eq=False)
class MessagePair(_DeclaredPair[Message, FieldPair]):
    @cached_property
    def changed(self) -> bool:
        return (
            self.before != self.after
            # The byte and bit order of the node decide where the fields are.
            or orders(self.old_node) != orders(self.new_node)
            or self.has_another_vocabulary
        )

    def where(self) -> Where:
        return Where(self.node.name, message=self.any.name)

    @property
    def common(self) -> list[FieldPair]:
        """Fields of both sides, in the order of the old frame."""
        return [pair for pair in self.parts if pair.both]

    @property
    def lost(self) -> list[FieldPair]:
        return [pair for pair in self.parts if pair.after is None]

    @property
    def gained(self) -> list[FieldPair]:
        return [pair for pair in self.parts if pair.before is None]


@dataclass(eq=False)
class NodePair(SideBySide[Node]):
    """Node in both ICDs.

    ``messages`` and ``enums``: declarations of the node on either side.
    """

    messages: list[MessagePair] = field(default_factory=list)
    enums: list[EnumPair] = field(default_factory=list)

    @property
    def declared(self) -> Sequence[DeclaredPair]:
        """Messages, then enumerations."""
        return [*self.messages, *self.enums]

    def where(self) -> Where:
        return Where(self.any.name)


DeclaredPair = MessagePair | EnumPair
# Pairs with names in generated code
IdentifiedPair = MessagePair | FieldPair | EnumPair | MemberPair
Pair = NodePair | MessagePair | FieldPair | EnumPair | MemberPair


@dataclass(eq=False)
class Match:
    """Pairs of nodes, and the pair of each message and enumeration by identity."""

    old: Icd
    new: Icd
    nodes: list[NodePair] = field(default_factory=list)
    messages: dict[int, MessagePair] = field(default_factory=dict)
    enums: dict[int, EnumPair] = field(default_factory=dict)

    def same_enum(self, old: Enum | None, new: Enum | None) -> bool:
        """Return whether both are the same enumeration, even if it was renamed."""
        if old is None or new is None:
            return old is new
        return id(old) in self.enums and self.enums[id(old)] is self.enums.get(id(new))


Position = tuple[range | Piece, ...]


def orders(node: Node) -> tuple[str, str]:
    return node.byte_order, node.bit_order


def _comparable(node: Node, message: Message, line: Line, first_only: bool) -> Position:
    """Return the `position` of a field in a frame without variable-length elements in
    front of it: the longest frame also depends on the most elements of these.
    """
    parts = message.layout.parts
    elements = sum(part.most * part.step for part in parts if 8 * part.end <= line.at)
    return position(node, line, first_only, 8 * elements)


def position(
    node: Node, line: Line, first_only: bool = False, absent: int = 0
) -> Position:
    """Return the bits of a field in a form that is comparable between nodes of
    different byte and bit order.

    With ``first_only``, bits of the first element of a variable-length part. ``absent``
    is the number of bits in front of it that the frame does not have.
    """
    # A derived value has no bits.
    if line.derived is not None:
        return ()
    starts = [start - absent for start in line.starts(first_only)]
    if line.is_bytes:
        bits = 8 if first_only and line.scalar.length is not None else line.bits
        return tuple(range(at // 8, (at + bits + 7) // 8) for at in starts)
    own = line.orders_in_effect(node.orders)
    return tuple(
        piece for at in starts for piece in pieces_at(at, line.bits, own.byte, own.bit)
    )


def kind(line: Line) -> str:
    """Return the interpretation of the bits: ``unsigned``, ``int``, ``float`` or
    ``bytes``.
    """
    if line.is_bytes:
        return "bytes"
    if line.type in ("uint", "int", "enum", "bool"):
        return "int" if line.is_signed else "unsigned"
    return line.type


def differing(
    old: Iterable[Row], new: Iterable[Row], key: Callable[[Row], Any]
) -> Iterator[tuple[Any, Row | None, Row | None]]:
    """Yield differing rows of two lists by key, in the order of the keys; None for a
    missing row.
    """
    before, after = ({key(row): row for row in side} for side in (old, new))
    for name in sorted(before.keys() | after.keys()):
        if before.get(name) != after.get(name):
            yield name, before.get(name), after.get(name)


def place_of(
    thing: (
        Node
        | Message
        | Line
        | LayoutNode
        | Struct
        | Enum
        | Member
        | Loggable
        | Erratum
        | None
    ),
    keys: tuple[str, ...],
) -> Place | None:
    """Return the place of the first existing key, otherwise of the object itself.

    For a node, the keys of its `node` section are searched.
    """
    if thing is None:
        return None
    source = (
        thing.source.get("node", thing.source)
        if isinstance(thing, Node)
        else thing.source
    )
    for key in keys:
        for name in (key, *_SHOWN.get(key, ())):
            if name in source.spots:
                return source.at(name)
    return source.place
