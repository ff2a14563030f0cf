"""The layout tree: one node per line of the ICD, and the scalars of a frame with their
bits.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.icd import pieces as bits
from icdgen.icd.frames import flatten
from icdgen.icd.layout import Array, Counted, Layout, Orders, Overlay, Scalar, StructRef
from icdgen.icd.layout_copies import with_attributes, with_node, with_struct_layout
from icdgen.icd.layout_nodes import walk
from icdgen.icd.model import Icd, Message, Node
from icdgen.loading import load
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT
from tests.icd.files import loaded, write

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
    icd = read_unchecked(ROOT / path)
    return [(icd, node, message) for node in icd.nodes for message in node.messages]


@pytest.mark.parametrize("path", SETS)
def test_a_layout_has_one_node_for_each_line_of_the_icd(path):
    for _, node, message in messages(path):
        for item in message.source.get("fields", ()):
            names = [part["name"] for part in item.get("bitfields", [item])]
            nodes = [node for node in message.layout.nodes if node.name in names]
            assert [node.name for node in nodes] == names, (
                f"{message.name}: {item['name']}"
            )
        visits = [
            visit for visit in walk(message.layout, node.orders) if not visit.owners
        ]
        assert [visit.node for visit in visits] == list(message.layout.nodes)


@pytest.mark.parametrize("path", SETS)
def test_the_longest_frame_has_a_place_for_each_field(path):
    for _, node, message in messages(path):
        placed = flatten(message.layout, node.orders)
        assert [scalar.name for scalar in placed] == [
            field.name for field in message.fields
        ]
        for scalar, field in zip(placed, message.fields, strict=True):
            assert (scalar.at, scalar.bits) == (
                field.at,
                field.bits,
            ), f"{message.name}: {scalar.name}"
            assert (scalar.role == "count") == field.is_count
            if not field.is_count:
                effective = field.orders_in_effect(node.orders)
                assert field.derived is not None or (
                    scalar.byte_order,
                    scalar.bit_order,
                ) == (
                    effective.byte,
                    effective.bit,
                )


@pytest.mark.parametrize("path", SETS)
def test_lengths_of_frames_follow_from_the_sizes_of_their_variable_parts(path):
    for _, node, message in messages(path):
        layout = message.layout
        for most in (False, True):
            sizes = {
                name: part.most if most else part.fewest
                for name, part in layout.parts_by_size.items()
            }
            placed = flatten(layout, node.orders, sizes)
            end = max(
                (
                    scalar.at + scalar.bits
                    for scalar in placed
                    if scalar.role == "field"
                ),
                default=0,
            )
            expected = layout.longest if most else layout.shortest
            assert end <= 8 * expected or layout.may_end_early


@pytest.mark.parametrize("path", SETS)
def test_fields_at_fixed_bits_lie_within_the_fixed_part(path):
    for _, node, message in messages(path):
        for owner in (message.layout, *structs_of(message.layout)):
            for field in owner.fixed:
                placed = flatten(
                    Layout(owner.name, owner.length, (field,)), node.orders
                )
                assert all(field.at <= place.at for place in placed)
                assert all(
                    place.at + place.bits <= 8 * owner.length for place in placed
                )


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
                    assert number not in owned, (
                        f"{message.name}: {place.name} and {owned[number]}"
                    )
                    owned[number] = place.name


def pieces_of(place):
    """Return the runs of bits of a scalar. Bytes are complete bytes in order."""
    if place.scalar.is_bytes:
        return [
            bits.Piece(byte, 0, 8, 0)
            for byte in range(place.at // 8, (place.at + place.bits) // 8)
        ]
    return bits.pieces_at(place.at, place.bits, place.byte_order, place.bit_order)


def structs_of(layout: Layout) -> list[Layout]:
    """Return the layouts of all structs that a layout refers to."""
    refs = [node.item if isinstance(node, Array) else node for node in layout.nodes]
    inner = [ref.layout for ref in refs if isinstance(ref, StructRef)]
    return inner + [deeper for layout_ in inner for deeper in structs_of(layout_)]


@pytest.mark.parametrize("path", SETS)
def test_structs_have_fixed_nodes_only_and_share_their_layout(path):
    icd = read_unchecked(ROOT / path)
    declared = {id(struct.layout) for node in icd.nodes for struct in node.structs}
    for _, _, message in messages_of(icd):
        for layout in structs_of(message.layout):
            assert id(layout) in declared
            assert (
                not layout.sequence and not layout.derived and layout.orders == Orders()
            )
            assert not any(
                isinstance(field, Overlay) or field.present_if for field in layout.fixed
            )


def messages_of(icd: Icd) -> list[tuple[Icd, Node, Message]]:
    return [(icd, node, message) for node in icd.nodes for message in node.messages]


@pytest.mark.parametrize("path", SETS)
def test_a_counter_is_a_plain_number_of_the_fixed_part_that_can_hold_the_size(path):
    for _, _, message in messages(path):
        parts = message.layout.parts
        counters = [part.counter for part in parts if not part.is_rest]
        assert len(set(counters)) == len(counters), "a field counts one part"
        assert not any(part.is_rest for part in parts[:-1]), (
            "only the last part is the rest of the frame"
        )
        assert not any(part.is_rest and part.inner for part in parts), (
            "a field counts elements with arrays of variable length"
        )
        for part in message.layout.counted_parts:
            if not part.is_rest:
                (counter,) = (
                    field
                    for field in message.layout.fixed
                    if field.name == part.counter
                )
                assert isinstance(counter, Scalar) and counter.type == "uint"
                assert (
                    counter.scale is None
                    and counter.const is None
                    and not counter.present_if
                )
                assert part.high < 1 << counter.bits


def test_arrays_in_elements_take_the_bytes_that_their_counters_give():
    """Every field has the same bytes as in the longest frame without the gaps."""
    icd = read_unchecked(ROOT / "tests" / "conformance" / "odd_icds")
    (node,) = (node for node in icd.nodes if node.name == "curves")
    assert any(message.layout.parts[-1].inner for message in node.messages)
    for message in node.messages:
        layout = message.layout
        longest = flatten(layout, Orders("big", "msb0"))
        for share in (0, 1, 2):
            sizes = {
                name: part.fewest + share * (part.most - part.fewest) // 2
                for name, part in layout.parts_by_size.items()
            }
            gaps = list(layout.gaps(sizes))
            placed = {
                scalar.name: scalar
                for scalar in flatten(layout, Orders("big", "msb0"), sizes)
            }
            assert layout.size_of_frame(sizes) == layout.longest - sum(
                gap.length for gap in gaps
            )
            for scalar in longest:
                if scalar.role == "field" and scalar.scalar.length is None:
                    is_missing = any(
                        gap.begin <= scalar.at // 8 < gap.end for gap in gaps
                    )
                    assert (scalar.name not in placed) == is_missing
                    before = sum(
                        gap.length for gap in gaps if gap.end <= scalar.at // 8
                    )
                    assert (
                        is_missing or placed[scalar.name].at == scalar.at - 8 * before
                    )


def test_an_array_of_structs_is_one_node_with_any_number_of_elements():
    icd = read_unchecked(ROOT / "examples" / "devices" / "ublox")
    (message,) = (
        message
        for node in icd.nodes
        for message in node.messages
        if message.name == "NAV-SAT"
    )
    lines = list(walk(message.layout, Orders("little", "lsb0")))
    assert len(lines) == 4 + len(structs_of(message.layout)[0].nodes)
    assert len(message.fields) > 1000


def test_a_frame_lists_only_the_elements_that_it_has():
    icd = read_unchecked(ROOT / "examples" / "devices" / "ublox")
    (message,) = (
        message
        for node in icd.nodes
        for message in node.messages
        if message.name == "NAV-SAT"
    )
    part = message.layout.sequence[-1]
    orders = Orders("little", "lsb0")
    none, two = (
        flatten(message.layout, orders, {part.name: number}) for number in (0, 2)
    )
    inner = len(structs_of(message.layout)[0].fixed)
    assert len(two) - len(none) == 2 * inner
    assert {scalar.name.split(".")[0] for scalar in two[len(none) :]} == {
        f"{part.name}[0]",
        f"{part.name}[1]",
    }


def test_layouts_of_an_icd_are_the_same_from_the_cache(tmp_path: Path):
    from icdgen.icd import model_json

    icd = read_unchecked(ROOT / "examples" / "devices" / "ublox")
    copy, _ = model_json.model_of_json(model_json.json_of_model(icd, {}))
    assert copy == icd
    for node in copy.nodes:
        declared = {id(struct.layout) for struct in node.structs}
        for message in node.messages:
            assert {id(layout) for layout in structs_of(message.layout)} <= declared


NESTED = """\
structs:
  - {name: Cell, length: 1, fields: [{at: 0, bits: 8, name: Charge, identifier: Level, type: uint}]}
  - {name: Pack, length: 2, fields: [{at: 0, name: Cells, struct: Cell, count: 2}]}
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 5
    fields:
      - {at: 0, name: Main Pack, identifier: Main, struct: Pack}
      - {at: 16, name: Spare, struct: Pack}
      - {at: 32, bits: 8, name: Mode, type: uint}
"""


def test_identifiers_replace_the_names_of_the_nodes_on_the_path_that_have_them(
    tmp_path,
):
    (message,) = loaded(tmp_path, NESTED).icd.nodes[0].messages
    fields = flatten(message.layout, Orders("little", "lsb0"))
    assert [(field.name, field.alias) for field in fields] == [
        ("Main Pack.Cells[0].Charge", "Main.Cells[0].Level"),
        ("Main Pack.Cells[1].Charge", "Main.Cells[1].Level"),
        ("Spare.Cells[0].Charge", "Spare.Cells[0].Level"),
        ("Spare.Cells[1].Charge", "Spare.Cells[1].Level"),
        ("Mode", None),
    ]


def test_a_changed_struct_changes_the_messages_that_use_it_within_other_structs(
    tmp_path,
):
    (node,) = loaded(tmp_path, NESTED).icd.nodes
    (message,), (cell, _) = node.messages, node.structs
    (charge,) = cell.layout.fixed
    signed = with_node(cell.layout, charge, with_attributes(charge, type="int"))
    layout = with_struct_layout(message.layout, cell.layout, signed)
    before, after = (
        [field.type for field in flatten(each, node.orders)]
        for each in (message.layout, layout)
    )
    assert (before, after) == (["uint"] * 5, ["int"] * 4 + ["uint"])
    assert with_struct_layout(layout, cell.layout, signed) is layout


PARTS = """\
structs:
  - {name: Cell, length: 1, fields: [
      {at: 0, bits: 8, name: State, type: uint},
      {at: 8, bits: 16, name: Values, type: uint, count: {field: Inner, plus: 1}, up_to: 3},
      {at: 8, after: Values, bits: 8, name: End, type: uint}]}
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 8, name: Inner, type: uint}
      - {at: 16, bits: 8, name: Size, type: uint}
      - {at: 24, name: Cells, struct: Cell, count: {field: Number, plus: -1}, up_to: 4}
      - {at: 24, after: Cells, bits: 16, name: Check, type: uint}
      - {at: 24, after: Check, name: Text, type: text, size: {field: Size, plus: 2}, up_to: 5}
  - name: Rest
    id: 2
    kind: telemetry
    length: 1
    may_end_early: zeros
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 32, name: Words, type: uint, count: rest, up_to: 4}
  - {name: Fixed, id: 3, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
  - {name: Empty, id: 4, kind: telemetry, length: 0, may_end_early: zeros}
"""  # fmt: skip


@pytest.fixture(scope="module")
def variable(tmp_path_factory) -> dict[str, Layout]:
    result = load([write(tmp_path_factory.mktemp("icd"), PARTS)], check=False)
    return {message.name: message.layout for message in result.icd.nodes[0].messages}


def test_variable_parts_are_placed_as_in_the_longest_frame(variable):
    cells, text = variable["Status"].parts
    assert [
        (part.name, part.counter, part.is_rest, part.begin, part.step, part.most)
        for part in (cells, text)
    ] == [("Cells", "Number", False, 3, 8, 4), ("Text", "Size", False, 37, 1, 5)]
    assert [
        (part.plus, part.behind, part.end, part.is_array) for part in (cells, text)
    ] == [
        (-1, 2, 35, True),
        (2, 0, 42, False),
    ]
    assert [(part.fewest, part.low, part.high) for part in (cells, text)] == [(0, 1, 5), (2, 0, 3)]  # fmt: skip
    (inner,) = cells.inner
    assert (inner.name, inner.begin, inner.step, inner.most, inner.plus) == ("Values", 1, 2, 3, 1)  # fmt: skip
    assert (cells.shortest_step, cells.steps, text.steps) == (4, (4, 2), (1,))
    assert (text.end_if_fewest, text.possible_ends) == (39, range(39, 43))
    (rest,) = variable["Rest"].parts
    assert (rest.counter, rest.is_rest, rest.possible_ends) == ("Words Count", True, range(1, 18, 4))  # fmt: skip
    assert list(variable["Status"].parts_by_size) == ["Cells", "Text", "Cells.Values"]


def test_counters_have_the_values_of_all_that_they_count(variable):
    layout = variable["Status"]
    names = ("Number", "Inner", "Size", "Check")
    assert [layout.smallest_raw_of_counter(name) for name in names] == [1, 0, 0, 0]
    assert [layout.largest_raw_of_counter(name) for name in names[:3]] == [5, 2, 3]
    assert layout.initial_numbers == {"Cells": 4, "Text": 2}
    assert variable["Rest"].initial_numbers == {"Words": 0}
    assert variable["Fixed"].smallest_raw_of_counter("A") == 0


def test_lengths_of_frames(variable):
    assert [
        (layout.fixed_length, layout.shortest, layout.longest, layout.lengths.step)
        for layout in variable.values()
    ] == [(5, 7, 42, 1), (1, 1, 17, 4), (1, 1, 1, 1), (0, 0, 0, 1)]
    gaps = [name for name, layout in variable.items() if layout.has_inner_gaps]
    assert gaps == ["Status"]
    assert list(variable["Fixed"].lengths) == [1]


@pytest.mark.parametrize("cells", [0, 1, 4])
@pytest.mark.parametrize("values", [1, 3])
@pytest.mark.parametrize("size", [2, 5])
def test_a_frame_is_the_longest_frame_without_its_gaps(variable, cells, values, size):
    layout = variable["Status"]
    sizes = {"Cells": cells, "Cells.Values": values, "Text": size}
    longest = bytes(range(1, 43))
    absent = {
        byte
        for cell in range(4)
        for byte in range(3 + 8 * cell, 11 + 8 * cell)
        if cell >= cells or 1 + 2 * values <= byte - 3 - 8 * cell < 7
    } | set(range(37 + size, 42))
    frame = bytes(byte for at, byte in enumerate(longest) if at not in absent)
    expected = bytes(0 if at in absent else byte for at, byte in enumerate(longest))
    assert layout.size_of_frame(sizes) == len(frame)
    assert layout.in_longest(frame, sizes) == expected
    assert {
        byte for gap in layout.gaps(sizes) for byte in range(gap.begin, gap.end)
    } == absent


def test_a_frame_that_ends_early_is_filled_with_zeros(variable):
    sizes = {"Words": 2}
    frame = variable["Rest"].in_longest(b"\1\2", sizes)
    assert frame == b"\1\2" + bytes(15)


def test_the_part_in_front_of_a_node(variable):
    layout = variable["Status"]
    cells, check, text = layout.sequence
    parts = dict(zip(("Cells", "Text"), layout.parts, strict=True))
    assert layout.part_of(cells) is parts["Cells"] and layout.part_of(check) is None
    found = [layout.part_in_front_of(node) for node in (layout.fixed[0], cells, check, text)]  # fmt: skip
    assert found == [None, None, parts["Cells"], parts["Cells"]]


def test_bytes_can_be_absent_between_others_if_something_follows_them():
    item = Scalar(name="Words", type="uint", bits=8)
    first, second = (
        Array(name=f"Words {plus}", at=8, item=item, size=Counted("N", most, plus))
        for most, plus in ((3, 0), (5, 1))
    )
    layouts = [Layout("A", 1, (), nodes) for nodes in ((first,), (first, item), (first, second), ())]  # fmt: skip
    assert [layout.has_inner_gaps for layout in layouts] == [False, True, True, False]
    assert layouts[2].largest_raw_of_counter("N") == 3
    assert Layout("A", 3, (), may_end_early=True).in_longest(b"\1", {}) == b"\1\0\0"
