"""Old and new, side by side. A thing that is only in one of them has None on the other side."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from icdgen.diagnostics import Place
from icdgen.diff.change import Where
from icdgen.icd.located import Map
from icdgen.icd.model import Enum, Field, Icd, Member, Message, Node
from icdgen.layout import byte_range, pieces

# What a key of an ICD is called in the output of ``show``.
_SHOWN = {"at": ("offset",), "formula": ("scale",), "table": ("source",), "source": ("table",), "min": ("limits",)}


@dataclass(eq=False)
class Pair:
    """Two things that are the same thing in both ICDs. ``sure`` is 1 where they have the same name."""

    old: object | None
    new: object | None
    sure: float = 1.0

    @property
    def changed(self) -> bool:
        """Whether anything at all differs."""
        return self.old != self.new

    @property
    def both(self) -> bool:
        return self.old is not None and self.new is not None

    @property
    def any(self):
        """The new one, or the old one where there is no new one."""
        return self.old if self.new is None else self.new

    def where(self) -> Where:
        raise NotImplementedError

    def places(self, keys: tuple[str, ...]) -> tuple[Place | None, Place | None]:
        """Where the first of the keys that is there stands, in old and new."""
        return place_of(self.old, keys), place_of(self.new, keys)


@dataclass(eq=False)
class MemberPair(Pair):
    owner: EnumPair | None = None
    old: Member | None
    new: Member | None

    def where(self) -> Where:
        return self.owner.where()._replace(member=self.any.name)


@dataclass(eq=False)
class FieldPair(Pair):
    owner: MessagePair | None = None
    old: Field | None
    new: Field | None

    def where(self) -> Where:
        return self.owner.where()._replace(field=self.any.name)

    @property
    def changed(self) -> bool:
        return self.old != self.new or self.owner.has_another_vocabulary

    @cached_property
    def same_bits(self) -> bool:
        """Whether both lie on the same bits, however these are numbered."""
        return position(self.owner.old_node, self.old) == position(self.owner.new_node, self.new)

    @property
    def moved(self) -> bool:
        """Whether it lies elsewhere for another reason than the order of bytes or bits."""
        return self.old.at != self.new.at and not self.same_bits


@dataclass(eq=False)
class EnumPair(Pair):
    old_node: Node | None = None
    new_node: Node | None = None
    is_of_another_node: bool = False  # another node declares it now
    members: list[MemberPair] = field(default_factory=list)
    old: Enum | None
    new: Enum | None

    @cached_property
    def changed(self) -> bool:
        return self.old != self.new or self.has_another_vocabulary

    @property
    def has_another_vocabulary(self) -> bool:
        """Whether words are split in another way, so that its names may differ."""
        return self.old_node.vocabulary != self.new_node.vocabulary

    def where(self) -> Where:
        return Where(self.node.name, enum=self.any.name)

    @property
    def node(self) -> Node:
        """The node that declares it."""
        return self.old_node if self.new is None else self.new_node


@dataclass(eq=False)
class MessagePair(Pair):
    old_node: Node | None = None
    new_node: Node | None = None
    is_of_another_node: bool = False  # another node declares it now
    fields: list[FieldPair] = field(default_factory=list)
    old: Message | None
    new: Message | None

    def where(self) -> Where:
        return Where(self.node.name, message=self.any.name)

    @property
    def node(self) -> Node:
        """The node that declares it."""
        return self.old_node if self.new is None else self.new_node

    @cached_property
    def changed(self) -> bool:
        return self.old != self.new or self.reordered or self.has_another_vocabulary

    @property
    def has_another_vocabulary(self) -> bool:
        """Whether words are split in another way, so that its names may differ."""
        return self.old_node.vocabulary != self.new_node.vocabulary

    @property
    def kept(self) -> list[FieldPair]:
        """Fields that are in both, in the order of the old frame."""
        return [pair for pair in self.fields if pair.both]

    @property
    def lost(self) -> list[FieldPair]:
        return [pair for pair in self.fields if pair.new is None]

    @property
    def gained(self) -> list[FieldPair]:
        return [pair for pair in self.fields if pair.old is None]

    @property
    def reordered(self) -> bool:
        """Whether bytes or bits are in another order."""
        return orders(self.old_node) != orders(self.new_node)


@dataclass(eq=False)
class NodePair(Pair):
    """``messages`` and ``enums`` are those that the node declares now, or declared."""

    messages: list[MessagePair] = field(default_factory=list)
    enums: list[EnumPair] = field(default_factory=list)
    old: Node | None
    new: Node | None

    def where(self) -> Where:
        return Where(self.any.name)

    def places(self, keys: tuple[str, ...]) -> tuple[Place | None, Place | None]:
        heads = (_head(self.old), _head(self.new))
        return tuple(at(head, keys) if head is not None else None for head in heads)


@dataclass(eq=False)
class Match:
    """The nodes side by side, and the pair of every message and enumeration, by identity."""

    old: Icd
    new: Icd
    nodes: list[NodePair] = field(default_factory=list)
    pair_of: dict[int, Pair] = field(default_factory=dict)

    def same_enum(self, old: Enum | None, new: Enum | None) -> bool:
        """Whether both are the same enumeration, renamed or not."""
        if old is None or new is None:
            return old is new
        return self.pair_of.get(id(old)) is not None and self.pair_of.get(id(old)) is self.pair_of.get(id(new))


def orders(node: Node) -> tuple[str, str]:
    return node.byte_order, node.bit_order


def position(node: Node, one: Field) -> tuple:
    """The bits that the field lies on, comparable between nodes of different byte and bit order."""
    return (byte_range(one),) if one.type == "bytes" else pieces(one, node)


def kind(one: Field) -> str:
    """How the bits are read: as an unsigned or signed number, as a float, as bytes."""
    return "unsigned" if one.type in ("uint", "enum", "bool") else one.type


def place_of(thing: object, keys: tuple[str, ...]) -> Place | None:
    source = getattr(thing, "source", None)
    return at(source, keys) if isinstance(source, Map) else None


def at(source: Map, keys: tuple[str, ...]) -> Place:
    """Where the first key stands that is there; the mapping itself if none is."""
    for key in keys:
        for name in (key, *_SHOWN.get(key, ())):
            if name in source.values_at:
                return source.values_at[name]
    return source.place


def _head(node: Node | None) -> Map | None:
    source = getattr(node, "source", None)
    if not isinstance(source, Map):
        return None
    head = source.get("node")
    return head if isinstance(head, Map) else source
