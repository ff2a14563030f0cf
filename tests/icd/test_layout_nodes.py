"""Nodes that are made from other nodes, copies with changes, and the visit to all."""

from __future__ import annotations

import pytest

from icdgen.icd.derived import parse
from icdgen.icd.enumeration import Enum, Member
from icdgen.icd.layout import (
    Array,
    Condition,
    Counted,
    Derived,
    Layout,
    Orders,
    Overlay,
    Rest,
    Scalar,
    StructRef,
    bits_of_node,
    integer_range,
    is_variable,
    scalar_of,
    size_of,
    stride,
    struct_layout_of,
)
from icdgen.icd.layout_copies import (
    with_attributes,
    with_enum,
    with_node,
    with_struct_layout,
)
from icdgen.icd.layout_nodes import counter_of_rest, derived_of, overlay_of, walk
from icdgen.icd.located import unread
from tests.limits import assert_limits

KIND, OTHER = (Enum(name, (Member(0, "Zero"),)) for name in ("Kind", "Other"))
ATTRIBUTES = {
    "name": "Level",
    "at": 3,
    "identifier": "L",
    "aliases": ("lvl",),
    "summary": "How full.",
    "orders": Orders("big"),
    "present_if": (Condition("Mode", (1,)),),
}
SCALAR = Scalar(**ATTRIBUTES, type="enum", bits=5, enum=KIND)
CELL = Layout("Cell", 1, (SCALAR,))
PACK = Layout(
    "Pack",
    2,
    (Array(name="Cells", item=StructRef(name="Cells", layout=CELL), size=2),),
)


@pytest.mark.parametrize(
    "node", [overlay_of(SCALAR), derived_of(SCALAR, parse("A", ["A"]))]
)
def test_a_node_of_a_scalar_has_all_its_attributes(node):
    assert {name: getattr(node, name) for name in ATTRIBUTES} == ATTRIBUTES
    assert node.scalar is SCALAR


@pytest.mark.parametrize(
    ("is_array", "identifier", "name", "expected"),
    [
        (True, None, "Words Count", None),
        (False, None, "Words Size", None),
        (True, "W", "Words Count", "W Count"),
        (False, "W", "Words Size", "W Size"),
    ],
)
def test_a_counter_without_bits_is_named_after_its_array(
    is_array, identifier, name, expected
):
    counter = counter_of_rest("Words", identifier, is_array, 4, unread())
    assert (counter.name, counter.identifier) == (name, expected)
    assert (counter.type, counter.source) == ("uint", unread())


def test_a_counter_without_bits_has_a_byte_for_up_to_255_elements():
    def is_byte(most: int) -> bool:
        counter = counter_of_rest("Words", None, True, most, unread())
        assert counter.bits in (8, 16)
        return counter.bits == 8

    assert_limits(is_byte, most=255)


def test_a_struct_is_visited_behind_each_of_its_uses_with_the_orders_in_effect():
    first = StructRef(name="First", layout=PACK, orders=Orders("big"))
    second = StructRef(name="Second", layout=PACK)
    last = Scalar(name="Last", type="uint", bits=8, orders=Orders("", "msb0"))
    layout = Layout("Status", 5, (first, second), (last,))
    cells = PACK.fixed[0]
    plain, big = Orders("little", "lsb0"), Orders("big", "lsb0")
    assert list(walk(layout, plain)) == [
        (first, (), big),
        (cells, (first,), big),
        (SCALAR, (first, cells), big),
        (second, (), plain),
        (cells, (second,), plain),
        (SCALAR, (second, cells), big),
        (last, (), Orders("little", "msb0")),
    ]
    own = Layout("Own", 1, (last,), orders=Orders("big"))
    assert [visit.orders for visit in walk(own, plain)] == [Orders("big", "msb0")]


ARRAY = Array(name="Level", at=16, item=SCALAR, size=4)


@pytest.mark.parametrize(
    ("node", "inner"),
    [
        (ARRAY, "item"),
        (overlay_of(SCALAR), "scalar"),
        (derived_of(SCALAR, parse("A", ["A"])), "scalar"),
    ],
)
def test_attributes_of_all_nodes_change_in_a_node_and_its_scalar(node, inner):
    copy = with_attributes(node, name="New", bits=7, summary="")
    scalar = getattr(copy, inner)
    assert (copy.name, copy.summary, copy.at) == ("New", "", node.at)
    assert (scalar.name, scalar.summary, scalar.bits, scalar.at) == ("New", "", 7, 3)
    assert getattr(node, inner) is SCALAR, "the node itself is unchanged"


def test_the_position_and_the_size_of_an_array_are_not_those_of_its_element():
    copy = with_attributes(ARRAY, at=8, size=2)
    assert (copy.at, copy.most, copy.item.at) == (8, 2, 3)
    overlay = with_attributes(overlay_of(SCALAR), at=8)
    assert (overlay.at, overlay.scalar.at) == (8, 8)
    new = parse("B", ["B"])
    derived = with_attributes(derived_of(SCALAR, parse("A", ["A"])), derivation=new)
    assert derived.derivation is new and derived.scalar == SCALAR


def test_a_node_is_replaced_where_it_is_and_not_where_it_is_equal():
    twin = with_attributes(SCALAR)
    assert twin == SCALAR and twin is not SCALAR
    derived = derived_of(SCALAR, parse("A", ["A"]))
    layout = Layout("Status", 2, (SCALAR, twin), (ARRAY,), (derived,))
    new = with_attributes(SCALAR, name="New")
    assert with_node(layout, SCALAR, new).nodes == (new, twin, ARRAY, derived)
    assert with_node(layout, twin, new).nodes == (SCALAR, new, ARRAY, derived)
    other = with_attributes(ARRAY, name="New")
    assert with_node(layout, ARRAY, other).sequence == (other,)
    renamed = with_attributes(derived, name="New")
    assert with_node(layout, derived, renamed).derived == (renamed,)


def test_an_enumeration_is_replaced_at_any_depth():
    flag = Scalar(name="Flag", type="enum", bits=1, enum=OTHER)
    layout = Layout(
        "Status", 9, (flag, StructRef(name="Main", layout=PACK), overlay_of(SCALAR)),
        (ARRAY,),
    )  # fmt: skip
    new = Enum("New", ())
    copy = with_enum(layout, KIND, new)
    visits = (visit.node for visit in walk(copy, Orders()))
    scalars = [node for node in visits if isinstance(node, Scalar)]
    assert [scalar.enum.name for scalar in scalars] == ["Other", "New"]
    assert [scalar_of(node).enum for node in copy.nodes[2:]] == [new, new]
    assert with_enum(layout, new, OTHER) is layout
    assert with_enum(layout, OTHER, new).fixed[1] is layout.fixed[1]


def test_the_layout_of_a_struct_is_replaced_in_all_its_uses():
    array = Array(name="Packs", item=StructRef(name="Packs", layout=PACK), size=3)
    layout = Layout("Status", 8, (array, StructRef(name="Cell", layout=CELL)))
    new = Layout("Cell", 1, ())
    copy = with_struct_layout(layout, CELL, new)
    pack = struct_layout_of(copy.fixed[0])
    assert struct_layout_of(pack.fixed[0]) is new
    assert struct_layout_of(copy.fixed[1]) is new
    assert (pack.name, pack.length, copy.fixed[0].most) == ("Pack", 2, 3)
    assert with_struct_layout(layout, new, CELL) is layout


@pytest.mark.parametrize(
    ("node", "width", "distance", "is_open"),
    [
        (SCALAR, 5, 5, False),
        (overlay_of(SCALAR), 5, 5, False),
        (ARRAY, 20, 5, False),
        (StructRef(name="Main", layout=PACK), 16, 16, False),
        (PACK.fixed[0], 16, 8, False),
        (with_attributes(ARRAY, size=Counted("Number", 9)), 45, 5, True),
        (with_attributes(ARRAY, size=Rest(SCALAR, 8)), 40, 5, True),
        (Scalar(name="Text", type="text", bits=8, length=Rest(SCALAR, 9)), 8, 8, True),
    ],
)
def test_widths_of_nodes(node, width, distance, is_open):
    assert (bits_of_node(node), stride(node), is_variable(node)) == (
        width,
        distance,
        is_open,
    )
    if is_open:
        assert size_of(node) is (node.length if isinstance(node, Scalar) else node.size)


def test_a_derived_value_has_no_bits():
    with pytest.raises(TypeError, match="Level has no bits"):
        stride(derived_of(SCALAR, parse("A", ["A"])))


def test_a_scalar_or_a_struct_is_behind_each_node():
    derived = derived_of(SCALAR, parse("A", ["A"]))
    for node in (SCALAR, ARRAY, overlay_of(SCALAR), derived):
        assert scalar_of(node) is SCALAR and struct_layout_of(node) is None
    for node in (StructRef(name="Main", layout=CELL), PACK.fixed[0]):
        assert scalar_of(node) is None and struct_layout_of(node) is CELL
    assert isinstance(derived, Derived) and isinstance(overlay_of(SCALAR), Overlay)


@pytest.mark.parametrize(
    ("bits", "is_signed", "ends"),
    [(1, False, (0, 1)), (1, True, (-1, 0)), (8, True, (-128, 127)), (64, False, (0, 2**64 - 1))],
)  # fmt: skip
def test_the_range_of_an_integer(bits, is_signed, ends):
    assert integer_range(bits, is_signed) == ends
    kind = "int" if is_signed else "uint"
    scalar = Scalar(name="Level", type=kind, bits=bits)
    assert (scalar.raw_min, scalar.raw_max) == ends


@pytest.mark.parametrize(
    ("scalar", "bits", "smallest", "expected"),
    [
        (Scalar(name="A", type="uint", bits=8), 8, 0, 0),
        (Scalar(name="A", type="uint", bits=8), 8, 2, 2),
        (Scalar(name="A", type="uint", bits=8, const=7), 8, 0, 7),
        (Scalar(name="A", type="uint", bits=8, const=0), 8, 0, 0),
        (Scalar(name="A", type="bytes", bits=24), 24, 0, bytes(3)),
        (Scalar(name="A", type="text", bits=8), 40, 0, bytes(5)),
    ],
)
def test_the_initial_value_of_a_field(scalar, bits, smallest, expected):
    assert scalar.initial_value(bits, smallest) == expected
