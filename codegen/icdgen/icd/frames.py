"""Scalars of one frame with their bits, for the codec, logs and the simulator.

`frame_fields` computes them from a layout and the sizes of its variable parts. Read
next: `icdgen.icd.pieces`, which converts the position of a scalar into runs of bits
within bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any, Literal, TypeAlias

from icdgen.frozen import dataclass
from icdgen.icd.curve import Curve
from icdgen.icd.derived import Derivation
from icdgen.icd.display import Display
from icdgen.icd.enumeration import Enum
from icdgen.icd.formula import Scale
from icdgen.icd.layout import (
    Array,
    Condition,
    Derived,
    Gap,
    Layout,
    LayoutNode,
    Orders,
    Overlay,
    PlacedNode,
    Rest,
    Scalar,
    Sizes,
    StructRef,
    bits_of_node,
    is_variable,
    size_of,
    stride,
)
from icdgen.icd.meanings import Limits, Special
from icdgen.icd.units import Unit
from icdgen.once import cached_by_owner, cached_property

# Limit of cached frames per layout, one for each combination of sizes: a log repeats
# few sizes.
_CACHED_FRAMES = 64

# Limit of scalars in all cached frames of a layout, about 50 MB: arrays can have
# thousands of elements.
_CACHED_SCALARS = 100_000


@dataclass(frozen=True, slots=True)
class PathStep:
    """A node on the path to a scalar; of an array, with the index of an element."""

    node: LayoutNode
    element: int | None = None

    def with_index(self, name: str) -> str:
        """Return a name of the node with the index of the element: ``Satellites[2]``."""
        return name if self.element is None else f"{name}[{self.element}]"


def name_of_steps(steps: Sequence[PathStep]) -> str:
    """Return the name of the node at the end of a path: ``Satellites[2].GNSS``."""
    return ".".join(step.with_index(step.node.name) for step in steps)


def alias_of_steps(steps: Sequence[PathStep]) -> str | None:
    """Return the name with identifiers instead of names; None if no node on the path
    has an identifier.
    """
    if not any(step.node.identifier for step in steps):
        return None
    return ".".join(
        step.with_index(step.node.identifier or step.node.name) for step in steps
    )


Role: TypeAlias = Literal["field", "overlay", "derived", "count"]
"""Role of a scalar in a frame.

A `count` is a number of elements without bits: it follows from the length of the frame.
"""


def forwarded(path: str) -> Any:
    """Return a property with the value of an attribute of an attribute:
    ``scalar.unit``.
    """
    return property(attrgetter(path))


class OfScalar:
    """Base of classes that have a scalar, with the attributes of the scalar that give a
    raw value its meaning.
    """

    scalar: Scalar
    type: str = forwarded("scalar.type")
    enum: Enum | None = forwarded("scalar.enum")
    unit: Unit | None = forwarded("scalar.unit")
    unit_symbol: str = forwarded("scalar.unit_symbol")
    formula: str = forwarded("scalar.formula")
    scale: Scale | None = forwarded("scalar.scale")
    curve: Curve | None = forwarded("scalar.curve")
    const: int | None = forwarded("scalar.const")
    special: tuple[Special, ...] = forwarded("scalar.special")
    limits: Limits | None = forwarded("scalar.limits")
    display: Display | None = forwarded("scalar.display")
    is_bytes: bool = forwarded("scalar.is_bytes")
    is_signed: bool = forwarded("scalar.is_signed")
    has_formula: bool = forwarded("scalar.has_formula")
    is_invertible: bool = forwarded("scalar.is_invertible")
    raw_min: int = forwarded("scalar.raw_min")
    raw_max: int = forwarded("scalar.raw_max")
    settable_raws: tuple[int, int] = forwarded("scalar.settable_raws")


@dataclass(frozen=True, eq=False)
class FrameField(OfScalar):
    """A scalar at its position in one frame.

    Compared by identity: `frame_fields` caches the objects.
    """

    steps: tuple[PathStep, ...]  # path from the layout of the message to the scalar
    at: int  # first bit in the frame, counted in the bit order in effect
    bits: int  # of variable-length bytes and text: in this frame
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
        """Return the name with identifiers instead of names; None if no node on the
        path has an identifier.
        """
        return alias_of_steps(self.steps)

    @property
    def width(self) -> int:
        """Width in bits, as `NodePlace.width`."""
        return self.bits

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Conditions of an optional field: a frame has the field if all of them are
        met.
        """
        return self.scalar.present_if

    @property
    def has_bits(self) -> bool:
        """Whether the field owns bits of the frame."""
        return self.role == "field"

    @property
    def is_raw(self) -> bool:
        """Return whether a message needs a raw value for the field: it owns bits, or
        counts elements.
        """
        return self.role in ("field", "count")

    @property
    def derived(self) -> Derivation | None:
        """Return the computation of a derived value; None for any other role."""
        node = self.steps[-1].node
        return node.derivation if isinstance(node, Derived) else None


def frame_fields(
    layout: Layout, orders: Orders, sizes: Sizes | None = None
) -> tuple[FrameField, ...]:
    """Return the scalars of a frame as `flatten` lists them.

    Caches the last results of each layout.
    """
    frames = _frames(layout)
    numbers: tuple[int, ...] | None = None
    if sizes is not None and layout.sequence:
        numbers = tuple(map(sizes.__getitem__, layout.parts_by_size))
    key = (orders, numbers)
    fields = frames.get(key)
    if fields is None:
        cached_scalars = sum(map(len, frames.values()))
        # Remove the oldest entries first: a dict preserves the order of insertion.
        while frames and (
            len(frames) >= _CACHED_FRAMES or cached_scalars > _CACHED_SCALARS
        ):
            cached_scalars -= len(frames.pop(next(iter(frames))))
        fields = frames[key] = tuple(flatten(layout, orders, sizes))
    return fields


def fixed_fields(layout: Layout, orders: Orders) -> tuple[FrameField, ...]:
    """Return the scalars whose positions do not depend on the frame: scalars of the
    fixed part, counts and derived values.
    """
    # Zero elements need not be a valid size here: only nodes behind the fixed part
    # would have other positions.
    fields = frame_fields(layout, orders, dict.fromkeys(layout.parts_by_size, 0))
    sequence = set(map(id, layout.sequence))
    return tuple(field for field in fields if id(field.steps[0].node) not in sequence)


@cached_by_owner
def _frames(
    layout: Layout,
) -> dict[tuple[Orders, tuple[int, ...] | None], tuple[FrameField, ...]]:
    """Return the cache of `frame_fields`, the oldest entry first."""
    return {}


def flatten(
    layout: Layout, orders: Orders, sizes: Sizes | None = None
) -> list[FrameField]:
    """List the scalars of a frame with these sizes, or of the longest frame.

    `orders` are the defaults of the ICD node.
    """
    fields: list[FrameField] = []
    orders = layout.orders.within(orders)
    for node in layout.fixed:
        fields += _scalars(node, (PathStep(node),), node.at, node.orders.within(orders))
    # Nodes of the sequence begin at whole bytes, where both bit orders count the same.
    end, parts = 8 * layout.length, iter(layout.parts)
    for node in layout.sequence:
        own = node.orders.within(orders)
        if not is_variable(node):
            fields += _scalars(node, (PathStep(node),), end, own)
            end += bits_of_node(node)
            continue
        part, size = next(parts), size_of(node)
        number = size.most if sizes is None else sizes[part.name]
        gaps = () if sizes is None else part.gaps_of(sizes)
        step = 8 * (part.step - sum(gap.length for gap in gaps))
        if isinstance(node, Array):
            for element in range(number):
                begin = end + element * step
                scalars = _scalars(node.item, (PathStep(node, element),), begin, own)
                fields += _without_gaps(scalars, begin, gaps) if gaps else scalars
        else:
            fields.append(
                FrameField((PathStep(node),), end, 8 * number, node, own.byte, own.bit)
            )
        end += number * step
        if isinstance(size, Rest):
            counter = size.counter
            fields.append(
                FrameField(
                    (PathStep(counter),),
                    end,
                    counter.bits,
                    counter,
                    own.byte,
                    own.bit,
                    "count",
                )
            )
    for derived in layout.derived:
        scalar = derived.scalar
        fields.append(
            FrameField(
                (PathStep(derived),),
                end,
                scalar.bits,
                scalar,
                orders.byte,
                orders.bit,
                "derived",
            )
        )
    return fields


def _without_gaps(
    fields: Iterator[FrameField], begin: int, gaps: Sequence[Gap]
) -> Iterator[FrameField]:
    """Yield the scalars of the longest element that are not in a gap, at their
    positions in the shorter element.
    """
    for field in fields:
        at = (field.at - begin) // 8
        if not any(gap.begin <= at < gap.end for gap in gaps):
            missing = sum(gap.length for gap in gaps if gap.end <= at)
            yield replace(field, at=field.at - 8 * missing) if missing else field


def _scalars(
    node: PlacedNode, steps: tuple[PathStep, ...], at: int, orders: Orders
) -> Iterator[FrameField]:
    """Yield the scalars of a node of fixed size that begins at bit `at`."""
    match node:
        case Scalar(bits=bits):
            yield FrameField(steps, at, bits, node, orders.byte, orders.bit)
        case Overlay(scalar=scalar):
            yield FrameField(
                steps, at, scalar.bits, scalar, orders.byte, orders.bit, "overlay"
            )
        case StructRef(layout=layout):
            for inner in layout.fixed:
                yield from _scalars(
                    inner,
                    (*steps, PathStep(inner)),
                    at + inner.at,
                    inner.orders.within(orders),
                )
        case Array(item=item, most=count):
            for element in range(count):
                steps_to = (*steps[:-1], PathStep(node, element))
                yield from _scalars(item, steps_to, at + element * stride(item), orders)
