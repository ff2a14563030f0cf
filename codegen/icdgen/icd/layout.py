"""Layout of a message or a struct as a tree with one node per line of the ICD.

`icdgen.icd.build` makes the nodes from the mappings of a file. `walk` visits all declarations.
Nodes store positions and orders as the ICD declares them. Orders in effect are resolved on the way down, because messages
of different orders can use the same struct.

Read next: `icdgen.icd.places` for the longest frame, `icdgen.icd.frames` for a frame of given sizes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from fractions import Fraction
from math import gcd
from typing import Any, NamedTuple, TypeAlias

from icdgen.frozen import dataclass
from icdgen.icd.curve import Curve, has_inverse
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
    """A raw value with a special meaning, such as 0xFFFF for 'no time-out', or NaN for 'not available'."""

    value: int  # of a float: its IEEE 754 bits
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
    """Byte order and bit order that one mapping of the ICD declares; empty if it declares none."""

    byte: str = ""  # little | big
    bit: str = ""  # lsb0 | msb0

    def within(self, outer: Orders) -> Orders:
        """Return the orders in effect: an undeclared order is inherited from `outer`."""
        # Most lines of an ICD declare no order.
        if self is UNDECLARED:
            return outer
        return Orders(self.byte or outer.byte, self.bit or outer.bit)


UNDECLARED = Orders()


@dataclass(frozen=True, slots=True)
class Counted:
    """Number of elements that a field of the fixed part counts: its raw value plus `plus`."""

    counter: str  # name of the field
    most: int  # elements
    plus: int = 0


@dataclass(frozen=True, slots=True)
class Rest:
    """Number of elements that follows from the length of the frame."""

    counter: Scalar  # without bits in the frame; generated code has a member for it
    most: int  # elements


Size: TypeAlias = "int | Counted | Rest"


@dataclass(frozen=True, slots=True, kw_only=True)
class LayoutNode:
    """A line of the ICD: attributes that all kinds of nodes have."""

    name: str
    # First bit in the layout, counted in its own bit order; in a sequence: the end of
    # the fixed part.
    at: int = 0
    identifier: str | None = None
    aliases: tuple[str, ...] = ()  # other names that a search matches
    summary: str = ""
    orders: Orders = UNDECLARED
    present_if: tuple[Condition, ...] = ()
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)


def integer_range(bits: int, is_signed: bool) -> tuple[int, int]:
    """Return the smallest and largest value of an integer of this width."""
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if is_signed else (0, (1 << bits) - 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scalar(LayoutNode):
    """A number, flag, enumeration value, byte string or text of `bits` bits."""

    type: str  # uint | int | bool | enum | float | bytes | text
    bits: int  # 8 for bytes and text of variable length
    # Number of bytes of variable-length bytes and text.
    length: Counted | Rest | None = None
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
        """Return whether the raw value is a two's complement number."""
        return self.type == "int" or (self.enum is not None and self.enum.signed)

    @property
    def is_bytes(self) -> bool:
        """Return whether the raw value is bytes and not a number."""
        return self.type in ("bytes", "text")

    @property
    def unit_symbol(self) -> str:
        """Return the symbol of the unit; empty if the scalar has no unit."""
        return self.unit.symbol if self.unit else ""

    @property
    def raw_min(self) -> int:
        """Return the smallest raw value. Not for floats."""
        return -(1 << (self.bits - 1)) if self.is_signed else 0

    @property
    def raw_max(self) -> int:
        """Return the largest raw value. Not for floats."""
        return (1 << (self.bits - self.is_signed)) - 1

    def initial_value(self, bits: int, smallest_raw: int) -> int | bytes:
        """Return the raw value in a new message: the constant, else the smallest valid value; of a float its bits.

        `bits` are those in the frame. `smallest_raw` comes from `Layout.smallest_raw`.
        """
        return bytes(bits // 8) if self.is_bytes else self.const or smallest_raw

    @property
    def has_formula(self) -> bool:
        """Return whether the physical value is computed from the raw value."""
        return self.scale is not None or self.curve is not None

    @property
    def is_invertible(self) -> bool:
        """Return whether each physical value has one nearest raw value; some lookup tables and polynomials fail this."""
        return self.curve is None or has_inverse(self.curve, self.type == "float", self.raw_min, self.raw_max)

    @property
    def settable_raws(self) -> tuple[int, int]:
        """Return the smallest and the largest raw value that a physical value can be converted to."""
        raws = self.raw_min, self.raw_max
        return raws if self.curve is None or self.type == "float" else self.curve.invertible_raws(*raws)


@dataclass(frozen=True, slots=True, kw_only=True)
class StructRef(LayoutNode):
    """Use of a struct in a message or in another struct; all uses share the layout of the struct."""

    layout: Layout


@dataclass(frozen=True, slots=True, kw_only=True)
class Array(LayoutNode):
    """Array of scalars or structs, contiguous in the frame."""

    item: Scalar | StructRef  # at bit 0 of an element
    size: Size


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay(LayoutNode):
    """Overlay field: a number that reads bits of other fields."""

    scalar: Scalar


@dataclass(frozen=True, slots=True, kw_only=True)
class Derived(LayoutNode):
    """Derived value: a double that is computed from other fields and has no bits in the frame."""

    scalar: Scalar  # a 64-bit float
    derivation: Derivation


FixedNode: TypeAlias = Scalar | Array | StructRef | Overlay


VariableNode: TypeAlias = Scalar | Array


@dataclass(frozen=True)
class Layout:
    """Nodes of a message or of a struct. A struct has fixed nodes only."""

    name: str
    length: int  # bytes of the fixed part
    fixed: tuple[FixedNode, ...]  # at fixed bits, in the order of the ICD
    sequence: tuple[VariableNode, ...] = ()  # behind the fixed part, contiguous
    derived: tuple[Derived, ...] = ()
    orders: Orders = UNDECLARED  # as the message declares them
    may_end_early: bool = False
    owner: str = ""  # name of the ICD node that declares it

    @cached_property
    def nodes(self) -> tuple[LayoutNode, ...]:
        """All nodes, in the order of their declarations in generated code."""
        return (*self.fixed, *self.sequence, *self.derived)

    @property
    def longest(self) -> int:
        """Length of the longest frame in bytes."""
        return self.length + sum(part.most * part.step for part in self.parts)

    @property
    def shortest(self) -> int:
        """Length of the shortest frame in bytes; at least 1 if frames may end early, unless the message is empty."""
        shortest = self.length + sum(part.fewest * part.step for part in self.parts)
        return min(1, shortest) if self.may_end_early else shortest

    @property
    def lengths(self) -> range:
        """Possible lengths of a frame in bytes. With several variable parts, it includes lengths that no counters give."""
        # gcd() of no arguments is 0, and a range needs a step.
        step = gcd(*(part.step for part in self.parts)) or 1
        return range(self.shortest, self.longest + 1, step)

    @cached_property
    def parts(self) -> tuple[VariablePart, ...]:
        """Variable-length parts, in the order of the frame."""
        parts: list[VariablePart] = []
        begin = self.length
        for node in self.sequence:
            size, step = size_of(node), stride(node) // 8
            is_rest = isinstance(size, Rest)
            counter, plus = (size.counter.name, 0) if isinstance(size, Rest) else (size.counter, size.plus)
            parts.append(VariablePart(node, counter, is_rest, begin, step, size.most, plus))
            # Positions are those in the longest frame, in which each part has its most
            # elements.
            begin += size.most * step
        return tuple(parts)

    def smallest_raw(self, counter: str) -> int:
        """Return the smallest raw value of a field that counts; 0 for any other field."""
        if not self.sequence:
            return 0
        return max((part.low for part in self.parts if part.counter == counter), default=0)


class VariablePart(NamedTuple):
    """Variable-length array, bytes or text of a message, at its position in the longest frame.

    A frame can have fewer elements than `most`. Generated code sets absent elements to 0 when it decodes a frame.
    """

    node: VariableNode
    counter: str  # name of the field that counts the elements
    # The counter has no bits: its value follows from the length of the frame.
    is_rest: bool
    begin: int  # offset in bytes
    step: int  # bytes of an element
    most: int  # elements
    plus: int  # number of elements minus value of the counter

    @property
    def name(self) -> str:
        """Name of the node."""
        return self.node.name

    @property
    def is_array(self) -> bool:
        """Whether the part is an array, not bytes or text."""
        return isinstance(self.node, Array)

    @property
    def fewest(self) -> int:
        """Smallest number of elements."""
        return max(0, self.plus)

    @property
    def low(self) -> int:
        """Smallest value of the counter."""
        return max(0, -self.plus)

    @property
    def high(self) -> int:
        """Largest value of the counter."""
        return self.most - self.plus

    @property
    def shortest(self) -> int:
        """Offset of its end in bytes if it has the fewest elements and all parts before it have the most."""
        return self.begin + self.fewest * self.step

    @property
    def lengths(self) -> range:
        """Offsets that its end can have in bytes if all parts before it have the most elements."""
        return range(self.shortest, self.begin + self.most * self.step + 1, self.step)


def size_of(node: VariableNode) -> Counted | Rest:
    """Return the size of a node of `Layout.sequence`."""
    size = node.size if isinstance(node, Array) else node.length
    assert isinstance(size, Counted | Rest), "a sequence has nodes of variable length only"
    return size


def stride(node: LayoutNode) -> int:
    """Return the distance of array elements in bits; the width of any other node. Raises `TypeError` for derived values."""
    match node:
        case Array(item=item):
            return stride(item)
        case StructRef(layout=layout):
            return 8 * layout.length
        case Scalar(bits=bits) | Overlay(scalar=Scalar(bits=bits)):
            return bits
    raise TypeError(f"{node.name} has no bits")


def overlay_of(scalar: Scalar) -> Overlay:
    """Return the overlay node of a scalar. Both have the same name and position."""
    return Overlay(scalar=scalar, **_attributes(scalar))


def derived_of(scalar: Scalar, derivation: Derivation) -> Derived:
    """Return the derived node of a scalar. Both have the same name."""
    return Derived(scalar=scalar, derivation=derivation, **_attributes(scalar))


def _attributes(node: LayoutNode) -> dict[str, Any]:
    """Return the attributes of `LayoutNode`, which all kinds of nodes have."""
    return {name: getattr(node, name) for name in LayoutNode.__dataclass_fields__}


def scalar_of(node: LayoutNode) -> Scalar | None:
    """Return the scalar of a node, or of an element of an array of scalars; None for structs."""
    match node:
        case Scalar():
            return node
        case Overlay(scalar=scalar) | Derived(scalar=scalar) | Array(item=Scalar() as scalar):
            return scalar
    return None


def struct_layout_of(node: LayoutNode) -> Layout | None:
    """Return the layout of the struct that a node, or an element of an array, refers to; None for scalars."""
    item = node.item if isinstance(node, Array) else node
    return item.layout if isinstance(item, StructRef) else None


def counter_of_rest(name: str, identifier: str | None, is_array: bool, most: int, source: Map) -> Scalar:
    """Return the scalar that counts the elements of `name` if the length of the frame is their only counter.

    Generated code has a member of this name, such as ``Records Count``, or ``Text Size`` for bytes and text.
    """
    noun = "Count" if is_array else "Size"
    return Scalar(
        name=f"{name} {noun}",
        identifier=f"{identifier} {noun}" if identifier else None,
        type="uint",
        bits=8 if most < 256 else 16,
        source=source,
    )


class Visit(NamedTuple):
    """A node that `walk` visits."""

    node: LayoutNode
    # Arrays and struct references that contain it, the outermost first.
    owners: tuple[LayoutNode, ...]
    orders: Orders  # in effect


def walk(layout: Layout, orders: Orders, owners: tuple[LayoutNode, ...] = ()) -> Iterator[Visit]:
    """Visit each line of the ICD once. The nodes of a struct follow the node that refers to it.

    `orders` are the defaults of the ICD node.
    """
    orders = layout.orders.within(orders)
    for node in layout.nodes:
        own = node.orders.within(orders)
        yield Visit(node, owners, own)
        inner = struct_layout_of(node)
        # The fields of a struct are visited for each use of it, because orders in
        # effect can differ.
        if inner is not None:
            yield from walk(inner, own, (*owners, node))
