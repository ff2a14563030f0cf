"""Model of an ICD: each key of the file is an attribute of the model."""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.icd import build
from icdgen.icd.curve import polynomial
from icdgen.icd.enumeration import Member
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Array, Counted, Orders, Overlay, Rest, Scalar, StructRef
from icdgen.icd.model import ContainedMessage, Node
from icdgen.icd.units import STANDARD, Unit
from icdgen.loading import load
from tests.icd.files import write

ICD = """\
icdgen: 1
node:
  name: demo
  title: Demo
  byte_order: big
  bit_order: msb0
  id_bits: 11
  node_type: 0
  interface_version: 0
  source: {document: Manual, version: "1.5"}
include: [base.yaml]
vocabulary: [Telemetry, Low, Base]
units: [{symbol: tick, identifier: tick, quantity: time}]
enums:
  - name: Kind
    identifier: Sort
    summary: Some.
    aliases: [kinds]
    source: {table: 2}
    members: [{value: -1, name: Low, identifier: L, summary: S., aliases: [lo]}, {value: 0, to: 0, name: High}]
structs:
  - {name: Outer, length: 3, source: {table: 4}, fields: [{at: 0, name: Inner, struct: Inner, count: 3}]}
  - {name: Inner, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
messages:
  - name: Order
    identifier: Command
    id: 0
    kind: telecommand
    length: 0
    group: Main
    summary: Do it.
    aliases: [cmd]
    source: {table: 7, page: 8}
    acknowledge: false
    repeat: true
    response: none
    hazard: It burns.
    assumptions: {length: Not printed.}
  - {name: Reset, id: [0, 2], kind: telecommand, length: 0, acknowledge: reset}
  - {name: Both, set_id: 3, get_id: 4, kind: configuration, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
  - {name: All, id: 5, kind: telemetry, length: 2, requested: false, period_ms: 1, reserved: 1, contains: [{message: Both, at: 0}]}
  - name: Short
    id: 6
    kind: telemetry
    length: 1
    byte_order: little
    may_end_early: zeros
    fields: [{at: 0, bits: 8, name: A, type: uint}]
loggable: [{bit: 0, id: 6, name: Log}, {bit: 1, id: [0, 5]}]
missing: [{kind: telemetry, id: 9, name: Lost, why: No table.}]
# base.yaml
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
vocabulary: [Base, Other]
units: [{symbol: beat, identifier: beat, quantity: time, summary: Of a heart.}]
enums: [{name: Shared, members: [{value: 1, name: One}]}]
"""  # fmt: skip


@pytest.fixture(scope="module")
def demo(tmp_path_factory) -> Node:
    return model_of(tmp_path_factory.mktemp("icd"), ICD)


def model_of(folder, text: str) -> Node:
    return load([write(folder, text)], check=False).icd.node("demo")


def test_a_node_has_the_values_of_its_keys(demo):
    assert (demo.name, demo.title, demo.summary) == ("demo", "Demo", "")
    assert demo.orders == Orders("big", "msb0")
    assert (demo.id_bits, demo.node_type, demo.interface_version) == (11, 0, 0)
    assert demo.document == (("document", "Manual"), ("version", "1.5"))
    assert demo.includes == ("base",)
    assert demo.vocabulary == ("Base", "Other", "Telemetry", "Low")
    assert demo.units == (Unit("tick", "tick", "time", ""),)
    rows = [(row.bit, row.id, row.name) for row in demo.loggable]
    assert rows == [(0, 6, "Log"), (1, 5, "")]
    (lost,) = demo.missing
    assert (lost.kind, lost.id, lost.name, lost.why) == ("telemetry", 9, "Lost", "No table.")  # fmt: skip
    assert demo.protocol == {} and demo.errata == ()
    assert demo.file.endswith("demo.yaml")


def test_an_enumeration_has_the_values_of_its_keys(demo):
    (kind,) = demo.enums
    assert (kind.name, kind.identifier, kind.summary, kind.aliases) == ("Kind", "Sort", "Some.", ("kinds",))  # fmt: skip
    assert (kind.table, kind.node) == (2, "demo")
    assert kind.members == (
        Member(-1, "Low", "L", "S.", aliases=("lo",)),
        Member(0, "High", to=0),
    )


def test_a_struct_follows_the_structs_that_it_contains(demo):
    inner, outer = demo.structs
    assert (inner.name, outer.name, inner.table, outer.table) == ("Inner", "Outer", None, 4)  # fmt: skip
    assert (inner.length, outer.length, outer.node) == (1, 3, "demo")
    (array,) = outer.layout.fixed
    assert array.item.layout is inner.layout and array.most == 3
    assert (outer.layout.owner, outer.layout.name) == ("demo", "Outer")


def test_a_message_has_the_values_of_its_keys(demo):
    order, reset, both, every, short = demo.messages
    assert (order.id, order.group, order.table, order.page) == (0, "Main", 7, 8)
    assert (order.identifier, order.summary, order.aliases) == ("Command", "Do it.", ("cmd",))  # fmt: skip
    assert (order.acknowledge, order.expects_reset, order.repeat) == (False, False, True)  # fmt: skip
    assert (order.response, order.hazard) == ("none", "It burns.")
    assert order.assumptions == (("length", "Not printed."),)
    assert (reset.id, reset.acknowledge, reset.expects_reset) == (2, False, True)
    assert (reset.repeat, reset.response, reset.table, reset.page) == (False, None, None, None)  # fmt: skip
    assert (both.id, both.set_id, both.get_id) == (None, 3, 4)
    assert (both.acknowledge, both.expects_reset, both.requested) == (True, False, True)
    assert (every.requested, every.period_ms, every.reserved) == (False, 1, 1)
    assert every.contains == (ContainedMessage("Both", 0),)
    assert (both.period_ms, both.reserved, both.contains) == (None, 0, ())
    assert (short.may_end_early, every.may_end_early) == ("zeros", "")
    assert (short.layout.may_end_early, every.layout.may_end_early) == (True, False)
    assert (short.layout.orders, every.layout.orders) == (Orders("little"), Orders())
    assert {message.node for message in demo.messages} == {"demo"}


FIELDS = """\
include: [base.yaml]
enums: [{name: Own, members: [{value: 3, name: Three}]}]
units: [{symbol: tick, identifier: tick, quantity: time}]
structs: [{name: Cell, length: 1, fields: [{at: 0, bits: 8, name: State, type: uint}]}]
messages:
  - name: Status
    id: 1
    kind: telemetry
    length: 20
    fields:
      - {FIELD}
""" + ICD[ICD.index("# base.yaml") :]  # fmt: skip


def node_of(folder, field: str, **texts: str):
    """Return the first node of a message with this field."""
    text = FIELDS.replace("{FIELD}", f"{{{field}}}")
    return model_of(folder, text).messages[0].layout.nodes[0]


@pytest.mark.parametrize(
    ("field", "attributes"),
    [
        ("type: uint, const: 0", {"const": 0, "scale": None, "curve": None, "limits": None}),
        ("type: uint, unit: tick, formula: raw*2",
         {"unit": Unit("tick", "tick", "time"), "formula": "raw*2", "scale": Scale(Fraction(2))}),
        ("type: int, unit: beat", {"unit": Unit("beat", "beat", "time", "Of a heart.")}),
        ("type: int, unit: V", {"unit": STANDARD["V"], "unit_symbol": "V"}),
        ("type: int, unit: nothing", {"unit": None, "unit_symbol": ""}),
        ("type: int, formula: raw^2", {"scale": None, "curve": polynomial([0.0, 0.0, 1.0])}),
        ("type: float, formula: raw*2", {"scale": None, "curve": polynomial([0.0, 2.0])}),
        ("type: bool, formula: raw*2", {"scale": None, "curve": None, "formula": "raw*2"}),
        ("type: int, formula: raw*", {"scale": None, "curve": None, "formula": "raw*"}),
        ("type: bytes", {"is_bytes": True, "length": None}),
        ("type: uint, byte_order: little", {"orders": Orders("little")}),
        ("type: uint, bit_order: lsb0", {"orders": Orders("", "lsb0")}),
        ("type: uint, min: 0", {"limits": build.limits({"min": 0})}),
        ("type: uint, identifier: L, summary: S., aliases: [a, b]",
         {"identifier": "L", "summary": "S.", "aliases": ("a", "b")}),
        ("type: uint, enum: Own", {"enum": None}),
        ("type: enum, enum: Nothing", {"enum": None}),
    ],
)  # fmt: skip
def test_a_field_has_the_values_of_its_keys(field, attributes, tmp_path):
    node = node_of(tmp_path, f"at: 8, bits: 32, name: Level, {field}")
    assert isinstance(node, Scalar)
    assert (node.name, node.at, node.bits) == ("Level", 8, 32)
    assert {name: getattr(node, name) for name in attributes} == attributes


@pytest.mark.parametrize(("enum", "value"), [("Own", 3), ("Shared", 1)])
def test_a_field_has_an_enumeration_of_its_node_or_of_an_included_node(
    enum, value, tmp_path
):
    node = node_of(tmp_path, f"at: 0, bits: 8, name: Mode, type: enum, enum: {enum}")
    assert (node.enum.name, node.enum.members[0].value) == (enum, value)


def test_special_values_that_the_type_cannot_represent_are_left_out(tmp_path):
    special = "special: [{value: nan, meaning: A}, {value: 0, meaning: B}, {value: 1.5, meaning: C}]"  # fmt: skip
    for kind, expected in (("uint", ["B"]), ("float", ["A", "B", "C"])):
        node = node_of(tmp_path, f"at: 0, bits: 32, name: L, type: {kind}, {special}")
        assert [value.meaning for value in node.special] == expected


@pytest.mark.parametrize(
    ("outside", "physical"), [("", 2.0), (", outside: clamp", 2.0), (", outside: extrapolate", 2.0)]
)  # fmt: skip
def test_a_field_has_its_lookup_table(outside, physical, tmp_path):
    points = f"points: [[0, 0], [2, 4]]{outside}"
    node = node_of(tmp_path, f"at: 0, bits: 8, name: L, type: uint, {points}")
    assert node.curve.double(1) == physical
    assert node.curve.outside == outside.removeprefix(", outside: ")
    wrong = "points: [[2, 0], [0, 4]]"
    assert node_of(tmp_path, f"at: 0, bits: 8, name: L, type: uint, {wrong}").curve is None  # fmt: skip
    assert node_of(tmp_path, f"at: 0, bits: 1, name: L, type: bool, {points}").curve is None  # fmt: skip


def test_lines_are_arrays_structs_overlays_or_scalars(tmp_path):
    array = node_of(tmp_path, "at: 8, bits: 4, name: L, type: uint, count: 2, byte_order: little")  # fmt: skip
    assert isinstance(array, Array) and isinstance(array.item, Scalar)
    assert (array.at, array.item.at, array.size) == (8, 0, 2)
    assert array.orders == array.item.orders == Orders("little")
    struct = node_of(tmp_path, "at: 8, name: L, struct: Cell, identifier: M")
    assert isinstance(struct, StructRef)
    assert (struct.at, struct.identifier, struct.layout.name) == (8, "M", "Cell")
    structs = node_of(tmp_path, "at: 8, name: L, struct: Cell, count: 3")
    assert (structs.at, structs.item.at, structs.most) == (8, 0, 3)
    overlay = node_of(tmp_path, "at: 8, bits: 4, name: L, type: uint, view: true")
    assert isinstance(overlay, Overlay)
    assert (overlay.at, overlay.scalar.bits) == (8, 4)
    not_overlay = node_of(tmp_path, "at: 8, bits: 4, name: L, type: uint, view: false")
    assert isinstance(not_overlay, Scalar)


@pytest.mark.parametrize(
    ("keys", "size", "counter"),
    [
        ("bits: 8, type: uint, count: rest, up_to: 300", Rest, ("Words Count", None, 16)),
        ("type: text, size: rest, up_to: 255, identifier: W", Rest, ("Words Size", "W Size", 8)),
        ("bits: 8, type: uint, count: Number, up_to: 3", Counted("Number", 3, 0), None),
        ("type: bytes, size: {field: Number, plus: -2}, up_to: 3", Counted("Number", 3, -2), None),
    ],
)  # fmt: skip
def test_the_size_of_a_variable_length_field(keys, size, counter, tmp_path):
    text = FIELDS.replace("length: 20", "length: 1").replace(
        "{FIELD}",
        f"{{at: 0, bits: 8, name: Number, type: uint}}\n      - {{at: 8, name: Words, {keys}}}",
    )
    layout = model_of(tmp_path, text).messages[0].layout
    (node,) = layout.sequence
    actual = node.size if isinstance(node, Array) else node.length
    if counter is None:
        assert actual == size
    else:
        own = actual.counter
        assert (own.name, own.identifier, own.bits) == counter
    assert [each.name for each in layout.fixed] == ["Number"]
    if isinstance(node, Scalar):
        assert (node.bits, node.at) == (8, 8)


def test_a_struct_that_contains_itself_or_is_unknown_is_left_out(tmp_path):
    text = FIELDS.replace("struct: Cell", "struct: None").replace(
        "structs: [",
        "structs: [{name: Loop, length: 1, fields: [{at: 0, name: L, struct: Loop}]}, ",
    )
    node = model_of(tmp_path, text.replace("{FIELD}", "{at: 0, name: L, struct: Gone}"))
    assert node.messages[0].layout.nodes == ()
    structs = {struct.name: struct.layout.nodes for struct in node.structs}
    assert structs["Loop"] == () and structs["Cell"]


def test_the_first_of_two_structs_with_one_name_is_used(tmp_path):
    longer = "{name: Cell, length: 2, fields: [{at: 0, bits: 16, name: S, type: uint}]}"
    text = FIELDS.replace("structs: [", f"structs: [{longer}, ")
    node = model_of(tmp_path, text.replace("{FIELD}", "{at: 0, name: L, struct: Cell}"))
    assert node.messages[0].layout.fixed[0].layout.length == 2
    assert [struct.length for struct in node.structs] == [2, 1]


def test_derived_values_can_use_those_before_them(tmp_path):
    text = FIELDS.replace("{FIELD}", "{at: 0, bits: 8, name: A, type: uint}").replace(
        "# base.yaml",
        "    derived:\n"
        "      - {name: B, formula: A*2, unit: tick, display: {decimals: 1}, identifier: I, aliases: [b], summary: S.}\n"
        "      - {name: C, formula: A + D}\n"
        "      - {name: D, formula: B + 1}\n# base.yaml",
    )  # fmt: skip
    layout = model_of(tmp_path, text).messages[0].layout
    first, second = layout.derived
    assert (first.name, first.identifier, first.aliases, first.summary) == ("B", "I", ("b",), "S.")  # fmt: skip
    scalar = first.scalar
    assert (scalar.type, scalar.bits, scalar.formula) == ("float", 64, "A*2")
    assert (scalar.unit_symbol, scalar.display.plain) == ("tick", {"decimals": 1})
    assert (second.name, second.derivation.fields) == ("D", ("B",))
