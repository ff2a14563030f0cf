"""Modified copies of layouts, which are immutable.

`icdgen.backends.assurance` changes one attribute of a model at a time in this way, to
see which golden vectors detect the change.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

from icdgen.icd.enumeration import Enum
from icdgen.icd.layout import (
    Array,
    Derived,
    Layout,
    LayoutNode,
    Overlay,
    scalar_of,
    struct_layout_of,
)

NodeT = TypeVar("NodeT", bound=LayoutNode)


def with_attributes(node: NodeT, **changes: Any) -> NodeT:
    """Return a copy of a node with changed attributes of the node, or of its scalar or
    item.

    Attributes that all kinds of nodes have change in both, because an array and its
    item, or an overlay and its scalar, have the same names. Only the position of an
    array differs from the position of its item.
    """
    own = {
        name: value
        for name, value in changes.items()
        if name in node.__dataclass_fields__
    }
    match node:
        case Array(item=item):
            inner = {
                name: value
                for name, value in changes.items()
                if name not in ("at", "size")
            }
            return replace(node, **own, item=replace(item, **inner))
        case Overlay(scalar=scalar) | Derived(scalar=scalar):
            inner = {
                name: value for name, value in changes.items() if name != "derivation"
            }
            return replace(node, **own, scalar=replace(scalar, **inner))
    return replace(node, **changes)


def with_node(layout: Layout, old: LayoutNode, new: LayoutNode) -> Layout:
    """Return a layout in which `new` replaces its node `old`."""

    def replaced(nodes: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(new if node is old else node for node in nodes)

    return replace(
        layout,
        fixed=replaced(layout.fixed),
        sequence=replaced(layout.sequence),
        derived=replaced(layout.derived),
    )


def with_struct_layout(layout: Layout, old: Layout, new: Layout) -> Layout:
    """Return a layout with `new` as the layout of a struct, at any depth; the same
    object if it does not use `old`.
    """
    for node in layout.nodes:
        struct = struct_layout_of(node)
        if struct is not None:
            inner = new if struct is old else with_struct_layout(struct, old, new)
            if inner is not struct:
                layout = with_node(layout, node, with_attributes(node, layout=inner))
    return layout


def with_enum(layout: Layout, old: Enum, new: Enum) -> Layout:
    """Return a layout in which the enumeration `new` replaces `old`; the same object if
    no field uses `old`.
    """
    for node in layout.nodes:
        scalar, struct = scalar_of(node), struct_layout_of(node)
        if scalar is not None and scalar.enum is old:
            layout = with_node(layout, node, with_attributes(node, enum=new))
        elif struct is not None:
            inner = with_enum(struct, old, new)
            if inner is not struct:
                layout = with_node(layout, node, with_attributes(node, layout=inner))
    return layout
