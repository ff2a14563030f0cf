"""Layout of a message or a struct as a tree with one node per line of the ICD.

A `LayoutNode` is a field, an array or another line of a layout. It is not a `Node` of
`icdgen.icd.model`, which is a device.

`icdgen.icd.build` makes the nodes from the mappings of a file.
`icdgen.icd.layout_nodes.walk` visits all declarations. Nodes store positions and orders
as the ICD declares them. Orders in effect are resolved on the way down, because
messages of different orders can use the same struct.

Read next: `icdgen.icd.places` for the longest frame, `icdgen.icd.frames` for a frame of
given sizes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from math import gcd
from typing import TypeAlias, TypeGuard

from icdgen.frozen import NamedTuple, dataclass
from icdgen.icd.curve import Curve, has_inverse
from icdgen.icd.derived import Derivation
from icdgen.icd.display import Display
from icdgen.icd.enumeration import Enum
from icdgen.icd.erratum import Erratum
from icdgen.icd.formula import Scale
from icdgen.icd.located import Map, unread
from icdgen.icd.meanings import Limits, Special
from icdgen.icd.units import Unit
from icdgen.once import cached_property

Sizes: TypeAlias = Mapping[str, int]
"""Number of elements, or of bytes, of each variable-length node of one frame, by
`VariablePart.name` and `inner_name`.
"""


@dataclass(frozen=True, slots=True)
class Condition:
    """Requirement of an optional field: another field has one of these raw values."""

    field: str
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Orders:
    """Byte order and bit order that one mapping of the ICD declares; empty if it
    declares none.
    """

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
    """Number of elements that another field counts: its raw value plus `plus`. Also of
    an array in a struct: the field is in the message, not in the struct.
    """

    counter: str  # name of the field (`Rest.counter` is the field itself)
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
    # First bit in the layout, counted in its own bit order. All nodes of the `sequence`
    # of a message have the end of the fixed part here; their positions follow from
    # `Layout.parts`.
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
    return (
        (-(1 << bits - 1), (1 << bits - 1) - 1) if is_signed else (0, (1 << bits) - 1)
    )


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
        """Return the raw value in a new message: the constant; for a field that counts
        elements, its smallest valid value; else 0. For a float, the raw value is its
        bit pattern. For bytes and text, return zero bytes.

        ``bits`` is the width of the field in the frame, ``smallest_raw`` the result of
        `Layout.smallest_raw_of_counter`.
        """
        # For a constant 0, `smallest_raw` is 0, too: a counter cannot be a constant.
        return bytes(bits // 8) if self.is_bytes else self.const or smallest_raw

    @property
    def has_formula(self) -> bool:
        """Return whether the physical value is computed from the raw value."""
        return self.scale is not None or self.curve is not None

    @property
    def is_invertible(self) -> bool:
        """Return whether each physical value has one nearest raw value; some lookup
        tables and polynomials fail this.
        """
        return self.curve is None or has_inverse(
            self.curve, self.type == "float", self.raw_min, self.raw_max
        )

    @property
    def settable_raws(self) -> tuple[int, int]:
        """Return the smallest and the largest raw value that a physical value can be
        converted to.
        """
        raws = self.raw_min, self.raw_max
        return (
            raws
            if self.curve is None or self.type == "float"
            else self.curve.invertible_raws(*raws)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class StructRef(LayoutNode):
    """Use of a struct in a message or in another struct; all uses share the layout of
    the struct.
    """

    layout: Layout


@dataclass(frozen=True, slots=True, kw_only=True)
class Array(LayoutNode):
    """Array of scalars or structs, contiguous in the frame."""

    item: Scalar | StructRef  # at bit 0 of an element
    size: Size

    @property
    def most(self) -> int:
        """Number of elements, of an array of variable length the greatest."""
        return self.size if isinstance(self.size, int) else self.size.most


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay(LayoutNode):
    """Overlay field: a number that reads bits of other fields."""

    scalar: Scalar


@dataclass(frozen=True, slots=True, kw_only=True)
class Derived(LayoutNode):
    """Derived value: a double that is computed from other fields and has no bits in the
    frame.
    """

    scalar: Scalar  # a 64-bit float
    derivation: Derivation


PlacedNode: TypeAlias = Scalar | Array | StructRef | Overlay


VariableNode: TypeAlias = Scalar | Array


@dataclass(frozen=True)
class Layout:
    """Nodes of a message or of a struct.

    In a message, the sequence begins with the first node of variable length. Nodes of
    fixed size can follow it.

    A struct has no `sequence`: its arrays of variable length are in `fixed`, placed as
    in the longest element, with the nodes behind them. `inner_parts` lists these
    arrays.
    """

    name: str
    length: int  # bytes of the fixed part
    fixed: tuple[PlacedNode, ...]  # at fixed bits, in the order of the ICD
    sequence: tuple[PlacedNode, ...] = ()  # behind the fixed part, contiguous
    derived: tuple[Derived, ...] = ()
    orders: Orders = UNDECLARED  # as the message declares them
    may_end_early: bool = False
    owner: str = ""  # name of the device (`icdgen.icd.model.Node`) that declares it

    @cached_property
    def nodes(self) -> tuple[LayoutNode, ...]:
        """All nodes, in the order of their declarations in generated code."""
        return (*self.fixed, *self.sequence, *self.derived)

    @cached_property
    def fixed_length(self) -> int:
        """Number of bytes that every frame has outside its variable parts."""
        return self.length + sum(part.behind for part in self.parts)

    @cached_property
    def longest(self) -> int:
        """Length of the longest frame in bytes."""
        return self.fixed_length + sum(part.most * part.step for part in self.parts)

    @property
    def shortest(self) -> int:
        """Length of the shortest frame in bytes. If frames may end early: 1, or 0 if it
        would be 0 anyway.
        """
        shortest = self.fixed_length + sum(
            part.fewest * part.shortest_step for part in self.parts
        )
        return min(1, shortest) if self.may_end_early else shortest

    @property
    def lengths(self) -> range:
        """Possible lengths of a frame in bytes.

        With several variable parts, it includes lengths that no counters give.
        """
        # gcd() of no arguments is 0, and a range needs a step.
        step = gcd(*(step for part in self.parts for step in part.steps)) or 1
        return range(self.shortest, self.longest + 1, step)

    @cached_property
    def parts(self) -> tuple[VariablePart, ...]:
        """Variable-length parts, in the order of the frame."""
        parts: list[VariablePart] = []
        begin = self.length
        for node in self.sequence:
            if not is_variable(node):
                parts[-1] = parts[-1]._replace(
                    behind=parts[-1].behind + bits_of_node(node) // 8
                )
                begin += bits_of_node(node) // 8
                continue
            size, step = size_of(node), stride(node) // 8
            if isinstance(size, Rest):
                counter, plus, is_rest = size.counter.name, 0, True
            else:
                counter, plus, is_rest = size.counter, size.plus, False
            parts.append(
                VariablePart(node, counter, is_rest, begin, step, size.most, plus)
            )
            # Positions are those in the longest frame, in which each part has its most
            # elements.
            begin += size.most * step
        return tuple(parts)

    @cached_property
    def inner_parts(self) -> tuple[VariablePart, ...]:
        """Arrays of variable length in a struct, at their positions in its longest
        element.
        """
        parts: list[VariablePart] = []
        for node in self.fixed:
            if isinstance(node, Array) and isinstance(size := node.size, Counted):
                begin, step = node.at // 8, stride(node) // 8
                parts.append(
                    VariablePart(
                        node, size.counter, False, begin, step, size.most, size.plus
                    )
                )
        return tuple(parts)

    @cached_property
    def parts_by_size(self) -> dict[str, VariablePart]:
        """Variable-length parts of a frame, then the variable-length arrays in the
        elements of these parts, by the keys of `Sizes`.
        """
        parts = {part.name: part for part in self.parts}
        return parts | {
            part.inner_name(inner): inner for part in self.parts for inner in part.inner
        }

    @property
    def counted_parts(self) -> Iterable[VariablePart]:
        """Variable-length parts of a frame, then the variable-length arrays in the
        elements of these parts.
        """
        return self.parts_by_size.values()

    @property
    def initial_numbers(self) -> dict[str, int]:
        """Number of elements that have initial values in a new message: the fewest of
        the last part, all of other parts.
        """
        return {
            part.name: part.fewest if part is self.parts[-1] else part.most
            for part in self.parts
        }

    def smallest_raw_of_counter(self, counter: str) -> int:
        """Return the smallest raw value of a field that counts; 0 for any other field."""
        if not self.sequence:
            return 0
        return max(
            (part.low for part in self.counted_parts if part.counter == counter),
            default=0,
        )

    def largest_raw_of_counter(self, counter: str) -> int:
        """Return the largest raw value of a field that counts."""
        return min(part.high for part in self.counted_parts if part.counter == counter)

    @property
    def has_inner_gaps(self) -> bool:
        """Whether a frame can differ from the beginning of the longest frame: bytes can
        be absent between others, not only at the end.
        """
        return len(self.parts) > 1 or any(
            part.inner or part.behind for part in self.parts
        )

    def gaps(self, sizes: Sizes) -> Iterator[Gap]:
        """Yield the bytes of the longest frame that a frame of these sizes does not
        have, in order; also those at its end. A gap can have the length 0.
        """
        for part in self.parts:
            size = sizes[part.name]
            for begin in range(part.begin, part.begin + size * part.step, part.step):
                yield from (
                    Gap(begin + gap.begin, gap.length) for gap in part.gaps_of(sizes)
                )
            yield part.gap(size)

    def in_longest(self, frame: bytes, sizes: Sizes) -> bytes:
        """Return the longest frame with the bytes of a frame of these sizes at their
        positions; absent bytes are 0.
        """
        # In ascending order: each gap that is filled moves the bytes behind it to their
        # positions in the longest frame, which the next gap counts from.
        for gap in self.gaps(sizes):
            before = frame[: gap.begin].ljust(gap.begin, b"\0")
            frame = before + bytes(gap.length) + frame[gap.begin :]
        return frame.ljust(self.longest, b"\0")

    def part_of(self, node: LayoutNode) -> VariablePart | None:
        """Return the variable part of a node; None for any other node."""
        return next((part for part in self.parts if part.node is node), None)

    def part_in_front_of(self, node: LayoutNode) -> VariablePart | None:
        """Return the variable part behind which a node has no fixed position: the
        nearest one; None for a node of the fixed part, and for the first part.
        """
        front: VariablePart | None = None
        for other in self.sequence:
            if other is node:
                return front
            front = self.part_of(other) or front
        return None

    def size_of_frame(self, sizes: Sizes) -> int:
        """Return the length in bytes of a frame of these sizes."""
        return self.fixed_length + sum(
            sizes[part.name] * part.step_of(sizes) for part in self.parts
        )


class Gap(NamedTuple):
    """Bytes of the longest frame or element that a shorter one does not have."""

    begin: int  # offset in bytes
    length: int

    @property
    def end(self) -> int:
        """Offset of the first byte behind it."""
        return self.begin + self.length


class VariablePart(NamedTuple):
    """Variable-length array, bytes or text of a message, at its position in the longest
    frame.

    Its elements can have variable-length arrays themselves. All elements of a frame
    then have the same number of bytes. A frame can have fewer elements than `most`.
    Generated code sets absent elements to 0 when it decodes a frame.

    All offsets are in bytes of the longest frame; of an array in a struct, in bytes of
    its longest element.
    """

    node: VariableNode
    counter: str  # name of the field that counts the elements
    # The counter has no bits: its value follows from the length of the frame.
    is_rest: bool
    begin: int  # offset
    step: int  # bytes of an element with all that it can have
    most: int  # elements
    plus: int  # number of elements minus value of the counter
    behind: int = 0  # bytes of fields of fixed size directly behind it

    @property
    def name(self) -> str:
        """Name of the node."""
        return self.node.name

    @property
    def end(self) -> int:
        """Offset of the first byte behind it if it has the most elements."""
        return self.begin + self.most * self.step

    @property
    def is_array(self) -> bool:
        """Whether the part is an array, not bytes or text."""
        return isinstance(self.node, Array)

    @property
    def inner(self) -> tuple[VariablePart, ...]:
        """Variable-length arrays in an element, at their positions in the longest
        element.
        """
        struct = struct_layout_of(self.node)
        return () if struct is None else struct.inner_parts

    def inner_name(self, inner: VariablePart) -> str:
        """Return the key of `Sizes` for a variable-length array in the elements."""
        return f"{self.name}.{inner.name}"

    def step_of(self, sizes: Sizes) -> int:
        """Return the bytes of an element in a frame of these sizes."""
        return self.step - sum(gap.length for gap in self.gaps_of(sizes))

    def gaps_of(self, sizes: Sizes) -> tuple[Gap, ...]:
        """Return the bytes of the longest element that elements in a frame of these
        sizes do not have.
        """
        return tuple(inner.gap(sizes[self.inner_name(inner)]) for inner in self.inner)

    def gap(self, size: int) -> Gap:
        """Return the bytes of the longest frame that a part of ``size`` elements does
        not have.
        """
        return Gap(self.begin + size * self.step, (self.most - size) * self.step)

    @property
    def shortest_step(self) -> int:
        """Bytes of an element whose variable-length arrays have the fewest elements."""
        return self.step - sum(
            (inner.most - inner.fewest) * inner.step for inner in self.inner
        )

    @property
    def steps(self) -> tuple[int, ...]:
        """Numbers of bytes by which lengths of frames can differ: of the shortest
        element, and of an element of each array in it.
        """
        return self.shortest_step, *(inner.step for inner in self.inner)

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
    def end_if_fewest(self) -> int:
        """Offset of its end if it has the fewest elements and all parts before
        it have the most.
        """
        return self.begin + self.fewest * self.step

    @property
    def possible_ends(self) -> range:
        """Offsets that its end can have if all parts before it have the most
        elements.
        """
        return range(self.end_if_fewest, self.end + 1, self.step)


def is_variable(node: LayoutNode) -> TypeGuard[VariableNode]:
    """Return whether a node has a variable length."""
    match node:
        case Array(size=size):
            return not isinstance(size, int)
        case Scalar(length=length):
            return length is not None
    return False


def size_of(node: VariableNode) -> Counted | Rest:
    """Return the size of a node of variable length."""
    size = node.size if isinstance(node, Array) else node.length
    assert isinstance(size, Counted | Rest), "a node of variable length has a counter"
    return size


def bits_of_node(node: LayoutNode) -> int:
    """Return the width of a node in bits: of an array, of all elements together; of a
    variable-length array, of the most elements. Not for variable-length bytes and text.
    """
    return stride(node) * (node.most if isinstance(node, Array) else 1)


def stride(node: LayoutNode) -> int:
    """Return the distance of array elements in bits; the width of any other node.

    Raises `TypeError` for derived values.
    """
    match node:
        case Array(item=item):
            return stride(item)
        case StructRef(layout=layout):
            return 8 * layout.length
        case Scalar(bits=bits) | Overlay(scalar=Scalar(bits=bits)):
            return bits
    raise TypeError(f"{node.name} has no bits")


def scalar_of(node: LayoutNode) -> Scalar | None:
    """Return the scalar of a node, or of an element of an array of scalars; None for
    structs.
    """
    match node:
        case Scalar():
            return node
        case (
            Overlay(scalar=scalar)
            | Derived(scalar=scalar)
            | Array(item=Scalar() as scalar)
        ):
            return scalar
    return None


def struct_layout_of(node: LayoutNode) -> Layout | None:
    """Return the layout of the struct that a node, or an element of an array, refers
    to; None for scalars.
    """
    item = node.item if isinstance(node, Array) else node
    return item.layout if isinstance(item, StructRef) else None
