"""Copies of layouts with other nodes: a layout never changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

from icdgen.icd.enumeration import Enum
from icdgen.icd.layout import Array, Counted, Derived, Layout, LayoutNode, Overlay, scalar_of, size_of, struct_layout_of

NodeT = TypeVar("NodeT", bound=LayoutNode)


def without_nodes(layout: Layout, is_left_out: Callable[[LayoutNode], bool]) -> Layout:
    """Return a layout without some of its own nodes; the same object if all of them stay.

    A value that is derived from a node that is left out is left out, too. So are all variable-length nodes if one of
    them, or a field that counts one of them, is left out: their positions depend on each other.
    """
    if not any(map(is_left_out, layout.nodes)):
        return layout
    fixed = tuple(node for node in layout.fixed if not is_left_out(node))
    names = {node.name for node in fixed}
    sequence = layout.sequence
    for node in layout.sequence:
        size = size_of(node)
        if is_left_out(node) or (isinstance(size, Counted) and size.counter not in names):
            sequence = ()
    names.update(node.name for node in sequence)
    derived: list[Derived] = []
    for value in layout.derived:  # each may be derived from those in front of it
        if not is_left_out(value) and names.issuperset(value.derivation.fields):
            derived.append(value)
            names.add(value.name)
    return replace(layout, fixed=fixed, sequence=sequence, derived=tuple(derived))


def with_attributes(node: NodeT, **changes: Any) -> NodeT:
    """Return a copy of a node with other attributes of its own, or of its scalar or item.

    Attributes that all kinds of nodes have change in both, because an array has the names of its item, and an overlay
    those of its scalar. Only an array has another position than its item.
    """
    own = {name: value for name, value in changes.items() if name in node.__dataclass_fields__}
    match node:
        case Array(item=item):
            inner = {name: value for name, value in changes.items() if name not in ("at", "size")}
            return replace(node, **own, item=replace(item, **inner))
        case Overlay(scalar=scalar) | Derived(scalar=scalar):
            inner = {name: value for name, value in changes.items() if name != "derivation"}
            return replace(node, **own, scalar=replace(scalar, **inner))
    return replace(node, **changes)


def with_node(layout: Layout, old: LayoutNode, new: LayoutNode) -> Layout:
    """Return a layout with another node in the place of one of its own."""

    def replaced(nodes: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(new if node is old else node for node in nodes)

    return replace(
        layout, fixed=replaced(layout.fixed), sequence=replaced(layout.sequence), derived=replaced(layout.derived)
    )


def with_struct_layout(layout: Layout, old: Layout, new: Layout) -> Layout:
    """Return a layout in which a struct has another layout wherever it stands; the same object if it stands nowhere."""
    for node in layout.nodes:
        struct = struct_layout_of(node)
        if struct is not None:
            inner = new if struct is old else with_struct_layout(struct, old, new)
            if inner is not struct:
                layout = with_node(layout, node, with_attributes(node, layout=inner))
    return layout


def with_enum(layout: Layout, old: Enum, new: Enum) -> Layout:
    """Return a layout with another enumeration in the place of one; the same object if no field has it."""
    for node in layout.nodes:
        scalar, struct = scalar_of(node), struct_layout_of(node)
        if scalar is not None and scalar.enum is old:
            layout = with_node(layout, node, with_attributes(node, enum=new))
        elif struct is not None:
            inner = with_enum(struct, old, new)
            if inner is not struct:
                layout = with_node(layout, node, with_attributes(node, layout=inner))
    return layout
