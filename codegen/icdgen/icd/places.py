"""Nodes where they stand in the longest frame: what is declared, documented and generated.

In: a layout. Out: `places_in` lists its nodes, arrays and structs as one, `scalars_in` each element and each field of a struct;
`NodePlace.elements` and `NodePlace.inner` go further down.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from icdgen.frozen import dataclass
from icdgen.icd.derived import Derivation
from icdgen.icd.erratum import Erratum
from icdgen.icd.frames import FrameField, OfScalar, PathStep, Role, name_of_steps
from icdgen.icd.layout import (
    UNDECLARED,
    Array,
    Condition,
    Derived,
    Layout,
    LayoutNode,
    Orders,
    Overlay,
    Rest,
    Scalar,
    StructRef,
    size_of,
    stride,
)
from icdgen.icd.located import Map
from icdgen.once import cached_property, kept_by_owner

_NO_SCALAR = Scalar(name="", type="struct", bits=0)
"""The scalar of a place where a struct stands."""


@dataclass(frozen=True, eq=False)
class NodePlace(OfScalar):
    """A node, or an element of an array, at its bit of the longest frame or of a struct."""

    steps: tuple[PathStep, ...]  # from the node of the message's own layout on
    scalar: Scalar  # that stands here; of an array that stands as one, an element of it
    struct: Layout | None  # that stands here instead of a scalar
    at: int  # counted in the bit order in effect
    bits: int  # of an array those of an element; of variable-length bytes and text the most
    declared_orders: Orders  # of the node or what it stands in; empty where those of the ICD node hold
    count: int = 0  # elements of an array that stands as one; else 0
    smallest_raw: int = 0  # of a field that counts elements
    is_count: bool = False  # it has no bits: the length of the frame tells its value

    @cached_property
    def name(self) -> str:
        """``Satellites[2].GNSS``"""
        return name_of_steps(self.steps)

    @property
    def node(self) -> LayoutNode:
        """The node that stands here, or the array that it is an element of."""
        return self.steps[-1].node

    @property
    def index(self) -> int | None:
        """Which element of an array it is; None of what is no element."""
        return self.steps[-1].element

    @property
    def width(self) -> int:
        """Bits of all that stands here."""
        return self.bits * (self.count or 1)

    @property
    def byte_order(self) -> str:
        """Byte order of the node or what it stands in; empty where that of the ICD node holds."""
        return self.declared_orders.byte

    @property
    def bit_order(self) -> str:
        """Bit order of the node or what it stands in; empty where that of the ICD node holds."""
        return self.declared_orders.bit

    @property
    def identifier(self) -> str | None:
        """The words that the ICD gives instead of the name."""
        return self.node.identifier

    @property
    def summary(self) -> str:
        """The summary of the ICD."""
        return self.node.summary

    @property
    def aliases(self) -> tuple[str, ...]:
        """Other names by which people look for it."""
        return self.node.aliases

    @property
    def errata(self) -> tuple[Erratum, ...]:
        """The errata of the node."""
        return self.node.errata

    @property
    def source(self) -> Map:
        """The mapping that the node was read from."""
        return self.node.source

    @property
    def when(self) -> tuple[Condition, ...]:
        """It is in a frame only if all of them hold."""
        return self.node.present_if

    @property
    def view(self) -> bool:
        """Whether it reads bits of other fields, or is computed."""
        return isinstance(self.node, Overlay | Derived)

    @property
    def derived(self) -> Derivation | None:
        """How it is computed from other fields; None where it is not."""
        return self.node.derivation if isinstance(self.node, Derived) else None

    @property
    def role(self) -> Role:
        """What it is in a frame."""
        match self.node:
            case Overlay():
                return "overlay"
            case Derived():
                return "derived"
        return "count" if self.is_count else "field"

    @property
    def fresh(self) -> int | bytes:
        """The raw value in a new message: the only valid one, or the smallest; of a float its bits."""
        return bytes(self.bits // 8) if self.is_bytes else self.const or self.smallest_raw

    def orders_in_effect(self, outer: Orders) -> Orders:
        """Return the orders in effect, where those of the ICD node are `outer`."""
        return self.declared_orders.within(outer)

    def elements(self) -> tuple[NodePlace, ...]:
        """Return the elements of an array, structs whole; of anything else the place itself."""
        if not self.count:
            return (self,)
        before, stride = self.steps[:-1], self.bits
        return tuple(
            NodePlace(
                (*before, PathStep(self.node, index)),
                self.scalar,
                self.struct,
                self.at + index * stride,
                stride,
                self.declared_orders,
            )
            for index in range(self.count)
        )

    def inner(self) -> tuple[NodePlace, ...]:
        """Return the places of what stands in a struct; of an array of structs, take an element first."""
        assert self.struct is not None and not self.count, f"{self.name} is no single struct"
        return tuple(_place(node, self.declared_orders, self.at, self.steps) for node in self.struct.fixed)

    def scalars(self) -> Iterator[NodePlace]:
        """Return all scalars that stand here, each element of an array and each field of a struct by itself."""
        for element in self.elements():
            if element.struct is None:
                yield element
            else:
                for place in element.inner():
                    yield from place.scalars()


AnyScalar: TypeAlias = Scalar | FrameField | NodePlace
"""What gives a raw value its meaning."""


@kept_by_owner
def places_in(layout: Layout) -> tuple[NodePlace, ...]:
    """Return the nodes where they stand in the longest frame, in the order of `Layout.nodes`; behind a variable part its count."""
    return places_of(layout)


@kept_by_owner
def scalars_in(layout: Layout) -> tuple[NodePlace, ...]:
    """Return all scalars of the longest frame: each element of an array and each field of a struct by itself."""
    return tuple(scalar for place in places_in(layout) for scalar in place.scalars())


@kept_by_owner
def raw_fields_in(layout: Layout) -> tuple[NodePlace, ...]:
    """Return those of `scalars_in` whose raw value a message has to give: all but overlays and derived values."""
    return tuple(scalar for scalar in scalars_in(layout) if not scalar.view)


def places_of(layout: Layout, outer: Orders = UNDECLARED) -> tuple[NodePlace, ...]:
    """Return the places of the nodes of a layout. `outer` are the orders of what it stands in, if it is an element.

    `places_in` keeps those without `outer`.
    """
    orders = layout.orders.within(outer)
    found = [_place(node, orders, smallest_raw=layout.smallest_raw(node.name)) for node in layout.fixed]
    for part in layout.parts:
        node, size, at = part.node, size_of(part.node), 8 * part.begin
        own, steps = node.orders.within(orders), (PathStep(node),)
        if isinstance(node, Array):
            found.append(_place_of_item(steps, node.item, at, own, part.most))
        else:
            found.append(NodePlace(steps, node, None, at, 8 * part.most, own))
        if isinstance(size, Rest):
            counter, end = size.counter, 8 * (part.begin + part.most * part.step)
            found.append(NodePlace((PathStep(counter),), counter, None, end, counter.bits, UNDECLARED, is_count=True))
    found += (_place(node, UNDECLARED, 8 * layout.longest) for node in layout.derived)
    return tuple(found)


def _place(
    node: LayoutNode, orders: Orders, begin: int = 0, owners: tuple[PathStep, ...] = (), smallest_raw: int = 0
) -> NodePlace:
    """Return the place of a node of fixed size in what begins at bit `begin`."""
    own, at, steps = node.orders.within(orders), begin + node.at, (*owners, PathStep(node))
    match node:
        case Array(item=item, size=int(count)):
            return _place_of_item(steps, item, at, own, count)
        case StructRef() | Scalar():
            return _place_of_item(steps, node, at, own, 0, smallest_raw)
        case Overlay(scalar=scalar):
            return NodePlace(steps, scalar, None, at, scalar.bits, own)
        case Derived(scalar=scalar):
            return NodePlace(steps, scalar, None, begin, scalar.bits, own)
    raise TypeError(f"{node.name} has no fixed place")


def _place_of_item(
    steps: tuple[PathStep, ...],
    item: Scalar | StructRef,
    at: int,
    orders: Orders,
    count: int,
    smallest_raw: int = 0,
) -> NodePlace:
    """Return the place of a scalar or struct, or of so many of them."""
    scalar, struct = (item, None) if isinstance(item, Scalar) else (_NO_SCALAR, item.layout)
    return NodePlace(steps, scalar, struct, at, stride(item), orders, count, smallest_raw)
