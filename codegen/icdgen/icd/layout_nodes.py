"""Nodes of layouts that are made from other nodes, and a visit to all nodes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.derived import Derivation
from icdgen.icd.layout import (
    Derived,
    Layout,
    LayoutNode,
    Orders,
    Overlay,
    Scalar,
    struct_layout_of,
)
from icdgen.icd.located import Map


def overlay_of(scalar: Scalar) -> Overlay:
    """Return the overlay node of a scalar. Both have the same name and position."""
    return Overlay(scalar=scalar, **_attributes(scalar))


def derived_of(scalar: Scalar, derivation: Derivation) -> Derived:
    """Return the derived node of a scalar. Both have the same name."""
    return Derived(scalar=scalar, derivation=derivation, **_attributes(scalar))


def _attributes(node: LayoutNode) -> dict[str, Any]:
    """Return the attributes of `LayoutNode`, which all kinds of nodes have."""
    return {name: getattr(node, name) for name in LayoutNode.__dataclass_fields__}


def counter_of_rest(
    name: str, identifier: str | None, is_array: bool, most: int, source: Map
) -> Scalar:
    """Return the scalar that counts the elements of `name` if the length of the frame
    is their only counter.

    Generated code has a member of this name, such as ``Records Count``, or ``Text
    Size`` for bytes and text.
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


def walk(
    layout: Layout, orders: Orders, owners: tuple[LayoutNode, ...] = ()
) -> Iterator[Visit]:
    """Visit each line of the ICD once.

    The nodes of a struct follow the node that refers to it.

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
