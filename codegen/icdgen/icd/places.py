"""The nodes of a layout where they stand in the longest frame: what is declared, documented and generated.

In: the layout of a message or a struct. Out: `places` lists its nodes, arrays and structs as one; `NodePlace.elements` and
`NodePlace.inner` go further down. Frames of other sizes, as in a log, are lists of `icdgen.icd.layout.FrameField`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from icdgen.frozen import dataclass
from icdgen.icd.curve import Curve
from icdgen.icd.derived import Derivation
from icdgen.icd.display import Display
from icdgen.icd.enumeration import Enum
from icdgen.icd.erratum import Erratum
from icdgen.icd.formula import Scale
from icdgen.icd.layout import (
    UNDECLARED,
    Array,
    Condition,
    Counted,
    Derived,
    Layout,
    LayoutNode,
    Limits,
    Orders,
    Overlay,
    Rest,
    Scalar,
    Special,
    StructRef,
    size_of,
    stride,
)
from icdgen.icd.located import Map
from icdgen.icd.model import Field, Node
from icdgen.icd.units import Unit

_NO_SCALAR = Scalar(name="", type="struct", bits=0)
"""The scalar of a place where a struct stands."""


@dataclass(frozen=True, eq=False)
class NodePlace:
    """A node, or an element of an array, at its bit of the longest frame or of a struct."""

    node: LayoutNode
    scalar: Scalar  # that stands here; of an array that stands as one, an element of it
    struct: Layout | None  # that stands here instead of a scalar
    name: str  # from the message on: ``Satellites[2].GNSS``
    at: int  # counted in the bit order in effect
    bits: int  # of an array those of an element; of variable-length bytes and text the most
    declared_orders: Orders  # of the node or what it stands in; empty where those of the ICD node hold
    count: int = 0  # elements of an array that stands as one; else 0
    index: int | None = None  # which element of an array it is
    smallest_raw: int = 0  # of a field that counts elements
    is_count: bool = False  # it has no bits: the length of the frame tells its value
    owners: tuple[LayoutNode, ...] = ()  # arrays of structs and structs around it, the outermost first

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
    def implied(self) -> bool:
        """Whether it has no bits, because the length of the frame tells its value."""
        return self.is_count

    @property
    def counts_from(self) -> int:
        """The smallest raw value, of a field that counts elements."""
        return self.smallest_raw

    @property
    def type(self) -> str:
        """See `Scalar.type`."""
        return self.scalar.type

    @property
    def enum(self) -> Enum | None:
        """See `Scalar.enum`."""
        return self.scalar.enum

    @property
    def unit(self) -> Unit | None:
        """See `Scalar.unit`."""
        return self.scalar.unit

    @property
    def unit_symbol(self) -> str:
        """See `Scalar.unit_symbol`."""
        return self.scalar.unit_symbol

    @property
    def formula(self) -> str:
        """See `Scalar.formula`."""
        return self.scalar.formula

    @property
    def scale(self) -> Scale | None:
        """See `Scalar.scale`."""
        return self.scalar.scale

    @property
    def curve(self) -> Curve | None:
        """See `Scalar.curve`."""
        return self.scalar.curve

    @property
    def const(self) -> int | None:
        """See `Scalar.const`."""
        return self.scalar.const

    @property
    def special(self) -> tuple[Special, ...]:
        """See `Scalar.special`."""
        return self.scalar.special

    @property
    def limits(self) -> Limits | None:
        """See `Scalar.limits`."""
        return self.scalar.limits

    @property
    def display(self) -> Display | None:
        """See `Scalar.display`."""
        return self.scalar.display

    @property
    def is_bytes(self) -> bool:
        """See `Scalar.is_bytes`."""
        return self.scalar.is_bytes

    @property
    def has_formula(self) -> bool:
        """See `Scalar.has_formula`."""
        return self.scalar.has_formula

    @property
    def raw_min(self) -> int:
        """See `Scalar.raw_min`."""
        return self.scalar.raw_min

    @property
    def raw_max(self) -> int:
        """See `Scalar.raw_max`."""
        return self.scalar.raw_max

    @property
    def signed(self) -> bool:
        """See `Scalar.is_signed`."""
        return self.scalar.is_signed

    @property
    def leads_back(self) -> bool:
        """See `Scalar.is_invertible`."""
        return self.scalar.is_invertible

    @property
    def ends(self) -> tuple[int, int]:
        """See `Scalar.settable_raws`."""
        return self.scalar.settable_raws

    @property
    def fresh(self) -> int | bytes:
        """The raw value in a new message: the only valid one, or the smallest; of a float its bits."""
        return bytes(self.bits // 8) if self.is_bytes else self.const or self.smallest_raw

    def orders(self, node: Node) -> tuple[str, str]:
        """Byte order and bit order in effect; ``node`` is the ICD node that declares the message."""
        return self.byte_order or node.byte_order, self.bit_order or node.bit_order

    def elements(self) -> tuple[NodePlace, ...]:
        """Return the elements of an array, structs whole; of anything else the place itself."""
        if not self.count:
            return (self,)
        return tuple(
            NodePlace(
                self.node,
                self.scalar,
                self.struct,
                f"{self.name}[{index}]",
                self.at + index * self.bits,
                self.bits,
                self.declared_orders,
                index=index,
                owners=self.owners,
            )
            for index in range(self.count)
        )

    def inner(self) -> tuple[NodePlace, ...]:
        """Return the places of what stands in a struct; of an array of structs, take an element first."""
        assert self.struct is not None and not self.count, f"{self.name} is no single struct"
        owners = (*self.owners, self.node)
        return tuple(_place(node, self.declared_orders, self.at, f"{self.name}.", owners) for node in self.struct.fixed)

    def scalars(self) -> Iterator[NodePlace]:
        """Return all scalars that stand here, each element of an array and each field of a struct by itself."""
        for element in self.elements():
            if element.struct is None:
                yield element
            else:
                for place in element.inner():
                    yield from place.scalars()


def places(layout: Layout, outer: Orders = UNDECLARED) -> tuple[NodePlace, ...]:
    """Return the places of the nodes of a layout. `outer` are the orders of what it stands in, if it is an element."""
    orders = layout.orders.within(outer)
    found: list[NodePlace] = []
    counters = {
        size.counter for node in layout.sequence if isinstance(size := size_of(node), Counted) and size.plus < 0
    }
    for node in layout.fixed:
        smallest = layout.smallest_raw(node.name) if node.name in counters else 0
        found.append(_place(node, orders, smallest_raw=smallest))
    end = 8 * layout.length
    for part in layout.sequence:
        size, own = size_of(part), part.orders.within(orders)
        if isinstance(part, Array):
            found.append(_place_of_item(part, part.item, part.name, end, own, size.most))
        else:
            found.append(NodePlace(part, part, None, part.name, end, 8 * size.most, own))
        end += size.most * stride(part)
        if isinstance(size, Rest):
            counter = size.counter
            found.append(NodePlace(counter, counter, None, counter.name, end, counter.bits, UNDECLARED, is_count=True))
    found += (_place(node, UNDECLARED, begin=end) for node in layout.derived)
    return tuple(found)


def scalar_places(layout: Layout) -> tuple[NodePlace, ...]:
    """Return all scalars of the longest frame: each element of an array and each field of a struct by itself."""
    return tuple(scalar for place in places(layout) for scalar in place.scalars())


def _place(
    node: LayoutNode,
    orders: Orders,
    begin: int = 0,
    prefix: str = "",
    owners: tuple[LayoutNode, ...] = (),
    smallest_raw: int = 0,
) -> NodePlace:
    """Return the place of a node of fixed size in what begins at bit `begin`."""
    own, name, at = node.orders.within(orders), prefix + node.name, begin + node.at
    match node:
        case Array(item=item, size=int(count)):
            return _place_of_item(node, item, name, at, own, count, owners)
        case StructRef() | Scalar():
            return _place_of_item(node, node, name, at, own, 0, owners, smallest_raw)
        case Overlay(scalar=scalar):
            return NodePlace(node, scalar, None, name, at, scalar.bits, own)
        case Derived(scalar=scalar):
            return NodePlace(node, scalar, None, name, begin, scalar.bits, own)
    raise TypeError(f"{node.name} has no fixed place")


def _place_of_item(
    node: LayoutNode,
    item: Scalar | StructRef,
    name: str,
    at: int,
    orders: Orders,
    count: int,
    owners: tuple[LayoutNode, ...] = (),
    smallest_raw: int = 0,
) -> NodePlace:
    """Return the place of a scalar or struct, or of so many of them."""
    scalar, struct = (item, None) if isinstance(item, Scalar) else (_NO_SCALAR, item.layout)
    return NodePlace(
        node, scalar, struct, name, at, stride(item), orders, count, smallest_raw=smallest_raw, owners=owners
    )


AnyField: TypeAlias = Field | NodePlace
"""What functions about the value of a field take, until no module has the flat list of fields."""
