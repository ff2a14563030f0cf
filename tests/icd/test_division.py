"""A split field equals its parts everywhere, and no bit is lost or moved."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

from hypothesis import assume, given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.diagnostics import Place
from icdgen.icd import division
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
