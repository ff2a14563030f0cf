"""Layout of a message or a struct as a tree with one node per line of the ICD.

In: what `icdgen.icd.build` reads from the mappings of a file. Out: nodes, and `walk`, which visits the declarations.
Positions and orders stay as the ICD declares them; orders are resolved on the way down, because the same struct can stand in
messages of different orders.

Read next: `icdgen.icd.places` for the longest frame, `icdgen.icd.frames` for one frame of certain sizes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from fractions import Fraction
from math import gcd
from typing import Any, NamedTuple, TypeAlias

from icdgen.frozen import dataclass
from icdgen.icd.curve import Curve, leads_back
from icdgen.icd.derived import Derivation
from icdgen.icd.display import Display
from icdgen.icd.enumeration import Enum
from icdgen.icd.erratum import Erratum
from icdgen.icd.formula import Scale
from icdgen.icd.located import Map, unread
from icdgen.icd.units import Unit
from icdgen.once import cached_property

Sizes: TypeAlias = Mapping[str, int]
"""Number of elements, or of bytes, of each variable-length node of one frame, by the name of the node."""


@dataclass(frozen=True, slots=True)
class Special:
    """A raw value with a meaning of its own, such as 0xFFFF for 'no time-out', or NaN for 'not known'."""

    value: int  # bits of the value if the scalar is a float
    meaning: str
    number: str = ""  # of a float: `nan`, `inf`, `-inf`, or the shortest decimal


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of the physical value (of the raw value if there is no scale); None where the ICD gives no bound."""

    min: Fraction | None = None
    max: Fraction | None = None
    above: Fraction | None = None
    below: Fraction | None = None


@dataclass(frozen=True, slots=True)
class Condition:
    """Requirement of an optional field: another field has one of these raw values."""

    field: str
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Orders:
    """Byte order and bit order as the ICD declares them in one place; empty where it declares none."""

    byte: str = ""  # little | big
    bit: str = ""  # lsb0 | msb0

    def within(self, outer: Orders) -> Orders:
        """Return the orders in effect: an order that is not declared here is taken from outside."""
        if self is UNDECLARED:  # most lines of an ICD declare none
            return outer
        return Orders(self.byte or outer.byte, self.bit or outer.bit)


UNDECLARED = Orders()


@dataclass(frozen=True, slots=True)
class Counted:
    """A size that a field of the fixed part gives: its raw value plus `plus`."""

    counter: str  # name of the field
    most: int
    plus: int = 0


@dataclass(frozen=True, slots=True)
class Rest:
    """A size that only the length of the frame gives; `counter` is what code calls the number of elements."""

    counter: Scalar
    most: int


Size: TypeAlias = "int | Counted | Rest"


@dataclass(frozen=True, slots=True, kw_only=True)
class LayoutNode:
    """A line of the ICD: the attributes that all kinds of nodes have."""

    name: str
    at: int = 0  # bit of its layout, counted in its own bit order; of a sequence, where the fixed part ends
    identifier: str | None = None
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    summary: str = ""
    orders: Orders = UNDECLARED
    present_if: tuple[Condition, ...] = ()
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scalar(LayoutNode):
    """A number, flag, enumeration value, byte string or text of `bits` bits."""

    type: str  # uint | int | bool | enum | float | bytes | text
    bits: int  # of variable-length bytes and text those of one byte
    length: Counted | Rest | None = None  # number of bytes of variable-length bytes and text
    enum: Enum | None = None
    unit: Unit | None = None
    formula: str = ""  # as printed
    scale: Scale | None = None
    curve: Curve | None = None
    const: int | None = None
    special: tuple[Special, ...] = ()
    limits: Limits | None = None
    display: Display | None = None

    @property
    def is_signed(self) -> bool:
        """Return whether the raw value is in two's complement."""
        return self.type == "int" or (self.enum is not None and self.enum.signed)

    @property
    def is_bytes(self) -> bool:
        """Return whether the raw value is bytes and not a number."""
        return self.type in ("bytes", "text")

    @property
    def unit_symbol(self) -> str:
        """Return the unit as it is written; empty without one."""
        return self.unit.symbol if self.unit else ""

    @property
    def raw_min(self) -> int:
        """Return the smallest raw value of a number that is no float."""
        return -(1 << (self.bits - 1)) if self.is_signed else 0

    @property
    def raw_max(self) -> int:
        """Return the largest raw value of a number that is no float."""
        return (1 << (self.bits - self.is_signed)) - 1

    @property
    def has_formula(self) -> bool:
        """Return whether the physical value is computed from the raw value."""
        return self.scale is not None or self.curve is not None

    @property
    def is_invertible(self) -> bool:
        """Return whether a physical value gives the nearest raw value; some curves do not."""
        return self.curve is None or leads_back(self.curve, self.type == "float", self.raw_min, self.raw_max)

    @property
    def settable_raws(self) -> tuple[int, int]:
        """Return the least and the largest raw value that setting a physical value can give."""
        every = self.raw_min, self.raw_max
        return every if self.curve is None or self.type == "float" else self.curve.ends(*every)


@dataclass(frozen=True, slots=True, kw_only=True)
class StructRef(LayoutNode):
    """A place where a struct stands; all places share its layout."""

    layout: Layout


@dataclass(frozen=True, slots=True, kw_only=True)
class Array(LayoutNode):
    """Elements of one kind, one after the other."""

    item: Scalar | StructRef  # at bit 0 of an element
    size: Size


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay(LayoutNode):
    """A number over bits that other nodes own."""

    scalar: Scalar


@dataclass(frozen=True, slots=True, kw_only=True)
class Derived(LayoutNode):
    """A double that is computed from the values of other nodes."""

    scalar: Scalar  # a 64-bit float without bits in the frame
    derivation: Derivation


FixedNode: TypeAlias = Scalar | Array | StructRef | Overlay


VariableNode: TypeAlias = Scalar | Array


@dataclass(frozen=True)
class Layout:
    """The nodes of a message or of a struct. A struct has fixed nodes only."""

    name: str
    length: int  # bytes of the fixed part
    fixed: tuple[FixedNode, ...]  # at fixed bits, in the order of the ICD
    sequence: tuple[VariableNode, ...] = ()  # behind the fixed part, one after the other
    derived: tuple[Derived, ...] = ()
    orders: Orders = UNDECLARED  # as the message declares them
    may_end_early: bool = False
    owner: str = ""  # name of the ICD node that declares it

    @cached_property
    def nodes(self) -> tuple[LayoutNode, ...]:
        """All nodes, in the order in which code declares them."""
        return (*self.fixed, *self.sequence, *self.derived)

    @property
    def longest(self) -> int:
        """Bytes of the longest frame."""
        return self.length + sum(part.most * part.step for part in self.parts)

    @property
    def shortest(self) -> int:
        """Bytes of the shortest frame. A frame that may end early has at least one byte."""
        least = self.length + sum(part.fewest * part.step for part in self.parts)
        return min(1, least) if self.may_end_early else least

    @property
    def lengths(self) -> range:
        """Lengths that frames can have; with several variable parts, also some that their counters exclude."""
        step = gcd(*(part.step for part in self.parts)) or 1
        return range(self.shortest, self.longest + 1, step)

    @cached_property
    def parts(self) -> tuple[VariablePart, ...]:
        """The parts of variable length, in the order of the frame."""
        parts: list[VariablePart] = []
        begin = self.length
        for node in self.sequence:
            size, step = size_of(node), stride(node) // 8
            is_rest = isinstance(size, Rest)
            counter, plus = (size.counter.name, 0) if isinstance(size, Rest) else (size.counter, size.plus)
            parts.append(VariablePart(node, counter, is_rest, begin, step, size.most, plus))
            begin += size.most * step
        return tuple(parts)

    def smallest_raw(self, counter: str) -> int:
        """Return the smallest raw value of a field that counts; 0 for any other field."""
        return max((part.low for part in self.parts if part.counter == counter), default=0)


class VariablePart(NamedTuple):
    """A part of a message of which a frame need not have all, where it stands in the longest frame.

    Elements that a frame lacks are 0 in what it is decoded to.
    """

    node: VariableNode
    counter: str  # the field that says how many elements there are
    is_rest: bool  # the counter has no bits: the length of the frame tells it
    begin: int  # bytes before it
    step: int  # bytes of an element
    most: int  # elements
    plus: int  # there are so many more elements than the counter says

    @property
    def name(self) -> str:
        """The name of its node."""
        return self.node.name

    @property
    def is_array(self) -> bool:
        """Whether it is an array, and not bytes or text."""
        return isinstance(self.node, Array)

    @property
    def fewest(self) -> int:
        """Elements that every frame has."""
        return max(0, self.plus)

    @property
    def low(self) -> int:
        """The smallest value of the counter."""
        return max(0, -self.plus)

    @property
    def high(self) -> int:
        """The largest value of the counter."""
        return self.most - self.plus

    @property
    def shortest(self) -> int:
        """Bytes up to its end with the fewest elements, if all is there before it."""
        return self.begin + self.fewest * self.step


def size_of(node: VariableNode) -> Counted | Rest:
    """Return the size of a node of a sequence."""
    size = node.size if isinstance(node, Array) else node.length
    assert isinstance(size, Counted | Rest), "a sequence has nodes of variable length only"
    return size


def stride(node: LayoutNode) -> int:
    """Return the bits from one element of an array to the next; the bits of any other node."""
    match node:
        case Array(item=item):
            return stride(item)
        case StructRef(layout=layout):
            return 8 * layout.length
        case Scalar(bits=bits) | Overlay(scalar=Scalar(bits=bits)):
            return bits
    raise TypeError(f"{node.name} has no bits")


def overlay_of(scalar: Scalar) -> Overlay:
    """Return the overlay that reads a scalar; both have the same name and position."""
    return Overlay(scalar=scalar, **_attributes(scalar))


def derived_of(scalar: Scalar, derivation: Derivation) -> Derived:
    """Return the node that computes a scalar; both have the same name."""
    return Derived(scalar=scalar, derivation=derivation, **_attributes(scalar))


def _attributes(node: LayoutNode) -> dict[str, Any]:
    """Return what all kinds of nodes have."""
    return {name: getattr(node, name) for name in LayoutNode.__dataclass_fields__}


def scalar_of(node: LayoutNode) -> Scalar | None:
    """Return the scalar that a node is, reads or computes, or that is an element of it; None for structs."""
    match node:
        case Scalar():
            return node
        case Overlay(scalar=scalar) | Derived(scalar=scalar) | Array(item=Scalar() as scalar):
            return scalar
    return None


def struct_layout_of(node: LayoutNode) -> Layout | None:
    """Return the layout of the struct that a node refers to; None if it refers to none."""
    item = node.item if isinstance(node, Array) else node
    return item.layout if isinstance(item, StructRef) else None


def counter_of_rest(name: str, identifier: str | None, is_array: bool, most: int, source: Map) -> Scalar:
    """Return the scalar by which code calls a number of elements, or bytes, that only the length of a frame gives."""
    noun = "Count" if is_array else "Size"
    return Scalar(
        name=f"{name} {noun}",
        identifier=f"{identifier} {noun}" if identifier else None,
        type="uint",
        bits=8 if most < 256 else 16,
        source=source,
    )


class Visit(NamedTuple):
    """A node on the way through a layout."""

    node: LayoutNode
    owners: tuple[LayoutNode, ...]  # arrays and struct references around it, the outermost first
    orders: Orders  # in effect here


def walk(layout: Layout, orders: Orders, owners: tuple[LayoutNode, ...] = ()) -> Iterator[Visit]:
    """Visit each line of the ICD once, the nodes of a struct behind the node that refers to it.

    `orders` are those of the ICD node.
    """
    orders = layout.orders.within(orders)
    for node in layout.nodes:
        own = node.orders.within(orders)
        yield Visit(node, owners, own)
        inner = struct_layout_of(node)
        if inner is not None:
            yield from walk(inner, own, (*owners, node))
