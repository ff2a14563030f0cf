"""Nodes of a layout at their positions in the longest frame.

Declarations, documents and generated code use them.

`places_in` lists the nodes of a layout, an array or a struct as one place. `scalars_in`
lists each array element and each field of a struct separately. `NodePlace.elements` and
`NodePlace.inner` go down one level.
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
    bits_of_node,
    is_variable,
    size_of,
    stride,
)
from icdgen.icd.located import Map
from icdgen.once import cached_by_owner, cached_property

# A struct has no scalar; this one makes `NodePlace.type` of a struct "struct".
_NO_SCALAR = Scalar(name="", type="struct", bits=0)
# A tuple: `isinstance` would build the union `Overlay | Derived` in each of very many
# calls.
_READ_ONLY = (Overlay, Derived)


# Compared by identity, as `places_in` caches the objects; comparing paths of nodes
# would be slow.
@dataclass(frozen=True, eq=False)
class NodePlace(OfScalar):
    """A node, or an element of an array, at its position in the longest frame or in a
    struct.
    """

    steps: tuple[PathStep, ...]  # path from the layout of the message
    scalar: Scalar  # of an array: its element
    struct: Layout | None  # of a struct or an array of structs: its layout
    at: int  # first bit, counted in the bit order in effect
    bits: int  # of an array: of an element; of variable-length bytes and text: the most
    # Of the node or an owner; empty if the defaults of the ICD node apply.
    declared_orders: Orders
    count: int = 0  # elements of an array; 0 for an element and for any other node
    smallest_raw: int = 0  # of a field that counts elements
    # It has no bits: its value follows from the length of the frame.
    is_count: bool = False

    @cached_property
    def name(self) -> str:
        """``Satellites[2].GNSS``"""
        return name_of_steps(self.steps)

    @cached_property
    def node(self) -> LayoutNode:
        """The node; of an element, its array."""
        return self.steps[-1].node

    @property
    def index(self) -> int | None:
        """Index of an element in its array; None if the place is not an element."""
        return self.steps[-1].element

    @property
    def width(self) -> int:
        """Width in bits; of an array, of all elements together."""
        return self.bits * (self.count or 1)

    @property
    def byte_order(self) -> str:
        """Byte order that the node or an owner declares; empty if the default of the
        ICD node applies.
        """
        return self.declared_orders.byte

    @property
    def bit_order(self) -> str:
        """Bit order that the node or an owner declares; empty if the default of the ICD
        node applies.
        """
        return self.declared_orders.bit

    @property
    def identifier(self) -> str | None:
        """Identifier that replaces the name in generated code, if the ICD gives one."""
        return self.node.identifier

    @property
    def summary(self) -> str:
        """Summary of the node."""
        return self.node.summary

    @property
    def aliases(self) -> tuple[str, ...]:
        """Other names that a search matches."""
        return self.node.aliases

    @property
    def errata(self) -> tuple[Erratum, ...]:
        """Errata of the node."""
        return self.node.errata

    @property
    def source(self) -> Map:
        """Mapping that the node was read from."""
        return self.node.source

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Conditions of an optional field: a frame has the field if all of them are
        met.
        """
        return self.node.present_if

    @property
    def is_read_only(self) -> bool:
        """Whether the node is an overlay field or a derived value, so it owns no bits."""
        return isinstance(self.node, _READ_ONLY)

    @property
    def derived(self) -> Derivation | None:
        """Computation of a derived value; None for any other node."""
        return self.node.derivation if isinstance(self.node, Derived) else None

    @property
    def role(self) -> Role:
        """Role of the scalar in a frame."""
        match self.node:
            case Overlay():
                return "overlay"
            case Derived():
                return "derived"
        return "count" if self.is_count else "field"

    @property
    def initial_value(self) -> int | bytes:
        """Raw value in a new message: see `Scalar.initial_value`."""
        return self.scalar.initial_value(self.bits, self.smallest_raw)

    def orders_in_effect(self, outer: Orders) -> Orders:
        """Return the orders in effect. `outer` are the defaults of the ICD node."""
        return self.declared_orders.within(outer)

    def element(self, index: int) -> NodePlace:
        """Return an element of an array, a struct as one place."""
        return NodePlace(
            (*self.steps[:-1], PathStep(self.node, index)),
            self.scalar,
            self.struct,
            self.at + index * self.bits,
            self.bits,
            self.declared_orders,
        )

    @property
    def first_element(self) -> NodePlace:
        """First element of an array; for any other node the place itself."""
        return self.element(0) if self.count else self

    def elements(self) -> tuple[NodePlace, ...]:
        """Return the elements of an array, a struct as one place; for any other node
        the place itself.
        """
        return tuple(map(self.element, range(self.count))) if self.count else (self,)

    def inner(self) -> tuple[NodePlace, ...]:
        """Return the places of the fields of a struct.

        For an array of structs, call it on an element.
        """
        assert self.struct is not None and not self.count, (
            f"{self.name} is not a single struct"
        )
        return tuple(
            _place_of_node(node, self.declared_orders, self.at, self.steps)
            for node in self.struct.fixed
        )

    @property
    def scalar_count(self) -> int:
        """Number of places that `scalars` yields."""
        scalars = 1 if self.struct is None else scalar_count(self.struct)
        return scalars * (self.count or 1)

    def scalars(self) -> Iterator[NodePlace]:
        """Yield all scalars of the node: each array element and each field of a struct
        separately.
        """
        for element in self.elements():
            if element.struct is None:
                yield element
            else:
                for place in element.inner():
                    yield from place.scalars()


AnyScalar: TypeAlias = Scalar | FrameField | NodePlace
"""An object that gives a raw value its meaning: type, width, enumeration, unit, scale."""


@cached_by_owner
def places_in(layout: Layout) -> tuple[NodePlace, ...]:
    """Return the nodes of a message in the longest frame, in the order of
    `Layout.nodes`.

    A count that follows from the length of the frame comes directly after its array.
    """
    return _places(layout, UNDECLARED)


@cached_by_owner
def scalars_in(layout: Layout) -> tuple[NodePlace, ...]:
    """Return all scalars of the longest frame: each array element and each field of a
    struct separately.
    """
    return tuple(scalar for place in places_in(layout) for scalar in place.scalars())


@cached_by_owner
def scalar_count(layout: Layout) -> int:
    """Return the number of scalars of the longest frame: of `scalars_in`."""
    return sum(place.scalar_count for place in places_in(layout))


def raw_fields_in(layout: Layout) -> tuple[NodePlace, ...]:
    """Return the scalars of the longest frame with a raw value: all except overlay
    fields and derived values.
    """
    return tuple(scalar for scalar in scalars_in(layout) if not scalar.is_read_only)


def places_of(layout: Layout, outer: Orders) -> tuple[NodePlace, ...]:
    """Return the places of the nodes of a layout, as `places_in`, but with orders
    inherited from `outer`.
    """
    return places_in(layout) if outer == UNDECLARED else _places(layout, outer)


def _places(layout: Layout, outer: Orders) -> tuple[NodePlace, ...]:
    orders = layout.orders.within(outer)
    places = [
        _place_of_node(
            node, orders, smallest_raw=layout.smallest_raw_of_counter(node.name)
        )
        for node in layout.fixed
    ]
    end, parts = 8 * layout.length, iter(layout.parts)
    for node in layout.sequence:
        if not is_variable(node):
            # In the ICD, `at` of these nodes is the end of the fixed part, which
            # `_place_of_node` adds.
            places.append(_place_of_node(node, orders, end - node.at))
            end += bits_of_node(node)
            continue
        part, size, at = next(parts), size_of(node), end
        own, steps = node.orders.within(orders), (PathStep(node),)
        if isinstance(node, Array):
            places.append(_place_of_item(steps, node.item, at, own, part.most))
        else:
            places.append(NodePlace(steps, node, None, at, 8 * part.most, own))
        end = 8 * part.end
        # The count has no bits. It is placed at the end of the array, so that it sorts
        # directly after it.
        if isinstance(size, Rest):
            counter = size.counter
            places.append(
                NodePlace(
                    (PathStep(counter),),
                    counter,
                    None,
                    end,
                    counter.bits,
                    UNDECLARED,
                    is_count=True,
                )
            )
    places += (
        _place_of_node(node, UNDECLARED, 8 * layout.longest) for node in layout.derived
    )
    return tuple(places)


def _place_of_node(
    node: LayoutNode,
    orders: Orders,
    begin: int = 0,
    owners: tuple[PathStep, ...] = (),
    smallest_raw: int = 0,
) -> NodePlace:
    """Return the place of a node of fixed size in a frame, struct or element that
    begins at bit `begin`.
    """
    own = node.orders.within(orders)
    at = begin + node.at
    steps = (*owners, PathStep(node))
    match node:
        case Array(item=item, most=count):
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
    """Return the place of a scalar or struct, or of an array of `count` elements if
    `count` is not 0.
    """
    scalar, struct = (
        (item, None) if isinstance(item, Scalar) else (_NO_SCALAR, item.layout)
    )
    return NodePlace(
        steps, scalar, struct, at, stride(item), orders, count, smallest_raw
    )
