"""A split field equals its parts everywhere, and no bit is lost or moved."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.diagnostics import Place
from icdgen.icd import division, source
from icdgen.icd.layout import Layout, Scalar
from icdgen.icd.located import Map
from icdgen.icd.model import Message, Node
from icdgen.loading import load

ORDERS = st.sampled_from([(a, b) for a in ("little", "big") for b in ("lsb0", "msb0")])


def item(**values) -> Map:
    mapping = Map(Place("demo.yaml", 1, 1))
    mapping.update(values)
    return mapping


def raw_at(at: int, bits: int, orders: tuple[str, str], frame: bytes) -> int:
    layout = Layout(
        "Demo", len(frame), (Scalar(name="Value", at=at, type="uint", bits=bits),)
    )
    node = Node("demo", "Demo", "", *orders, messages=(), enums=())
    return codec.decode(node, Message("Demo", "telemetry", layout), frame)["Value"]


@given(ORDERS, st.integers(0, 15), st.integers(1, 33), st.data())
def test_a_part_has_the_named_bits_of_the_value(orders, at, bits, data):
    field = item(name="Whole", at=at, bits=bits, type="uint")
    start = data.draw(st.integers(0, bits - 1))
    count = data.draw(st.integers(1, bits - start))
    assume(division.is_contiguous(field, item(at=start, bits=count), *orders))
    place = division.first_bit_of_part(field, item(at=start, bits=count), *orders)
    frame = data.draw(st.binary(min_size=6, max_size=6))
    value, part = raw_at(at, bits, orders, frame), raw_at(place, count, orders, frame)
    assert part == (value >> start) & ((1 << count) - 1)


@given(
    st.sampled_from((("little", "lsb0"), ("big", "msb0"))),
    st.integers(0, 15),
    st.integers(1, 33),
    st.data(),
)
def test_consecutive_bits_can_be_split_in_every_way(orders, at, bits, data):
    cuts = sorted(data.draw(st.sets(st.integers(0, bits))) | {0, bits})
    parts = [item(name=f"P{a}", at=a, bits=b - a) for a, b in pairwise(cuts)]
    field = item(name="Whole", at=at, bits=bits, type="uint", bitfields=parts)
    assert list(division.faults(field, *orders)) == []


def test_parts_have_units_scales_and_the_texts_of_the_split_field(tmp_path: Path):
    (tmp_path / "demo.yaml").write_text("""\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}
messages:
  - name: Set Periods
    id: 1
    kind: telecommand
    length: 2
    fields:
      - at: 0
        bits: 16
        name: Periods
        type: uint
        summary: Zero stops it.
        bitfields:
          - {at: 0, bits: 4, name: First, unit: s, formula: raw*0.5, max: 5}
          - {at: 4, bits: 11, name: Second, unit: s}
          - {at: 15, bits: 1, name: Fast, type: bool, summary: Not slow.}
""")
    loaded = load([tmp_path])
    assert not loaded.findings
    message = loaded.icd.node("demo").messages[0]
    assert [(f.name, f.at, f.bits, f.type) for f in message.fields] == [
        ("First", 12, 4, "uint"),
        ("Second", 1, 11, "uint"),
        ("Fast", 0, 1, "bool"),
    ]
    first, second, fast = message.fields
    assert (first.unit.symbol, codec.physical_double(first, 3), first.limits.max) == (
        "s",
        1.5,
        5,
    )
    assert second.summary == "Bits 4 to 14 of Periods. Zero stops it."
    assert fast.summary == "Bit 15 of Periods. Not slow."
    assert codec.encode(
        loaded.icd.node("demo"), message, {"First": 3, "Second": 1, "Fast": 1}
    ) == bytes.fromhex("8013")


WITHIN = "correct `at` or `bits`: `at` counts from the start of the split field"


@pytest.mark.parametrize(
    ("keys", "parts", "expected"),
    [
        ("", "{at: 0, bits: 3, name: A}, {at: 3, bits: 5, name: B}", []),
        ("view: false", "{at: 0, bits: 8, name: A}", []),
        ("", "{at: 0, bits: 4, name: A}, {at: 3, bits: 5, name: B}",
         [("at", "`B` overlaps `A`", WITHIN)]),
        ("", "{at: 0, bits: 4, name: A}, {at: 4, bits: 5, name: B}",
         [("bits", "`B` ends at bit 9 of `Whole`, which has 8 bits", WITHIN)]),
        ("", "{at: 1, bits: 3, name: A}, {at: 5, bits: 3, name: B}, {at: -1, bits: 1, name: C}, {at: 0, bits: 0, name: D}",
         [("bitfields", "bit 0 of `Whole` belongs to no part",
           "describe it as a part, or mark it as reserved")]),
        ("const: 0, display: hex, min: 0", "{at: 0, bits: 8, name: A}",
         [(key, f"`Whole` is a split field, so it cannot have `{key}`; its parts can",
           "move it to the parts; an erratum removes what is printed")
          for key in ("const", "min", "display")]),
        ("view: true", "{at: 0, bits: 8, name: A}",
         [("view", "`Whole` is a split field, so it cannot be an overlay field",
           "write each part as an overlay field of the message")]),
        ("count: 2", "{at: 0, bits: 8, name: A}",
         [("bitfields", "`Whole` cannot have `bitfields`: it is an array",
           "write a field for each element, or make the parts fields of the message")]),
    ],
)  # fmt: skip
def test_each_fault_of_a_split_field_is_at_its_key(keys, parts, expected):
    text = f"{{name: Whole, at: 0, bits: 8, type: uint, bitfields: [{parts}], {keys}}}"
    field = source.parse(text.encode(), "demo.yaml")
    rows = []
    for fault in division.faults(field, "little", "lsb0"):
        (key,) = (key for key in fault.owner if fault.owner.at(key) == fault.place)
        rows.append((key, fault.message, fault.help))
    assert rows == expected


def test_parts_that_cross_a_byte_against_the_order_are_reported():
    text = "{name: Whole, at: 0, bits: 16, type: uint, bitfields: [{at: 0, bits: 8, name: A}, {at: 4, bits: 8, name: B}]}"
    field = source.parse(text.encode(), "demo.yaml")
    messages = [fault.message for fault in division.faults(field, "big", "lsb0")]
    assert "the bits of `B` are not contiguous in the frame" in messages
    assert "`B` overlaps `A`" in messages
