"""Messages that share an id, and the constants that distinguish them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.icd import variants
from icdgen.icd.layout import Array, Condition, Counted, Layout, Orders, Scalar
from icdgen.icd.model import Icd, Message, Node


def uint(name: str, at: int, bits: int = 8, const: int | None = None, **keys) -> Scalar:
    return Scalar(name=name, at=at, bits=bits, type="uint", const=const, **keys)


def message(name: str, *fields: Scalar, id: int = 1, length: int = 4, **keys) -> Message:  # fmt: skip
    kind = keys.pop("kind", "telemetry")
    layout = Layout(name, length, fields, **keys)
    return Message(name, kind, layout, id=id, node="demo")


NODE = Node("demo", "Demo", "", "little", "lsb0", (), ())
BIG = Node("big", "Big", "", "big", "msb0", (), ())


def rows(*messages: Message) -> list[tuple[str, list[str]]]:
    """Return the names of messages and of their constants, in the order of comparison."""
    found = variants.variants([(each, NODE) for each in messages])
    return [(each.message.name, [field.name for field in each.constants]) for each in found]  # fmt: skip


def test_a_message_with_an_id_of_its_own_needs_no_constants():
    assert rows(message("One", uint("Page", 0, const=1))) == [("One", [])]


def test_constants_that_all_messages_of_the_id_have_do_not_distinguish_them():
    sync = uint("Sync", 0, const=0x5A)
    assert rows(
        message("One", sync, uint("Page", 8, const=1), uint("Value", 16)),
        message("Two", sync, uint("Page", 8, const=0)),
        message("Any", sync),
    ) == [("One", ["Page"]), ("Two", ["Page"]), ("Any", [])]


def test_narrower_messages_come_first_and_others_in_the_order_of_the_icd():
    low, high = uint("Low", 0, const=0), uint("High", 8, const=2)
    deep = uint("Deep", 16, const=3)
    assert rows(
        message("Any"),
        message("Low", low),
        message("Other", uint("Low", 0, const=1)),
        message("Both", low, high),
        message("All", low, high, deep),
    ) == [
        ("All", ["Low", "High", "Deep"]),
        ("Both", ["Low", "High"]),
        ("Low", ["Low"]),
        ("Other", ["Low"]),
        ("Any", []),
    ]


COUNTED = Array(
    name="Rest",
    at=32,
    item=uint("Rest", 0, const=1),
    size=Counted("Number", 3),
)


@pytest.mark.parametrize(
    ("first", "second", "is_distinguishable"),
    [
        (message("A", uint("P", 0, const=1)), message("B", uint("P", 0, const=2)), True),
        (message("A", uint("P", 0, const=1)), message("B", uint("P", 0, const=1)), False),
        (message("A", uint("P", 0, const=0)), message("B", uint("P", 0)), True),
        (message("A", uint("P", 0, const=1)), message("B", uint("P", 8, const=1)), False),
        (message("A", length=3), message("B"), True),
        (message("A"), message("B"), False),
        (message("A", sequence=(COUNTED,)), message("B", length=8), True),
        (message("A", sequence=(COUNTED,)), message("B", length=7), False),
        (message("A", length=3, may_end_early=True), message("B", length=2), False),
        (message("A", length=3, may_end_early=True), message("B"), True),
        (message("A", uint("P", 0, const=1, present_if=(Condition("Q", (1,)),))),
         message("B", uint("P", 0, const=2)), True),
        (message("A", uint("P", 0, const=1, present_if=(Condition("Q", (1,)),))),
         message("B", uint("P", 0, const=2, present_if=(Condition("Q", (1,)),))), False),
        # Both have the bits 12 to 15 of the frame.
        (message("A", uint("P", 12, 4, const=1)),
         message("B", uint("P", 8, 4, const=2, orders=Orders("big", "msb0"))), True),
        (message("A", uint("P", 12, 4, const=1)),
         message("B", uint("P", 12, 4, const=2, orders=Orders("big", "msb0"))), False),
    ],
)  # fmt: skip
def test_messages_differ_in_length_or_constants(first, second, is_distinguishable):
    pairs = ((first, NODE), (second, NODE)), ((second, NODE), (first, NODE))
    assert [variants.are_distinguishable(*pair) for pair in pairs] == [
        is_distinguishable
    ] * 2


def test_a_narrower_message_has_all_constants_of_the_other_and_more():
    low, high = uint("Low", 0, const=0), uint("High", 8, const=2)
    one, both = (message("One", low), NODE), (message("Both", low, high), NODE)
    other, short = (message("O", high), NODE), (message("S", low, high, length=3), NODE)
    assert variants.is_narrower(both, one)
    assert not variants.is_narrower(one, both)
    assert not variants.is_narrower(one, one)
    assert not variants.is_narrower(one, other)
    assert not variants.is_narrower(short, one), "they have no common length"


def test_the_orders_of_the_node_decide_the_place_of_a_constant():
    little, big = (uint("P", at, 4, const=1) for at in (12, 8))
    assert not variants.are_distinguishable(
        (message("A", little), NODE), (message("B", big), BIG)
    )


def test_constants_are_those_that_every_frame_has():
    fields = (
        uint("Zero", 0, const=0),
        uint("Number", 8),
        uint("Optional", 16, const=1, present_if=(Condition("Number", (1,)),)),
    )
    (constant,) = variants.constants(message("A", *fields, sequence=(COUNTED,)), NODE)
    assert constant.name == "Zero"


def test_messages_of_included_nodes_are_grouped_by_direction_and_id():
    base = Node("base", "", "", "big", "msb0", (
        message("Page", uint("P", 0, const=1), id=5),
        message("Order", id=5, kind="telecommand"),
    ), ())  # fmt: skip
    own = Node("demo", "", "", "little", "lsb0", (
        message("All", id=5),
        message("Zero", id=0),
        Message("Both", "configuration", Layout("Both", 1, ()), set_id=5, get_id=6, node="demo"),
    ), (), includes=("base",))  # fmt: skip
    base = _owned(base)
    ids = variants.ids_of(Icd((base, own)), own)
    names = [
        {id: [each.message.name for each in group] for id, group in direction.items()}
        for direction in ids
    ]
    assert names == [
        {5: ["Order", "Both"]},
        {5: ["Page", "All"], 0: ["Zero"], 6: ["Both"]},
    ]
    assert [each.node.name for each in ids.telemetry[5]] == ["base", "demo"]


def _owned(node: Node) -> Node:
    """Return the node with messages that name it as their owner."""
    messages = tuple(replace(each, node=node.name) for each in node.messages)
    return replace(node, messages=messages)


@pytest.mark.parametrize(
    ("messages", "length"),
    [
        ([message("A"), message("B")], 4),
        ([message("A"), message("B", length=3)], None),
        ([message("A", sequence=(COUNTED,))], None),
        ([message("A", may_end_early=True)], None),
        ([message("A", length=0), message("B", length=0)], 0),
    ],
)
def test_a_group_has_a_common_length_if_all_its_frames_do(messages, length):
    group = [variants.Variant(each, NODE) for each in messages]
    assert variants.common_length(group) == length
