"""Pairs of old and new objects: their bits, their type of reading, and their places."""

from __future__ import annotations

import pytest

from icdgen.diff.pairs import MessagePair, differing, kind, place_of, position
from icdgen.icd.lines import lines
from tests.diff.cases import compared_texts
from tests.icd.files import HEAD, loaded, status


def pair_of(tmp_path, old: str, new: str, orders=("little", "little")) -> MessagePair:
    """Return the pair of two messages, each with the byte order of its node."""
    texts = [
        HEAD.replace("byte_order: little", f"byte_order: {order}") + text
        for text, order in zip((old, new), orders, strict=True)
    ]
    context = compared_texts(tmp_path, *texts).context
    return context.pair(context.match.old.nodes[0].messages[0])


def test_differing_rows_are_in_the_order_of_their_keys():
    old, new = [(30, "a"), (1, "b"), (2, "c")], [(2, "c"), (1, "x"), (-5, "d")]
    assert list(differing(old, new, lambda row: row[0])) == [
        (-5, None, (-5, "d")),
        (1, (1, "b"), (1, "x")),
        (30, (30, "a"), None),
    ]


def test_the_reading_of_the_bits_depends_on_sign_and_type(tmp_path):
    text = (
        "enums:\n"
        "  - {name: Mode, members: [{value: 0, name: Idle}]}\n"
        "  - {name: Turn, members: [{value: -1, name: Back}]}\n"
    ) + status(
        "at: 0, bits: 8, name: Aa, type: uint",
        "at: 8, bits: 8, name: Bb, type: int",
        "at: 16, bits: 8, name: Cc, type: enum, enum: Mode",
        "at: 24, bits: 8, name: Dd, type: enum, enum: Turn",
        "at: 32, bits: 32, name: Ee, type: float",
        "at: 64, bits: 16, name: Ff, type: text",
        "at: 80, bits: 16, name: Gg, type: bytes",
        length=12,
    )
    (message,) = loaded(tmp_path, text).icd.nodes[0].messages
    assert [kind(line) for line in lines(message.layout)] == [
        "unsigned",
        "int",
        "unsigned",
        "int",
        "float",
        "bytes",
        "bytes",
    ]


def test_bytes_occupy_whole_bytes(tmp_path):
    text = status(
        "at: 0, bits: 16, name: Aa, type: bytes",
        "at: 16, bits: 24, name: Bb, type: text",
        length=5,
    )
    (node,) = loaded(tmp_path, text).icd.nodes
    first, second = lines(node.messages[0].layout)
    assert position(node, first) == (range(2),)
    assert position(node, second) == (range(2, 5),)
    assert position(node, second, absent=16) == (range(3),)


@pytest.mark.parametrize(("bits", "expected"), [(8, True), (16, False)])
def test_only_a_single_byte_is_at_the_same_bits_in_both_byte_orders(
    tmp_path, bits, expected
):
    text = status(f"at: 0, bits: {bits}, name: Aa, type: uint", length=bits // 8)
    pair = pair_of(tmp_path, text, text, ("little", "big"))
    assert pair.changed
    assert [field.same_bits for field in pair.parts] == [expected]


def test_bytes_are_at_the_same_bits_in_both_byte_orders(tmp_path):
    text = status("at: 0, bits: 32, name: Aa, type: bytes", length=4)
    (field,) = pair_of(tmp_path, text, text, ("little", "big")).parts
    assert field.same_bits and not field.moved


def test_fields_are_common_lost_or_gained(tmp_path):
    old = status(
        "at: 0, bits: 8, name: Speed, type: uint",
        "at: 8, bits: 8, name: Mass, type: int",
    )
    new = status(
        "at: 0, bits: 8, name: Speed, type: uint",
        "at: 8, bits: 8, name: Colour, type: bytes",
    )
    pair = pair_of(tmp_path, old, new)
    sides = (pair.common, pair.lost, pair.gained)
    assert [[field.any.name for field in side] for side in sides] == [
        ["Speed"],
        ["Mass"],
        ["Colour"],
    ]
    assert str(pair.gained[0].where()) == "demo `Status` `Colour`"


def test_the_place_is_that_of_the_first_existing_key(tmp_path):
    text = status("at: 0, bits: 8, name: Aa, type: uint, min: 1", length=1)
    (node,) = loaded(tmp_path, text).icd.nodes
    (line,) = lines(node.messages[0].layout)
    row = "      - {at: 0, bits: 8, name: Aa, type: uint, min: 1}"

    def column(*keys: str) -> int:
        return place_of(line, keys).column

    assert column("min") == row.index("1}") + 1
    assert column("max", "bits", "min") == row.index("8,") + 1
    assert place_of(line, ("max",)) == line.source.place
    assert place_of(None, ("min",)) is None
