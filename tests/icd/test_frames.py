"""Scalars of one frame: names, positions and the frames that are kept."""

from __future__ import annotations

import random

import pytest

from icdgen.icd import frames
from icdgen.icd.frames import fixed_fields, flatten, frame_fields
from icdgen.icd.layout import Orders
from icdgen.icd.model import Message, Node
from icdgen.loading import load
from tests.icd.files import write

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}
structs:
  - name: Point
    length: 3
    fields:
      - {at: 0, bits: 8, name: X, type: uint, byte_order: little, identifier: x_pos}
      - {at: 8, bits: 16, name: W, type: uint, byte_order: little, bit_order: lsb0}
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, name: A, bits: 16, type: uint, count: A Count, up_to: 2}
      - {at: 8, after: A, bits: 8, name: Mid, type: uint}
      - {at: 8, after: Mid, name: B, bits: 8, type: uint, count: B Count, up_to: 3}
      - {at: 8, after: B, bits: 8, name: Last, type: uint}
messages:
  - name: Fixed
    id: 130
    kind: telemetry
    length: 10
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint, identifier: mode}
      - {at: 0, bits: 4, name: High, type: uint, view: true}
      - {at: 8, name: Points, struct: Point, count: 2, identifier: pts}
      - {at: 56, name: One, struct: Point}
  - name: Counted
    id: 131
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, bits: 8, name: A Count, type: uint}
      - {at: 16, bits: 8, name: B Count, type: uint}
      - {at: 24, name: Curves, struct: Curve, count: Count, up_to: 2}
      - {at: 24, after: Curves, bits: 16, name: Behind, type: uint}
  - name: Data
    id: 132
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Size, type: uint}
      - {at: 8, name: Octets, type: bytes, size: Size, up_to: 5}
      - {at: 8, after: Octets, bits: 16, name: Rest, type: uint, count: rest, up_to: 3}
    derived:
      - {name: Twice, formula: Size*2}
"""


@pytest.fixture(scope="module")
def node(tmp_path_factory) -> Node:
    loaded = load([write(tmp_path_factory.mktemp("frames"), ICD)])
    assert [f for f in loaded.findings if f.severity == "error"] == []
    return loaded.icd.nodes[0]


def message(node: Node, name: str) -> Message:
    return next(each for each in node.messages if each.name == name)


def rows(fields) -> list[tuple]:
    return [(f.name, f.at, f.bits, f.byte_order, f.bit_order, f.role) for f in fields]


def test_scalars_of_structs_and_arrays_have_their_path_as_name(node):
    fields = frame_fields(message(node, "Fixed").layout, node.orders)
    points = [
        ("{}.X", 0, 8, "little", "msb0", "field"),
        ("{}.W", 8, 16, "little", "lsb0", "field"),
    ]
    expected = [
        ("Mode", 0, 8, "big", "msb0", "field"),
        ("High", 0, 4, "big", "msb0", "overlay"),
    ]
    for owner, at in (("Points[0]", 8), ("Points[1]", 32), ("One", 56)):
        expected += [(n.format(owner), at + begin, *row) for n, begin, *row in points]
    assert rows(fields) == expected
    aliases = [field.alias for field in fields]
    assert aliases == [
        "mode", None, "pts[0].x_pos", "pts[0].W", "pts[1].x_pos", "pts[1].W", "One.x_pos", None,
    ]  # fmt: skip
    assert [f.has_bits for f in fields] == [True, False] + [True] * 6
    assert [f.is_raw for f in fields] == [True, False] + [True] * 6


def sizes(count: int, a: int, b: int) -> dict[str, int]:
    return {"Curves": count, "Curves.A": a, "Curves.B": b}


@pytest.mark.parametrize("count", range(3))
@pytest.mark.parametrize("a", range(3))
@pytest.mark.parametrize("b", range(4))
def test_elements_have_the_bytes_of_their_arrays(node, count, a, b):
    """The frame is written field by field, one directly after another."""
    layout = message(node, "Counted").layout
    expected, at = [("Count", 0, 8), ("A Count", 8, 8), ("B Count", 16, 8)], 24
    for number in range(count):
        own = [("Kind", 8), *((f"A[{n}]", 16) for n in range(a)), ("Mid", 8),
               *((f"B[{n}]", 8) for n in range(b)), ("Last", 8)]  # fmt: skip
        for name, bits in own:
            expected.append((f"Curves[{number}].{name}", at, bits))
            at += bits
    expected.append(("Behind", at, 16))
    fields = frame_fields(layout, node.orders, sizes(count, a, b))
    assert [(f.name, f.at, f.bits) for f in fields] == expected


def test_the_longest_frame_has_the_most_of_everything(node):
    layout = message(node, "Counted").layout
    longest = rows(frame_fields(layout, node.orders))
    assert longest == rows(frame_fields(layout, node.orders, sizes(2, 2, 3)))


def test_bytes_and_counts_follow_from_the_sizes(node):
    layout = message(node, "Data").layout
    for size, rest in ((0, 0), (0, 2), (5, 3), (1, 0)):
        fields = frame_fields(layout, node.orders, {"Octets": size, "Rest": rest})
        end = 8 + 8 * size
        *numbers, count, twice = rows(fields)
        assert numbers == [
            ("Size", 0, 8, "big", "msb0", "field"),
            ("Octets", 8, 8 * size, "big", "msb0", "field"),
            *(
                (f"Rest[{n}]", end + 16 * n, 16, "big", "msb0", "field")
                for n in range(rest)
            ),
        ]
        assert count[1] == end + 16 * rest and count[-1] == "count"
        assert twice[0] == "Twice" and twice[2:] == (64, "big", "msb0", "derived")
        *_, counter, derived = fields
        assert (counter.has_bits, counter.is_raw) == (False, True)
        assert (derived.has_bits, derived.is_raw) == (False, False)
        assert derived.derived.fields == ("Size",)
        assert fields[0].derived is None


def test_fixed_fields_are_at_the_same_place_in_each_frame(node):
    names = [f.name for f in fixed_fields(message(node, "Counted").layout, node.orders)]
    assert names == ["Count", "A Count", "B Count"]
    fields = fixed_fields(message(node, "Data").layout, node.orders)
    assert [f.role for f in fields] == ["field", "count", "derived"]


def test_a_frame_of_known_sizes_is_the_same_object(node):
    layout = message(node, "Counted").layout
    first = frame_fields(layout, node.orders, sizes(1, 2, 3))
    assert frame_fields(layout, node.orders, sizes(1, 2, 3)) is first
    assert frame_fields(layout, node.orders, sizes(1, 2, 2)) is not first
    other = frame_fields(layout, Orders("little", "lsb0"), sizes(1, 2, 3))
    assert other is not first and other[0].byte_order == "little"
    fixed = message(node, "Fixed").layout
    assert frame_fields(fixed, node.orders) is frame_fields(fixed, node.orders, {})


def cached(layout) -> int:
    return len(frames._frames(layout))


def test_the_oldest_frames_are_forgotten(node, monkeypatch):
    """At most 64 frames, and 100,000 scalars before the new frame, are kept."""
    assert (frames._CACHED_FRAMES, frames._CACHED_SCALARS) == (64, 100_000)
    layout = message(node, "Data").layout
    frames._frames(layout).clear()
    monkeypatch.setattr(frames, "_CACHED_FRAMES", 3)

    def fields(size: int):
        return frame_fields(layout, node.orders, {"Octets": size, "Rest": 0})

    kept = [fields(size) for size in range(3)]
    assert cached(layout) == 3
    assert all(fields(size) is kept[size] for size in range(3))
    fields(3)
    assert cached(layout) == 3
    assert fields(1) is kept[1] and fields(2) is kept[2]
    assert fields(0) is not kept[0]
    frames._frames(layout).clear()


def test_frames_with_many_scalars_are_forgotten_earlier(node, monkeypatch):
    layout = message(node, "Data").layout
    frames._frames(layout).clear()
    # A frame with `n` numbers has 4 + n scalars.
    monkeypatch.setattr(frames, "_CACHED_SCALARS", 8)

    def fields(size: int, rest: int = 0):
        return frame_fields(layout, node.orders, {"Octets": size, "Rest": rest})

    assert [len(fields(size)) for size in (0, 1)] == [4, 4]
    fields(2)
    assert cached(layout) == 3  # 8 scalars before the third were not too many
    fields(3)
    assert cached(layout) == 3  # 12 were: the oldest is gone
    fields(4, 3)
    assert cached(layout) == 3
    fields(5)
    assert cached(layout) == 2  # 4 + 7 scalars are too many, 7 are not
    frames._frames(layout).clear()


def test_flatten_lists_what_frame_fields_keeps(node):
    source = random.Random(1)
    layout = message(node, "Counted").layout
    for _ in range(10):
        given = sizes(source.randrange(3), source.randrange(3), source.randrange(4))
        kept = frame_fields(layout, node.orders, given)
        assert rows(flatten(layout, node.orders, given)) == rows(kept)
