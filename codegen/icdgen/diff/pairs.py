"""Old and new, side by side. A thing that is only in one of them has None on the other side."""

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
from icdgen.layout import Piece, pieces_at

# What a key of an ICD is called in the output of ``show``.
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
    """Two things that are the same thing in both ICDs. ``sure`` is 1 where they have the same name."""

    before: Thing | None
    after: Thing | None
    sure: float = 1.0
    is_of_another_node: bool = field(
        default=False, kw_only=True
    )  # a message or an enumeration that another one declares now

    @property
    def old(self) -> Thing:
        """What it was, for those who know that it was there."""
        assert self.before is not None, "asked for the old side of what came"
        return self.before

    @property
    def new(self) -> Thing:
        """What it is, for those who know that it is there."""
        assert self.after is not None, "asked for the new side of what went"
        return self.after

    @property
    def changed(self) -> bool:
        """Whether anything at all differs."""
        return self.before != self.after

    @property
    def both(self) -> bool:
        return self.before is not None and self.after is not None

    @property
    def any(self) -> Thing:
        """The new one, or the old one where there is no new one."""
        return self.old if self.after is None else self.after

    @property
    def is_of_struct(self) -> bool:
        """Whether it is a field whose names a struct declares, and no message: see DIF313."""
        return False

    def where(self) -> Where:
        raise NotImplementedError

    def places(self, keys: tuple[str, ...]) -> Places:
        """Where the first of the keys that is there stands, in old and new."""
        return place_of(self.before, keys), place_of(self.after, keys)


@dataclass(eq=False)
class _DeclaredPair(SideBySide[Thing], Generic[Thing, Part]):
    """What a node declares: ``old_node`` and ``new_node`` are where; the same where it is only on one side.

    ``parts`` are its fields or members.
    """

    old_node: Node = field(kw_only=True)
    new_node: Node = field(kw_only=True)
    parts: list[Part] = field(default_factory=list)

    @property
    def node(self) -> Node:
        """The node that declares it."""
        return self.old_node if self.after is None else self.new_node

    @property
    def has_another_vocabulary(self) -> bool:
        """Whether words are split in another way, so that its names may differ."""
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
        return not self.both or self.old.content != self.new.content or self.owner.has_another_vocabulary

    @cached_property
    def same_bits(self) -> bool:
        """Whether both lie on the same bits, however these are numbered; of a variable-length part, those of one element."""
        was, now = (
            position(node, line, self.is_open)
            for node, line in ((self.owner.old_node, self.old), (self.owner.new_node, self.new))
        )
        return was == now

    @cached_property
    def is_open(self) -> bool:
        """Whether it is in a variable-length part of its message on one side."""
        sides = (self.owner.old, self.old), (self.owner.new, self.new)
        return any(line.levels[0].node is node for message, line in sides for node in message.layout.sequence)

    @property
    def is_of_struct(self) -> bool:
        return self.any.is_of_struct

    @property
    def moved(self) -> bool:
        """Whether it lies elsewhere for another reason than the order of bytes or bits."""
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
        return self.before != self.after or self.reordered or self.has_another_vocabulary

    def where(self) -> Where:
        return Where(self.node.name, message=self.any.name)

    @property
    def common(self) -> list[FieldPair]:
        """Fields that are in both, in the order of the old frame."""
        return [pair for pair in self.parts if pair.both]

    @property
    def lost(self) -> list[FieldPair]:
        return [pair for pair in self.parts if pair.after is None]

    @property
    def gained(self) -> list[FieldPair]:
        return [pair for pair in self.parts if pair.before is None]

    @property
    def reordered(self) -> bool:
        """Whether bytes or bits are in another order."""
        return orders(self.old_node) != orders(self.new_node)


@dataclass(eq=False)
class NodePair(SideBySide[Node]):
    """``messages`` and ``enums`` are those that the node declares now, or declared."""

    messages: list[MessagePair] = field(default_factory=list)
    enums: list[EnumPair] = field(default_factory=list)

    @property
    def declared(self) -> Sequence[DeclaredPair]:
        """Its messages, then its enumerations."""
        return [*self.messages, *self.enums]

    def where(self) -> Where:
        return Where(self.any.name)


DeclaredPair = MessagePair | EnumPair
IdentifiedPair = MessagePair | FieldPair | EnumPair | MemberPair  # what has names in generated code
Pair = NodePair | MessagePair | FieldPair | EnumPair | MemberPair


@dataclass(eq=False)
class Match:
    """The nodes side by side, and the pair of every message and enumeration, by identity."""

    old: Icd
    new: Icd
    nodes: list[NodePair] = field(default_factory=list)
    messages: dict[int, MessagePair] = field(default_factory=dict)
    enums: dict[int, EnumPair] = field(default_factory=dict)

    def same_enum(self, old: Enum | None, new: Enum | None) -> bool:
        """Whether both are the same enumeration, renamed or not."""
        if old is None or new is None:
            return old is new
        return id(old) in self.enums and self.enums[id(old)] is self.enums.get(id(new))


Position = tuple[range | Piece, ...]


def orders(node: Node) -> tuple[str, str]:
    return node.byte_order, node.bit_order


def position(node: Node, line: Line, first_only: bool = False) -> Position:
    """Return the bits that a field has, comparable between nodes of different byte and bit order.

    With `first_only` those in the first element of a variable-length part.
    """
    if line.derived is not None:
        return ()
    starts = line.starts(first_only)
    if line.is_bytes:
        bits = 8 if first_only and line.scalar.length is not None else line.bits
        return tuple(range(at // 8, (at + bits + 7) // 8) for at in starts)
    own = line.orders_in_effect(node.orders)
    return tuple(piece for at in starts for piece in pieces_at(at, line.bits, own.byte, own.bit))


def kind(line: Line) -> str:
    """How the bits are read: as an unsigned or signed number, as a float, as bytes."""
    if line.is_bytes:
        return "bytes"
    if line.type in ("uint", "int", "enum", "bool"):
        return "int" if line.is_signed else "unsigned"
    return line.type


def differing(
    old: Iterable[Row], new: Iterable[Row], key: Callable[[Row], Any]
) -> Iterator[tuple[Any, Row | None, Row | None]]:
    """The rows of a list that differ, by their key and in its order; None where a side has no such row."""
    before, after = ({key(row): row for row in side} for side in (old, new))
    for name in sorted(before.keys() | after.keys()):
        if before.get(name) != after.get(name):
            yield name, before.get(name), after.get(name)


def place_of(
    thing: Node | Message | Line | LayoutNode | Struct | Enum | Member | Loggable | Erratum | None,
    keys: tuple[str, ...],
) -> Place | None:
    """Where the first key stands that is there, of a node in its head; the thing itself if none is."""
    if thing is None:
        return None
    source = thing.source.get("node", thing.source) if isinstance(thing, Node) else thing.source
    for key in keys:
        for name in (key, *_SHOWN.get(key, ())):
            if name in source.spots:
                return source.at(name)
    return source.place
