"""The layout tree: one node per line of the ICD, and the scalars of a frame with their bits."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.icd import pieces as bits
from icdgen.icd.frames import flatten
from icdgen.icd.layout import Array, Counted, Layout, Orders, Overlay, Scalar, StructRef, size_of, walk
from icdgen.icd.model import Icd, Message, Node
from tests.conformance.icds import read
from tests.conftest import ROOT

SETS = [
    "icd",
    "examples/devices/bme280",
    "examples/devices/mavlink",
    "examples/devices/p31u",
    "examples/devices/ublox",
    "tests/conformance/odd_icds",
    "tests/conformance/links",
    "tests/icd/fine",
    "tests/python/odd",
]


def messages(path: str) -> list[tuple[Icd, Node, Message]]:
    icd = read(ROOT / path)
    return [(icd, node, message) for node in icd.nodes for message in node.messages]


@pytest.mark.parametrize("path", SETS)
def test_a_layout_has_one_node_for_each_line_of_the_icd(path):
    for _, node, message in messages(path):
        for item in message.source.get("fields", ()):
            names = [part["name"] for part in item.get("bitfields", [item])]
            nodes = [one for one in message.layout.nodes if one.name in names]
            assert [one.name for one in nodes] == names, f"{message.name}: {item['name']}"
        visits = [visit for visit in walk(message.layout, node.orders) if not visit.owners]
        assert [visit.node for visit in visits] == list(message.layout.nodes)


@pytest.mark.parametrize("path", SETS)
def test_the_longest_frame_has_a_place_for_each_field(path):
    for _, node, message in messages(path):
        placed = flatten(message.layout, node.orders)
        assert [one.name for one in placed] == [field.name for field in message.fields]
        for one, field in zip(placed, message.fields, strict=True):
            assert (one.at, one.bits) == (field.at, field.bits), f"{message.name}: {one.name}"
            assert (one.role == "count") == field.is_count
            if not field.is_count:
                effective = field.orders_in_effect(node.orders)
                assert field.derived is not None or (one.byte_order, one.bit_order) == (effective.byte, effective.bit)


@pytest.mark.parametrize("path", SETS)
def test_lengths_of_frames_follow_from_the_sizes_of_their_variable_parts(path):
    for _, node, message in messages(path):
        layout = message.layout
        for most in (False, True):
            sizes = {part.name: part.most if most else part.fewest for part in layout.parts}
            placed = flatten(layout, node.orders, sizes)
            end = max((one.at + one.bits for one in placed if one.role == "field"), default=0)
            expected = layout.longest if most else layout.shortest
            assert end <= 8 * expected or layout.may_end_early


@pytest.mark.parametrize("path", SETS)
def test_fields_at_fixed_bits_lie_within_the_fixed_part(path):
    for _, node, message in messages(path):
        for owner in (message.layout, *structs_of(message.layout)):
            for one in owner.fixed:
                placed = flatten(Layout(owner.name, owner.length, (one,)), node.orders)
                assert all(one.at <= place.at for place in placed)
                assert all(place.at + place.bits <= 8 * owner.length for place in placed)


@pytest.mark.parametrize("path", SETS)
def test_owners_of_bits_do_not_overlap_unless_their_conditions_exclude_each_other(path):
    for _, node, message in messages(path):
        owned: dict[int, str] = {}
        for place in flatten(message.layout, node.orders):
            if place.role != "field" or place.conditions:
                continue
            for piece in pieces_of(place):
                for bit in range(piece.shift, piece.shift + piece.bits):
                    number = 8 * piece.byte + bit
                    assert number not in owned, f"{message.name}: {place.name} and {owned[number]}"
                    owned[number] = place.name


def pieces_of(place):
    """The runs of bits of a scalar; bytes are whole bytes in order."""
    if place.scalar.is_bytes:
        return [bits.Piece(byte, 0, 8, 0) for byte in range(place.at // 8, (place.at + place.bits) // 8)]
    return bits.pieces_at(place.at, place.bits, place.byte_order, place.bit_order)


def structs_of(layout: Layout) -> list[Layout]:
    """The layouts of all structs that a layout refers to."""
    refs = [one.item if isinstance(one, Array) else one for one in layout.nodes]
    inner = [one.layout for one in refs if isinstance(one, StructRef)]
    return inner + [deeper for one in inner for deeper in structs_of(one)]


@pytest.mark.parametrize("path", SETS)
def test_structs_have_fixed_nodes_only_and_share_their_layout(path):
    icd = read(ROOT / path)
    declared = {id(struct.layout) for node in icd.nodes for struct in node.structs}
    for _, _, message in messages_of(icd):
        for layout in structs_of(message.layout):
            assert id(layout) in declared
            assert not layout.sequence and not layout.derived and layout.orders == Orders()
            assert not any(isinstance(one, Overlay) or one.present_if for one in layout.fixed)


def messages_of(icd: Icd) -> list[tuple[Icd, Node, Message]]:
    return [(icd, node, message) for node in icd.nodes for message in node.messages]


@pytest.mark.parametrize("path", SETS)
def test_a_counter_is_a_plain_number_of_the_fixed_part_that_can_hold_the_size(path):
    for _, _, message in messages(path):
        counters = [size_of(one) for one in message.layout.sequence]
        counted = [size for size in counters if isinstance(size, Counted)]
        assert len({size.counter for size in counted}) == len(counted), "a field counts one part"
        assert all(isinstance(size, Counted) for size in counters[:-1]), "only the last part is the rest of the frame"
        for size in counted:
            (counter,) = (one for one in message.layout.fixed if one.name == size.counter)
            assert isinstance(counter, Scalar) and counter.type == "uint"
            assert counter.scale is None and counter.const is None and not counter.present_if
            assert size.most - size.plus < 1 << counter.bits


def test_an_array_of_structs_is_one_node_however_many_elements_it_can_have():
    icd = read(ROOT / "examples" / "devices" / "ublox")
    (message,) = (one for node in icd.nodes for one in node.messages if one.name == "NAV-SAT")
    lines = list(walk(message.layout, Orders("little", "lsb0")))
    assert len(lines) == 4 + len(structs_of(message.layout)[0].nodes)
    assert len(message.fields) > 1000


def test_a_frame_lists_only_the_elements_that_it_has():
    icd = read(ROOT / "examples" / "devices" / "ublox")
    (message,) = (one for node in icd.nodes for one in node.messages if one.name == "NAV-SAT")
    part = message.layout.sequence[-1]
    orders = Orders("little", "lsb0")
    none, two = (flatten(message.layout, orders, {part.name: number}) for number in (0, 2))
    inner = len(structs_of(message.layout)[0].fixed)
    assert len(two) - len(none) == 2 * inner
    assert {one.name.split(".")[0] for one in two[len(none) :]} == {f"{part.name}[0]", f"{part.name}[1]"}


def test_layouts_of_an_icd_are_the_same_from_the_cache(tmp_path: Path):
    from icdgen.icd import model_json

    icd = read(ROOT / "examples" / "devices" / "ublox")
    copy, _ = model_json.read(model_json.text(icd, {}))
    assert copy == icd
    for node in copy.nodes:
        declared = {id(struct.layout) for struct in node.structs}
        for message in node.messages:
            assert {id(layout) for layout in structs_of(message.layout)} <= declared
