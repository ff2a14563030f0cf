"""Flat lists of fields, computed from the layout tree for the modules that do not read the tree yet.

Each element of an array and each field of a struct is a `Field` of its own. See `icdgen.icd.layout` for the tree.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeAlias

from icdgen.icd.layout import (
    UNDECLARED,
    Array,
    Counted,
    Derived,
    FixedNode,
    Layout,
    Orders,
    Overlay,
    Rest,
    Scalar,
    StructRef,
    VariableNode,
    size_of,
    stride,
)
from icdgen.icd.model import Field, Icd, Message, Node, Struct, Tail

Structs: TypeAlias = Mapping[int, Struct]
"""The structs that layouts refer to, by the identity of their own layout."""


def fields_of(layout: Layout, structs: Structs) -> tuple[Field, ...]:
    """List the fields of the longest frame, each element of an array and each field of a struct by itself."""
    fields: list[Field] = []
    for node in layout.fixed:
        fields += _member(node, layout.orders, structs).elements
    tails = tails_of(layout)
    lows = {part.counter: part.low for part in tails if part.low}
    if lows:
        fields = [replace(field, counts_from=lows[field.name]) if field.name in lows else field for field in fields]
    begin = layout.length
    for node in layout.sequence:
        size = size_of(node)
        member = replace(_variable_member(node, layout.orders, structs), at=8 * begin)
        begin += size.most * stride(node) // 8
        fields += member.elements
        if isinstance(size, Rest):
            fields.append(_implied_counter(size.counter, begin))
    fields += (_derived_field(node, begin) for node in layout.derived)
    return tuple(fields)


def tails_of(layout: Layout) -> tuple[Tail, ...]:
    """List the variable-length parts of a message in frame order."""
    tails: list[Tail] = []
    begin = layout.length
    for node in layout.sequence:
        size, step = size_of(node), stride(node) // 8
        counter, plus = (size.counter, size.plus) if isinstance(size, Counted) else (size.counter.name, 0)
        is_last = node is layout.sequence[-1]
        tails.append(Tail(node.name, counter, step, size.most, plus, 0 if is_last else begin))
        begin += size.most * step
    return tuple(tails)


def with_flat_lists(icd: Icd) -> Icd:
    """Return the ICDs with the flat lists of all messages and structs."""
    structs: dict[int, Struct] = {}
    return Icd(tuple(_node_with_lists(node, structs) for node in icd.nodes))


def _node_with_lists(node: Node, structs: dict[int, Struct]) -> Node:
    """Return a node with the flat lists of its messages and structs; adds its structs to `structs`."""
    own_structs: list[Struct] = []
    for struct in node.structs:  # each stands behind those that it refers to
        own_structs.append(struct_with_lists(struct, structs))
        structs[id(struct.layout)] = own_structs[-1]
    messages = tuple(message_with_lists(message, structs) for message in node.messages)
    return replace(node, structs=tuple(own_structs), messages=messages)


def struct_with_lists(struct: Struct, structs: Structs) -> Struct:
    """Return a struct with the list of its fields."""
    return replace(struct, fields=fields_of(struct.layout, structs))


def message_with_lists(message: Message, structs: Structs) -> Message:
    """Return a message with the lists of its fields and variable-length parts."""
    tails = tails_of(message.layout)
    return replace(
        message,
        length=message.layout.longest,
        fields=fields_of(message.layout, structs),
        tail=tails[-1] if tails else None,
        inner=tails[:-1],
    )


def _struct_of(layout: Layout, structs: Structs) -> Struct:
    """Return a struct for a layout of which no node declares a struct, such as that of a changed copy."""
    return Struct(layout.name, layout.length, fields_of(layout, structs), node=layout.owner, layout=layout)


def _member(node: FixedNode, orders: Orders, structs: Structs) -> Field:
    """Return the field that stands for a whole node; `orders` are those that the layout declares."""
    own = node.orders.within(orders)
    match node:
        case Array(item=item, size=size):
            assert isinstance(size, int), "a fixed array has a fixed number of elements"
            return replace(_member(item, orders, structs), at=node.at, count=size)
        case StructRef(layout=layout):
            return Field(
                name=node.name,
                at=node.at,
                bits=8 * layout.length,
                type="struct",
                identifier=node.identifier,
                aliases=node.aliases,
                summary=node.summary,
                byte_order=own.byte,
                bit_order=own.bit,
                struct=structs.get(id(layout)) or _struct_of(layout, structs),
                errata=node.errata,
                source=node.source,
            )
        case Overlay(scalar=scalar):
            return replace(_scalar_field(scalar, own), view=True)
        case Scalar():
            return _scalar_field(node, own)


def _scalar_field(scalar: Scalar, own: Orders) -> Field:
    """Return the field of a scalar."""
    return Field(
        name=scalar.name,
        at=scalar.at,
        bits=scalar.bits,
        type=scalar.type,
        identifier=scalar.identifier,
        aliases=scalar.aliases,
        enum=scalar.enum,
        unit=scalar.unit,
        formula=scalar.formula,
        scale=scalar.scale,
        curve=scalar.curve,
        const=scalar.const,
        special=scalar.special,
        limits=scalar.limits,
        display=scalar.display,
        summary=scalar.summary,
        byte_order=own.byte,
        bit_order=own.bit,
        when=scalar.present_if,
        errata=scalar.errata,
        source=scalar.source,
    )


def _variable_member(node: VariableNode, orders: Orders, structs: Structs) -> Field:
    """Return the field that stands for all that a variable-length node can have."""
    most = size_of(node).most
    if isinstance(node, Array):
        return replace(_member(node.item, orders, structs), count=most)
    return replace(_member(node, orders, structs), bits=8 * most)


def _implied_counter(counter: Scalar, end: int) -> Field:
    """Return the field for a number of elements that only the length of the frame gives; it has no bits."""
    return Field(
        name=counter.name,
        at=8 * end,
        bits=counter.bits,
        type="uint",
        identifier=counter.identifier,
        implied=True,
        source=counter.source,
    )


def _derived_field(node: Derived, longest: int) -> Field:
    """Return the field of a derived value: a double behind the longest frame."""
    field = _scalar_field(node.scalar, UNDECLARED)
    return replace(field, at=8 * longest, view=True, derived=node.derivation)
