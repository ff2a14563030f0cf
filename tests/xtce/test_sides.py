"""A direction of XTCE has the header of its node, and texts that XML permits."""

from __future__ import annotations

import pytest

from icdgen.backends.xtce.sides import _head, direction_content, xml_text
from icdgen.backends.xtce.types import TypeBuilder
from icdgen.describe import describe
from icdgen.icd.model import TELECOMMAND, TELEMETRY
from tests.icd.files import loaded

PACKET = {
    "link": {
        "header": [
            {"at": at, "bits": bits}
            for at, bits in (
                (0, 3),
                (3, 1),
                (4, 1),
                (5, 11),
                (16, 2),
                (18, 14),
                (32, 16),
            )
        ]
    }
}


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a\n  b\tc ", "a b c"),
        ("a\x00\x07\x1fb", "a b"),
        ("\x7f\x9fa", "a"),
        ("é \u2026 \U0001f600", "é \u2026 \U0001f600"),
        ("a\ufffe\uffff\ud800b", "a b"),
        (12, "12"),
    ],
)
def test_a_text_is_one_line_of_characters_that_xml_permits(text, line):
    assert xml_text(text) == line


@pytest.mark.parametrize(
    ("id_bits", "bits"), [(1, 8), (8, 8), (9, 16), (16, 16), (17, 24)]
)
def test_without_packets_the_header_is_an_id_of_whole_bytes(id_bits, bits):
    for direction in (TELEMETRY, TELECOMMAND):
        head = _head(id_bits, {}, direction, TypeBuilder())
        assert (head.id, head.bits) == ("Id", bits)
        assert head.rows == (("Id", f"uint{bits}", *head.rows[0][2:]),)
        (entry,) = head.entries
        assert (entry.name, entry.run[:2], entry.value) == ("Id", (0, bits), None)


def test_the_header_of_a_space_packet_is_recognized_by_its_positions():
    head = _head(8, PACKET, TELEMETRY, TypeBuilder())
    assert (head.id, head.bits) == ("Apid", 48)
    assert [(row.name, row.type) for row in head.rows] == [
        ("Version", "uint3"),
        ("Type", "uint1"),
        ("SecondaryHeader", "uint1"),
        ("Apid", "uint11"),
        ("SequenceFlags", "uint2"),
        ("SequenceCount", "uint14"),
        ("Length", "uint16"),
    ]
    other = {"link": {"header": PACKET["link"]["header"][:-1]}}
    assert _head(8, other, TELEMETRY, TypeBuilder()).id == "Id"


def test_a_telecommand_has_fixed_values_except_for_its_id():
    head = _head(8, PACKET, TELECOMMAND, TypeBuilder())
    assert [row.name for row in head.rows] == ["Apid"]
    assert [(entry.name, entry.value) for entry in head.entries] == [
        ("Version", "00"),
        ("Type", "01"),
        ("SecondaryHeader", "00"),
        ("Apid", None),
        ("SequenceFlags", "03"),
        ("SequenceCount", "0000"),
        ("Length", "0000"),
    ]


SET = """\
messages:
  - name: Set
    id: 300
    kind: telecommand
    length: 13
    fields:
      - {at: 3, bits: 5, name: Kind, type: uint, const: 0x15}
      - {at: 8, bits: 12, name: Rate, type: uint, const: 0xABC}
      - {at: 24, bits: 8, name: Mode, type: uint}
"""


def test_a_telecommand_has_fixed_values_of_constants_and_reserved_bits(tmp_path):
    result = loaded(tmp_path, SET)
    node = describe(result.icd).nodes[0]
    content = direction_content(result.icd, node, TELECOMMAND)
    assert direction_content(result.icd, node, TELEMETRY) is None
    (frame,) = content.frames
    assert (content.head.bits, frame.id, frame.lacks) == (16, 300, [])
    rows = [(e.name, e.run.at, e.run.bits, e.value) for e in frame.entries]
    # Bits of the value in the order of the frame: each entry begins where the one
    # before ends.
    at = content.head.bits
    bits = ""
    for _, start, width, value in rows:
        assert start == at
        at += width
        bits += "." * width if value is None else f"{int(value, 16):0{width}b}"
    expected = ["10101000", "10111100", "00001010", "." * 8, *["0" * 8] * 9]
    assert bits == "".join(expected)
    assert [row.name for row in frame.rows] == ["Mode"]


def test_adjacent_bits_of_a_constant_are_one_fixed_value(tmp_path):
    text = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}
messages:
  - name: Set
    id: 3
    kind: telecommand
    length: 3
    fields:
      - {at: 2, bits: 20, name: Rate, type: uint, const: 0xABCDE}
"""
    result = loaded(tmp_path, text)
    node = describe(result.icd).nodes[0]
    (frame,) = direction_content(result.icd, node, TELECOMMAND).frames
    assert [(e.run.at - 8, e.run.bits, e.value) for e in frame.entries] == [
        (0, 2, "00"),
        (2, 20, "0ABCDE"),
        (22, 2, "00"),
    ]


SHARED = """\
messages:
  - name: First
    id: 5
    kind: telemetry
    shares_id: true
    length: 3
    fields:
      - {at: 0, bits: 8, name: Type, type: uint, const: 7}
      - {at: 8, bits: 8, name: Kind, type: uint, const: 3}
      - {at: 16, bits: 8, name: Mark, type: uint, const: 9}
  - name: Second
    id: 5
    kind: telemetry
    shares_id: true
    length: 2
    fields:
      - {at: 0, bits: 8, name: Type, type: uint, const: 8}
      - {at: 8, bits: 8, name: Value, type: uint}
"""


def test_messages_are_selected_by_constants_within_the_shortest_frame(tmp_path):
    result = loaded(tmp_path, SHARED)
    assert result.ok, [finding.message for finding in result.findings]
    node = describe(result.icd).nodes[0]
    content = direction_content(result.icd, node, TELEMETRY)
    (base,) = content.bases
    assert (base.name, base.id) == ("Id5", 5)
    # Behind the id of 8 bits; `Mark` is beyond the end of `Second`.
    assert [(e.name, e.at, e.run.bits) for e in base.entries.values()] == [
        ("Id5_0_8", 8, 8),
        ("Id5_8_8", 16, 8),
    ]
    assert [frame.discriminators for frame in content.frames] == [
        [("Id5_0_8", 7), ("Id5_8_8", 3)],
        [("Id5_0_8", 8)],
    ]
    first, second = ([(e.name, e.at) for e in f.entries] for f in content.frames)
    assert first == [("First_Type", 8), ("First_Kind", 16), ("First_Mark", 24)]
    assert second == [("Second_Type", 8), ("Second_Value", 16)]


VARIABLE = """\
messages:
  - name: Log
    id: 5
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Size, type: uint}
      - {at: 8, name: Data, type: bytes, size: {field: Size, plus: -2}, up_to: 9}
"""


def test_a_variable_field_has_its_counter_and_its_largest_size(tmp_path):
    result = loaded(tmp_path, VARIABLE)
    assert result.ok, [finding.message for finding in result.findings]
    node = describe(result.icd).nodes[0]
    content = direction_content(result.icd, node, TELEMETRY)
    (frame,) = content.frames
    assert [(e.name, e.at, e.is_array) for e in frame.entries] == [
        ("Log_Size", None, False),
        ("Log_Data", None, False),
    ]
    row = next(row for row in frame.rows if row.name == "Log_Data")
    type_ = content.types[row.type]
    assert (type_.kind, type_.count, type_.counter) == ("Binary", 9, "Log_Size")
    assert (type_.plus, type_.bits, row.most) == (-2, 0, 9)
