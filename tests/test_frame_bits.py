"""Positions of fields and reserved bits in a frame, compared with a bit at a time."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen import frame_bits
from icdgen.icd.frames import FrameField, PathStep, frame_fields
from icdgen.icd.layout import Scalar
from icdgen.icd.model import Message, Node
from icdgen.icd.variants import ids_of
from icdgen.loading import load
from tests.icd.files import write

ORDERS = list(itertools.product(("little", "big"), ("lsb0", "msb0")))


def node_of(byte_order: str = "little", bit_order: str = "lsb0") -> Node:
    return Node("n", "", "", byte_order, bit_order, (), ())


def number(at: int, bits: int, order: str = "", numbering: str = "") -> FrameField:
    scalar = Scalar(name="A", at=at, bits=bits, type="uint")
    return FrameField((PathStep(scalar),), at, bits, scalar, order, numbering)


def physical(at: int, bit_order: str) -> int:
    """Return bit ``at`` of a frame, counted from the least significant one of byte 0."""
    return at if bit_order == "lsb0" else at // 8 * 8 + 7 - at % 8


@settings(max_examples=60)
@given(st.integers(0, 40), st.integers(1, 64), st.sampled_from(ORDERS), st.booleans())
def test_a_mask_has_each_bit_of_a_field(at, bits, orders, is_default):
    """The orders of the field are used, or those of the node if it has none."""
    other = ("big", "msb0") if orders == ("little", "lsb0") else ("little", "lsb0")
    field = number(at, bits) if is_default else number(at, bits, *orders)
    node = node_of(*(orders if is_default else other))
    expected = sum(1 << physical(bit, orders[1]) for bit in range(at, at + bits))
    assert frame_bits.mask(field, node) == expected
    pieces = frame_bits.pieces(field, node)
    assert [piece.byte for piece in pieces] == list(frame_bits.byte_range(field))
    # The least significant piece is the last one in big-endian order.
    lowest = pieces[0 if orders[0] == "little" else -1]
    assert lowest.at == 0


@settings(max_examples=60)
@given(
    st.lists(
        st.tuples(st.integers(0, 70), st.integers(1, 20), st.sampled_from(ORDERS)),
        max_size=4,
    ),
    st.lists(st.tuples(st.integers(0, 80), st.integers(0, 20)), max_size=2),
    st.integers(0, 12),
    st.sampled_from(ORDERS),
)
def test_reserved_bits_are_in_no_field_and_no_omitted_range(
    places, omitted, length, orders
):
    fields = [
        number(at, min(bits, 8 * length - at), *own)
        for at, bits, own in places
        if at < 8 * length
    ]
    skipped = [range(at, min(at + bits, 8 * length)) for at, bits in omitted]
    used = {
        physical(bit, field.bit_order)
        for field in fields
        for bit in range(field.at, field.at + field.bits)
    }
    used |= {physical(bit, orders[1]) for run in skipped for bit in run}
    free = [bit for bit in range(8 * length) if physical(bit, orders[1]) not in used]
    runs = frame_bits.reserved_bits_between(fields, skipped, length, node_of(*orders))
    assert [bit for run in runs for bit in range(run.at, run.at + run.bits)] == free
    # Neighbouring runs would be one.
    ends = [run.at + run.bits for run in runs]
    assert all(end < run.at for end, run in zip(ends, runs[1:], strict=False))


FRAMES = """\
structs:
  - name: Pair
    length: 2
    fields:
      - {at: 0, bits: 3, name: A, type: uint}
      - {at: 8, bits: 8, name: B, type: uint}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 12
    fields:
      - {at: 0,  bits: 8,  name: Kind, type: uint, const: 3}
      - {at: 12, bits: 16, name: Mark, type: uint, const: 0xA5C3}
      - {at: 28, bits: 4,  name: Low,  type: uint, const: 9}
      - {at: 32, count: 3, struct: Pair, name: Pairs}
      - {at: 88, bits: 4,  name: Last, type: uint}
      - {at: 88, bits: 8,  name: View, type: uint, view: true}
  - name: Other
    id: 130
    kind: telemetry
    length: 12
    fields:
      - {at: 0,  bits: 8,  name: Kind, type: uint, const: 4}
"""


def status(folder: Path) -> tuple[Node, Message]:
    loaded = load([write(folder, FRAMES)], check=False)
    assert not loaded.findings
    node = loaded.icd.nodes[0]
    return node, node.messages[0]


def test_the_first_element_of_an_array_has_reserved_bits_and_an_overlay_hides_none(
    tmp_path,
):
    node, message = status(tmp_path)
    assert frame_bits.reserved_bits(message, node) == (
        (8, 4),
        (35, 5),
        (80, 8),
        (92, 4),
    )


def test_bytes_of_constants_combine_those_of_all_of_them(tmp_path):
    node, message = status(tmp_path)
    icd = load([write(tmp_path, FRAMES)], check=False).icd
    first, second = ids_of(icd, node).telemetry[130]
    assert (first.message.name, second.message.name) == ("Status", "Other")
    kind, mark, low, *_ = frame_fields(message.layout, node.orders)
    both = first._replace(constants=(low, mark, kind))
    assert frame_bits.constant_bytes(both) == (
        (0, 0xFF, 3),
        (1, 0xF0, 0x30),
        (2, 0xFF, 0x5C),
        (3, 0xFF, 0x9A),
    )


@pytest.mark.parametrize(
    ("at", "bits", "expected"),
    [
        (0, 1, range(1)),
        (7, 1, range(1)),
        (8, 8, range(1, 2)),
        (7, 2, range(2)),
        (0, 9, range(2)),
        (16, 32, range(2, 6)),
    ],
)
def test_a_field_has_the_bytes_from_its_first_to_its_last_bit(at, bits, expected):
    assert frame_bits.byte_range(number(at, bits)) == expected
