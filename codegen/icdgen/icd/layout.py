"""Layout of a message or a struct as a tree with one node per line of the ICD.

In: what `icdgen.icd.build` reads from the mappings of a file. Out: `walk` visits the declarations, `flatten` lists the
scalars of one frame with their bit positions. Positions and orders stay as the ICD declares them; `walk` and `flatten`
resolve the orders on the way down, because the same struct can stand in messages of different orders.

Read `icdgen.layout` next, which turns the position of a scalar into runs of bits of bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from math import gcd
from typing import Any, Literal, NamedTuple, TypeAlias

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

_KEPT_FRAMES = 64
"""Number of frame sizes per layout whose scalars are cached: a log repeats few sizes."""
_KEPT_SCALARS = 100_000
"""Number of scalars per layout in all these frames, about 50 MB: arrays can have thousands of elements."""

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

    @property
    def fewest(self) -> int:
        """Elements of the shortest frame."""
        return max(0, self.plus)


@dataclass(frozen=True, slots=True)
class Rest:
    """A size that only the length of the frame gives; `counter` is what code calls the number of elements."""

    counter: Scalar
    most: int

    @property
    def fewest(self) -> int:
        """Elements of the shortest frame: none."""
        return 0


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

    @cached_property
    def places(self) -> tuple[NodePlace, ...]:
        """The nodes where they stand in the longest frame, in the order of `nodes`; behind a variable part its count."""
        return places_of(self)

    @cached_property
    def scalars(self) -> tuple[NodePlace, ...]:
        """All scalars of the longest frame: each element of an array and each field of a struct by itself."""
        return tuple(scalar for place in self.places for scalar in place.scalars())

    @cached_property
    def raw_fields(self) -> tuple[NodePlace, ...]:
        """Those of `scalars` whose raw value a message has to give: all but overlays and derived values."""
        return tuple(scalar for scalar in self.scalars if not scalar.view)

    @property
    def longest(self) -> int:
        """Bytes of the longest frame."""
        return self.length + sum(size_of(node).most * stride(node) // 8 for node in self.sequence)

    @property
    def shortest(self) -> int:
        """Bytes of the shortest frame. A frame that may end early has at least one byte."""
        least = self.length + sum(size_of(node).fewest * stride(node) // 8 for node in self.sequence)
        return min(1, least) if self.may_end_early else least

    @property
    def lengths(self) -> range:
        """Lengths that frames can have; with several variable parts, also some that their counters exclude."""
        step = gcd(*(stride(node) // 8 for node in self.sequence)) or 1
        return range(self.shortest, self.longest + 1, step)

    def frame(self, orders: Orders, sizes: Sizes | None = None) -> tuple[FrameField, ...]:
        """Return the scalars of a frame, as `flatten` lists them; the last `_KEPT_FRAMES` results are kept."""
        key = orders, None if sizes is None or not self.sequence else tuple(sizes[node.name] for node in self.sequence)
        fields = self._frames.get(key)
        if fields is None:
            kept = sum(map(len, self._frames.values()))
            while self._frames and (len(self._frames) >= _KEPT_FRAMES or kept > _KEPT_SCALARS):
                kept -= len(self._frames.pop(next(iter(self._frames))))
            fields = self._frames[key] = tuple(flatten(self, orders, sizes))
        return fields

    @cached_property
    def _frames(self) -> dict[tuple[Orders, tuple[int, ...] | None], tuple[FrameField, ...]]:
        """The results of `frame`, the oldest first."""
        return {}

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
        sizes = (size_of(node) for node in self.sequence)
        plus = (size.plus for size in sizes if isinstance(size, Counted) and size.counter == counter)
        return max((-value for value in plus if value < 0), default=0)


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


@dataclass(frozen=True, slots=True)
class PathStep:
    """A node on the way to a scalar, and which element of it if it is an array."""

    node: LayoutNode
    element: int | None = None

    def text(self, name: str) -> str:
        """Return a name of the node with the element behind it: ``Satellites[2]``."""
        return name if self.element is None else f"{name}[{self.element}]"


def name_of_steps(steps: Sequence[PathStep]) -> str:
    """Return the name of what stands at the end of a path: ``Satellites[2].GNSS``."""
    return ".".join(step.text(step.node.name) for step in steps)


def alias_of_steps(steps: Sequence[PathStep]) -> str | None:
    """Return the name with identifiers in place of names; None if no node on the path has an identifier."""
    if not any(step.node.identifier for step in steps):
        return None
    return ".".join(step.text(step.node.identifier or step.node.name) for step in steps)


Role: TypeAlias = Literal["field", "overlay", "derived", "count"]
"""Role of a scalar in a frame: `count` is a number of elements that follows from the length of the frame, without bits."""


class OfScalar:
    """Something with a scalar. It has the attributes of the scalar that give a raw value its meaning."""

    scalar: Scalar

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
    def is_signed(self) -> bool:
        """See `Scalar.is_signed`."""
        return self.scalar.is_signed

    @property
    def has_formula(self) -> bool:
        """See `Scalar.has_formula`."""
        return self.scalar.has_formula

    @property
    def is_invertible(self) -> bool:
        """See `Scalar.is_invertible`."""
        return self.scalar.is_invertible

    @property
    def raw_min(self) -> int:
        """See `Scalar.raw_min`."""
        return self.scalar.raw_min

    @property
    def raw_max(self) -> int:
        """See `Scalar.raw_max`."""
        return self.scalar.raw_max

    @property
    def settable_raws(self) -> tuple[int, int]:
        """See `Scalar.settable_raws`."""
        return self.scalar.settable_raws


@dataclass(frozen=True, eq=False)
class FrameField(OfScalar):
    """A scalar where it stands in one frame. Compared by identity: `Layout.frame` makes each once."""

    steps: tuple[PathStep, ...]  # from the node of the message's own layout to the scalar
    at: int  # bit of the frame, counted in the bit order in effect
    bits: int  # of bytes and text those of the frame
    scalar: Scalar
    byte_order: str  # in effect
    bit_order: str  # in effect
    role: Role = "field"

    @cached_property
    def name(self) -> str:
        """``Satellites[2].GNSS``"""
        return name_of_steps(self.steps)

    @property
    def alias(self) -> str | None:
        """Return the name with identifiers in place of names; None if no node on the way has an identifier."""
        return alias_of_steps(self.steps)

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """It is in the frame only if all of them hold."""
        return self.scalar.present_if

    @property
    def has_bits(self) -> bool:
        """Whether it owns bits of the frame."""
        return self.role == "field"

    @property
    def is_raw(self) -> bool:
        """Return whether a raw value has to be given for it: it owns bits, or is the number of elements."""
        return self.role in ("field", "count")

    @property
    def derived(self) -> Derivation | None:
        """Return how a derived value is computed; None for any other role."""
        node = self.steps[-1].node
        return node.derivation if isinstance(node, Derived) else None


def flatten(layout: Layout, orders: Orders, sizes: Sizes | None = None) -> list[FrameField]:
    """List the scalars of a frame with these sizes; without sizes those of the longest frame.

    `orders` are those of the ICD node. `Layout.frame` keeps the result.
    """
    fields: list[FrameField] = []
    orders = layout.orders.within(orders)
    for node in layout.fixed:
        fields += _scalars(node, (PathStep(node),), node.at, node.orders.within(orders))
    end = 8 * layout.length
    for part in layout.sequence:
        size = size_of(part)
        number = size.most if sizes is None else sizes[part.name]
        own = part.orders.within(orders)
        if isinstance(part, Array):
            for element in range(number):
                fields += _scalars(part.item, (PathStep(part, element),), end + element * stride(part), own)
        else:
            fields.append(FrameField((PathStep(part),), end, 8 * number, part, own.byte, own.bit))
        end += number * stride(part)
        if isinstance(size, Rest):
            counter = size.counter
            fields.append(FrameField((PathStep(counter),), end, counter.bits, counter, own.byte, own.bit, "count"))
    for derived in layout.derived:
        scalar, step = derived.scalar, PathStep(derived)
        fields.append(FrameField((step,), end, scalar.bits, scalar, orders.byte, orders.bit, "derived"))
    return fields


def _scalars(node: FixedNode, steps: tuple[PathStep, ...], at: int, orders: Orders) -> Iterator[FrameField]:
    """List the scalars of a node of fixed size that begins at bit `at`."""
    match node:
        case Scalar(bits=bits):
            yield FrameField(steps, at, bits, node, orders.byte, orders.bit)
        case Overlay(scalar=scalar):
            yield FrameField(steps, at, scalar.bits, scalar, orders.byte, orders.bit, "overlay")
        case StructRef(layout=layout):
            for inner in layout.fixed:
                yield from _scalars(inner, (*steps, PathStep(inner)), at + inner.at, inner.orders.within(orders))
        case Array(item=item, size=int(count)):
            for element in range(count):
                steps_to = (*steps[:-1], PathStep(node, element))
                yield from _scalars(item, steps_to, at + element * stride(item), orders)


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
    def implied(self) -> bool:
        """Whether it has no bits, because the length of the frame tells its value."""
        return self.is_count

    @property
    def counts_from(self) -> int:
        """The smallest raw value, of a field that counts elements."""
        return self.smallest_raw

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


def places_of(layout: Layout, outer: Orders = UNDECLARED) -> tuple[NodePlace, ...]:
    """Return the places of the nodes of a layout. `outer` are the orders of what it stands in, if it is an element.

    `Layout.places` keeps those without `outer`.
    """
    orders = layout.orders.within(outer)
    found = [_place(node, orders, smallest_raw=layout.smallest_raw(node.name)) for node in layout.fixed]
    end = 8 * layout.length
    for part in layout.sequence:
        size, own, steps = size_of(part), part.orders.within(orders), (PathStep(part),)
        if isinstance(part, Array):
            found.append(_place_of_item(steps, part.item, end, own, size.most))
        else:
            found.append(NodePlace(steps, part, None, end, 8 * size.most, own))
        end += size.most * stride(part)
        if isinstance(size, Rest):
            counter = size.counter
            found.append(NodePlace((PathStep(counter),), counter, None, end, counter.bits, UNDECLARED, is_count=True))
    found += (_place(node, UNDECLARED, end) for node in layout.derived)
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
