"""Nodes and messages: ids, directions, shared ids, included nodes and recognition of
frames.
"""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.loading import load
from tests.describe.small import node_of
from tests.icd.files import status, write

MESSAGES = """\
messages:
  - {name: Zero, id: 0, kind: telecommand, length: 0}
  - {name: Last, id: 255, kind: telemetry, length: 0}
  - {name: Config, set_id: 7, get_id: 9, kind: configuration, length: 0}
"""


def test_a_message_has_its_ids_and_the_directions_of_these(tmp_path):
    node = node_of(tmp_path, MESSAGES)
    ids = {
        message.name: [(id.name, id.value) for id in message.ids]
        for message in node.messages
    }
    assert ids == {
        "zero": [("id", 0)],
        "last": [("id", 255)],
        "config": [("set_id", 7), ("get_id", 9)],
    }
    assert [message.directions for message in node.messages] == [
        ("telecommand",),
        ("telemetry",),
        ("telecommand", "telemetry"),
    ]
    assert [id.comment for message in node.messages for id in message.ids] == [
        "Id of the telecommand.",
        "Id of the telemetry.",
        "Id of the telecommand that sets it.",
        "Id of the telemetry that gets it.",
    ]
    assert [
        (kind, [(message.name, name) for message, name in messages])
        for kind, messages in node.directions
    ] == [
        ("telecommand", [("zero", "id"), ("config", "set_id")]),
        ("telemetry", [("last", "id"), ("config", "get_id")]),
    ]


def test_an_id_has_the_name_of_its_constant(tmp_path):
    node = node_of(tmp_path, MESSAGES)
    names = {
        direction: [(of_id.id, of_id.first.id_name) for of_id in node.ids(direction)]
        for direction in ("telecommand", "telemetry")
    }
    assert names == {
        "telecommand": [(0, "id"), (7, "set_id")],
        "telemetry": [(255, "id"), (9, "get_id")],
    }


def test_names_of_checksums_are_those_of_the_link(tmp_path):
    text = """\
protocol:
  link:
    checksums:
      crc8: {kind: crc, width: 8, polynomial: 7, init: 0, xor_out: 0,
             reflect_in: false, reflect_out: false}
      sum: {kind: sum, width: 8}
"""
    node = node_of(tmp_path, text)
    assert node.checksums == ("crc8", "sum")
    assert node.is_linked
    assert node_of(tmp_path, MESSAGES).checksums == ()


def test_comments_on_telemetry_have_its_bit_of_the_log_mask(tmp_path):
    text = (
        MESSAGES + "loggable: [{bit: 3, id: 255}, {bit: 4, id: 0}, {bit: 5, id: 9}]\n"
    )
    node = node_of(tmp_path, text)
    bits = [
        [bit for bit in range(9) if f"Bit {bit} of the log" in paragraphs]
        for message in node.messages
        for paragraphs in [" ".join(message.comment.paragraphs)]
    ]
    # The id 0 is that of a telecommand.
    assert bits == [[], [3], [5]]
    assert node.log_bits == {255: 3, 0: 4, 9: 5}


def test_a_direction_without_messages_is_left_out(tmp_path):
    text = MESSAGES.splitlines()[:2]
    node = node_of(tmp_path, "\n".join(text) + "\n")
    assert [direction.kind for direction in node.directions] == ["telecommand"]


SHARED = """\
messages:
  - {name: Any, id: 5, kind: telemetry, shares_id: true, length: LENGTH}
  - name: Start
    id: 5
    kind: telemetry
    shares_id: true
    length: 2
    fields:
      - {at: 0, bits: 8, name: Action, type: uint, const: 1}
      - {at: 12, bits: 4, name: Low, type: uint, const: 10}
  - name: Stop
    id: 5
    kind: telemetry
    shares_id: true
    length: 2
    fields: [{at: 0, bits: 8, name: Action, type: uint, const: 2}]
  - {name: Alone, id: 6, kind: telemetry, length: 0}
"""


@pytest.mark.parametrize(
    ("length", "common", "fallback"), [(2, 2, "any"), (3, None, None)]
)
def test_messages_of_a_shared_id_are_recognized_by_their_constants(
    tmp_path, length, common, fallback
):
    node = node_of(tmp_path, SHARED.replace("LENGTH", str(length)))
    shared, alone = node.ids("telemetry")
    assert (shared.id, shared.is_shared, shared.length) == (5, True, common)
    constants = {
        row.message.name: [tuple(byte) for byte in row.constant_bytes]
        for row in shared.messages
    }
    assert constants == {
        "start": [(0, 0xFF, 1), (1, 0xF0, 0xA0)],
        "stop": [(0, 0xFF, 2)],
        "any": [],
    }
    assert [row.message.name for row in shared.messages][-1] == "any"
    assert shared.first is shared.messages[0]
    # Only the length of a frame of the last message can be wrong.
    last = shared.fallback and shared.fallback.message.name
    assert last == fallback
    assert len(shared.tested) == 3 - (fallback is not None)
    assert (alone.id, alone.is_shared, alone.tested) == (6, False, ())
    assert alone.fallback is alone.first
    messages = {message.name: message for message in node.messages}
    assert node.shares_ids("telemetry") and not node.shares_ids("telecommand")
    assert node.shares_id("telemetry", messages["start"])
    assert not node.shares_id("telemetry", messages["alone"])


def test_a_frame_can_lack_the_bytes_behind_its_shortest_form(tmp_path):
    text = """\
messages:
  - name: Short
    id: 5
    kind: telemetry
    shares_id: true
    length: 3
    may_end_early: zeros
    fields:
      - {at: 0, bits: 8, name: A, type: uint, const: 1}
      - {at: 8, bits: 8, name: B, type: uint, const: 0}
      - {at: 16, bits: 8, name: C, type: uint, const: 2}
  - name: Other
    id: 5
    kind: telemetry
    shares_id: true
    length: 3
    fields: [{at: 0, bits: 8, name: A, type: uint, const: 2}]
"""
    rows = node_of(tmp_path, text).ids("telemetry")[0].messages
    lacking = {
        row.message.name: [row.can_lack(byte) for byte in row.constant_bytes]
        for row in rows
    }
    assert lacking == {"short": [False, True, True], "other": [False]}


INCLUDING = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
include: [common.yaml]
messages:
  - {name: Own, id: 1, kind: telecommand, length: 0}
enums:
  - {name: Mode, members: [{value: 1, name: Idle}]}
structs:
  - {name: Point, length: 1, fields: [{at: 0, bits: 8, name: X, type: uint}]}
# common.yaml
icdgen: 1
node: {name: common, title: Common, byte_order: big, bit_order: lsb0}
messages:
  - {name: Ping, id: 2, kind: telecommand, length: 0}
"""


def test_a_node_uses_the_messages_of_included_nodes_before_its_own(tmp_path):
    path = write(tmp_path, INCLUDING)
    description = describe(load([path, tmp_path / "common.yaml"], check=False).icd)
    demo, common = description.node("demo"), description.node("common")
    assert description.nodes == (common, demo)
    assert demo.included == ("common",)
    assert [message.name for message in demo.messages] == ["own"]
    assert [message.name for message in demo.all_messages] == ["ping", "own"]
    assert demo.all_messages[0] is common.messages[0]
    assert [part.name for part in demo.usable] == ["ping", "own", "mode", "point"]
    assert [part.name for part in demo.composites] == ["point", "own"]
    assert description.users_of(common.model) == (common, demo)
    assert description.users_of(demo.model) == (demo,)
    with pytest.raises(KeyError):
        description.node("other")
    assert not demo.is_linked and not demo.has_client


@pytest.mark.parametrize(
    ("id", "id_bits", "bits"),
    [
        (255, 8, 8),
        (256, 8, 16),
        (65535, 8, 16),
        (65536, 8, 32),
        (0, 32, 32),
        (0, 9, 16),
    ],
)
def test_ids_have_the_smallest_type_for_all_of_them(tmp_path, id, id_bits, bits):
    text = (
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, "
        f"bit_order: lsb0, id_bits: {id_bits}}}\n"
        f"messages: [{{name: Any, id: {id}, kind: telecommand, length: 0}}]\n"
    )
    icd = load([write(tmp_path, text)], check=False).icd
    assert describe(icd).id_bits == bits
    assert describe(icd).node("demo").id_bits == bits


def test_a_set_is_described_once_while_it_is_one_of_the_last_two(tmp_path):
    icds = [load([write(tmp_path, MESSAGES)], check=False).icd for _ in range(3)]
    first, second = describe(icds[0]), describe(icds[1])
    assert describe(icds[0]) is first and describe(icds[1]) is second
    describe(icds[2])
    assert describe(icds[1]) is second
    assert describe(icds[0]) is not first


PARTS = """\
structs:
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Points, type: uint, count: Inner, up_to: 3}
      - {at: 8, after: Points, bits: 8, name: Trailer, type: uint}
messages:
  - name: Curves
    id: 7
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 8, name: Inner, type: uint}
      - {at: 24, name: Curves, struct: Curve, count: Number, up_to: 2}
      - {at: 24, after: Curves, bits: 8, name: More, type: uint, count: rest, up_to: 4}
  - {name: Empty, id: 8, kind: telemetry, length: 2}
"""


def test_a_message_has_physical_and_wide_values_if_one_of_its_own_members_has(tmp_path):
    def message(number, *fields, derived=""):
        folder = tmp_path / str(number)
        folder.mkdir()
        text = status("at: 0, name: Raw, bits: 16, type: uint", *fields, length=4)
        (one,) = node_of(folder, text + derived).messages
        return one.has_physical, one.has_wide_steps

    scaled = "at: 16, name: Rate, bits: 16, type: uint, formula: raw*0.5"
    wide = "at: 16, name: Rate, bits: 16, type: uint, formula: raw*2^-70"
    derived = "    derived: [{name: Twice, formula: Raw*2}]\n"
    assert message(1) == (False, False)
    assert message(2, scaled) == (True, False)
    assert message(3, wide) == (True, True)
    assert message(4, derived=derived) == (True, False)


def test_parts_of_variable_length_are_listed_with_those_in_their_elements(tmp_path):
    curves, empty = node_of(tmp_path, PARTS).messages
    names = [part.field.name for part in curves.variable_parts]
    assert names == ["curves", "more"]
    assert [part.field.name for part in curves.counted_parts] == [*names, "points"]
    assert [part.field.name for part in curves.earlier_parts] == ["curves"]
    assert [part.field.name for part in curves.spread_parts] == ["curves"]
    assert curves.last_part is curves.variable_parts[-1]
    assert [part.counter.name for part in curves.counted_parts] == [
        "number",
        "more_count",
        "inner",
    ]
    assert [part.is_rest for part in curves.variable_parts] == [False, True]
    chunks = [
        (chunk.begin, chunk.fixed, chunk.inner and chunk.inner.field.name)
        for chunk in curves.variable_parts[0].chunks
    ]
    assert chunks == [(0, 1, "points"), (7, 1, None)]
    assert curves.has_inner_gaps and curves.fixed_length == 3
    assert (curves.has_reserved_bits, curves.is_narrow) == (True, True)
    assert empty.last_part is None and empty.variable_parts == ()
    assert (empty.has_reserved_bits, empty.is_narrow) == (True, False)
