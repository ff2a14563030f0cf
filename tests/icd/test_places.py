"""Places of nodes in the longest frame, and lines of the ICD."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.icd.layout import Orders
from icdgen.icd.lines import lines
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import (
    places_in,
    places_of,
    raw_fields_in,
    scalar_count,
    scalars_in,
)
from icdgen.loading import load
from tests.icd.files import write

ICD = """\
structs:
  - name: Cell
    length: 3
    fields:
      - {at: 0, bits: 8, name: State, identifier: Mode, type: uint, summary: It is on., aliases: [on]}
      - {at: 8, bits: 8, name: Levels, type: uint, count: 2, byte_order: little, bit_order: msb0}
  - {name: Pack, length: 8, fields: [{at: 8, name: Cells, struct: Cell, count: 2}]}
messages:
  - name: Fixed
    id: 1
    kind: telemetry
    length: 10
    byte_order: big
    fields:
      - {at: 0, bits: 8, name: Number, type: uint, const: 5}
      - {at: 8, name: Main, struct: Pack}
      - {at: 72, bits: 8, name: Spare, type: uint, when: {Number: 5}}
      - {at: 72, bits: 4, name: Low, type: uint, view: true}
    derived:
      - {name: Twice, formula: Number*2}
  - name: Open
    id: 2
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, bits: 8, name: Other, type: uint}
      - {at: 16, name: Cells, struct: Cell, count: {field: Count, plus: -1}, up_to: 3}
      - {at: 16, after: Cells, bits: 16, name: Check, type: uint}
      - {at: 16, after: Check, name: Words, bits: 16, type: uint, byte_order: big, count: rest, up_to: 4}
    derived:
      - {name: Twice, formula: Other*2}
  - name: Texts
    id: 3
    kind: telemetry
    length: 0
    fields:
      - {at: 0, name: Note, identifier: Memo, type: text, size: rest, up_to: 5}
"""  # fmt: skip


@pytest.fixture(scope="module")
def node(tmp_path_factory) -> Node:
    folder: Path = tmp_path_factory.mktemp("icd")
    return load([write(folder, ICD)], check=False).icd.nodes[0]


def message(node: Node, name: str) -> Message:
    return next(each for each in node.messages if each.name == name)


def rows(places) -> list[tuple]:
    return [
        (place.name, place.role, place.at, place.bits, place.count) for place in places
    ]


def test_a_node_is_one_place_and_a_count_without_bits_follows_its_array(node):
    assert rows(places_in(message(node, "Fixed").layout)) == [
        ("Number", "field", 0, 8, 0),
        ("Main", "field", 8, 64, 0),
        ("Spare", "field", 72, 8, 0),
        ("Low", "overlay", 72, 4, 0),
        ("Twice", "derived", 80, 64, 0),
    ]
    assert rows(places_in(message(node, "Open").layout)) == [
        ("Count", "field", 0, 8, 0),
        ("Other", "field", 8, 8, 0),
        ("Cells", "field", 16, 24, 3),
        ("Check", "field", 88, 16, 0),
        ("Words", "field", 104, 16, 4),
        ("Words Count", "count", 168, 8, 0),
        ("Twice", "derived", 168, 64, 0),
    ]
    assert rows(places_in(message(node, "Texts").layout)) == [
        ("Note", "field", 0, 40, 0),
        ("Note Size", "count", 40, 8, 0),
    ]


def test_scalars_are_elements_and_fields_of_structs_at_their_bits(node):
    layout = message(node, "Fixed").layout
    cells = [
        (f"Main.Cells[{cell}].{name}", "field", 16 + 24 * cell + at, 8, 0)
        for cell in (0, 1)
        for name, at in (("State", 0), ("Levels[0]", 8), ("Levels[1]", 16))
    ]
    assert rows(scalars_in(layout))[1:7] == cells
    assert scalar_count(layout) == len(scalars_in(layout)) == 10
    assert [place.name for place in raw_fields_in(layout)] == [
        place.name for place in scalars_in(layout)[:8]
    ]
    for each in node.messages:
        assert scalar_count(each.layout) == len(scalars_in(each.layout))
    assert message(node, "Open").field_count == 3 * 3 + 2 + 1 + 4 + 1
    assert message(node, "Texts").field_count == 1


def test_undeclared_orders_are_those_of_the_nearest_owner(node):
    fixed = {place.name: place for place in scalars_in(message(node, "Fixed").layout)}
    default = Orders("little", "lsb0")
    for name, byte, bit, byte_in_effect, bit_in_effect in (
        ("Number", "big", "", "big", "lsb0"),
        ("Main.Cells[1].State", "big", "", "big", "lsb0"),
        ("Main.Cells[0].Levels[1]", "little", "msb0", "little", "msb0"),
        ("Twice", "", "", "little", "lsb0"),
    ):
        place = fixed[name]
        assert (place.byte_order, place.bit_order) == (byte, bit)
        effective = place.orders_in_effect(default)
        assert effective == Orders(byte_in_effect, bit_in_effect)
    layout = message(node, "Open").layout
    inherited = places_of(layout, Orders("big", "msb0"))
    assert rows(inherited) == rows(places_in(layout))
    assert [(place.byte_order, place.bit_order) for place in inherited] == [
        ("big", "msb0")
    ] * 5 + [("", "")] * 2
    assert places_of(layout, Orders()) is places_in(layout)
    words = places_in(layout)[4]
    assert (words.byte_order, words.bit_order) == ("big", "")


def test_a_place_has_the_attributes_of_its_node(node):
    fixed = {place.name: place for place in scalars_in(message(node, "Fixed").layout)}
    state = fixed["Main.Cells[1].State"]
    assert (state.identifier, state.summary, state.aliases) == ("Mode", "It is on.", ("on",))  # fmt: skip
    assert state.source["name"] == "State"
    (condition,) = fixed["Spare"].conditions
    assert (condition.field, condition.values) == ("Number", (5,))
    assert state.conditions == ()
    assert [name for name, place in fixed.items() if place.is_read_only] == ["Low", "Twice"]  # fmt: skip
    assert fixed["Twice"].derived.fields == ("Number",)
    assert fixed["Low"].derived is None
    size = places_in(message(node, "Texts").layout)[1]
    assert (size.identifier, size.type, size.is_read_only) == ("Memo Size", "uint", False)  # fmt: skip


def test_elements_of_an_array_have_an_index_and_no_count(node):
    cells = places_in(message(node, "Open").layout)[2]
    assert (cells.index, cells.width, cells.scalar_count) == (None, 72, 9)
    assert rows(cells.elements()) == [
        (f"Cells[{index}]", "field", 16 + 24 * index, 24, 0) for index in range(3)
    ]
    assert [element.index for element in cells.elements()] == [0, 1, 2]
    assert rows([cells.first_element]) == rows(cells.elements()[:1])
    first = cells.first_element
    assert (first.width, first.scalar_count, first.type) == (24, 3, "struct")
    assert first.elements() == (first,) and first.first_element is first
    assert rows(first.inner()) == [
        ("Cells[0].State", "field", 16, 8, 0),
        ("Cells[0].Levels", "field", 24, 8, 2),
    ]
    with pytest.raises(AssertionError, match="Cells is not a single struct"):
        cells.inner()


def test_a_counter_begins_with_its_smallest_valid_value(node):
    places = {place.name: place for place in places_in(message(node, "Open").layout)}
    assert (places["Count"].smallest_raw, places["Count"].initial_value) == (1, 1)
    assert (places["Other"].smallest_raw, places["Other"].initial_value) == (0, 0)
    number = places_in(message(node, "Fixed").layout)[0]
    assert number.initial_value == 5
    assert places_in(message(node, "Texts").layout)[0].initial_value == bytes(5)


def test_a_line_is_at_its_place_in_the_first_elements(node):
    found = lines(message(node, "Fixed").layout)
    assert [
        (line.name, line.at, line.bits, line.count, line.own_count, line.is_of_struct)
        for line in found
    ] == [
        ("Number", 0, 8, 0, 0, False),
        ("Main.Cells[].State", 16, 8, 2, 0, True),
        ("Main.Cells[].Levels", 24, 8, 4, 2, True),
        ("Spare", 72, 8, 0, 0, False),
        ("Low", 72, 4, 0, 0, False),
        ("Twice", 80, 64, 0, 0, False),
    ]
    state, levels = found[1:3]
    assert state.starts() == state.starts(first_only=True) == [16, 40]
    assert levels.starts() == [24, 32, 48, 56]
    assert [
        (level.node.name, level.count, level.stride, bool(level.struct))
        for level in levels.levels
    ] == [("Main", 0, 0, True), ("Cells", 2, 24, True), ("Levels", 2, 8, False)]


def test_starts_of_a_line_are_those_of_its_scalars(node):
    for each in node.messages:
        scalars: dict[str, list[int]] = {}
        for scalar in scalars_in(each.layout):
            parts = [part.partition("[")[0] for part in scalar.name.split(".")]
            scalars.setdefault(".".join(parts), []).append(scalar.at)
        starts = {line.name.replace("[]", ""): line.starts() for line in lines(each.layout)}  # fmt: skip
        assert starts == scalars


def test_the_lines_of_a_variable_length_array_are_those_of_an_element(node):
    found = {line.name: line for line in lines(message(node, "Open").layout)}
    levels = found["Cells[].Levels"]
    assert levels.starts() == [24, 32, 48, 56, 72, 80]
    assert levels.starts(first_only=True) == [24, 32]
    assert found["Words"].starts(first_only=True) == [104]
    assert (found["Count"].smallest_raw, found["Words Count"].is_count) == (1, True)
    assert [line.name for line in found.values() if line.is_count] == ["Words Count"]
    assert [line.is_of_struct for line in found.values()][:4] == [False] * 2 + [
        True
    ] * 2


def test_lines_of_two_revisions_differ_in_any_attribute(node, tmp_path):
    changes = (
        ("Number, type: uint, const: 5", "Number, type: uint, const: 6", ["Number"]),
        ("{at: 8, name: Cells", "{at: 16, name: Cells", ["Main.Cells[].State", "Main.Cells[].Levels"]),
        ("byte_order: big\n    fields", "bit_order: lsb0\n    fields",
         ["Number", "Main.Cells[].State", "Spare", "Low"]),
        ("name: Main,", "name: Main, identifier: First,", ["Main.Cells[].State", "Main.Cells[].Levels"]),
    )  # fmt: skip
    before = {line.name: line.content for line in lines(message(node, "Fixed").layout)}
    for old, new, expected in changes:
        text = ICD.replace(old, new, 1)
        assert text != ICD
        icd: Icd = load([write(tmp_path, text)], check=False).icd
        after = lines(message(icd.nodes[0], "Fixed").layout)
        changed = [line.name for line in after if line.content != before[line.name]]
        assert changed == expected, new
