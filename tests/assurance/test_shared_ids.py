"""Changes of messages that share an id fail exactly the frames that change their
message.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen import codec
from icdgen.backends.assurance.shared_ids import SharedIds
from icdgen.icd.layout_copies import with_node
from icdgen.loading import load
from icdgen.vectors.lines import line_numbers
from icdgen.vectors.make import make_vectors
from icdgen.vectors.write import vector_file_text
from tests.icd.files import loaded

ICD = """\
messages:
  - {name: Stop, id: 0, kind: telecommand, length: 2, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 1},
      {at: 8, bits: 8, name: Level, type: uint}]}
  - {name: Go, id: 0, kind: telecommand, length: 2, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 2}]}
  - {name: Long, id: 0, kind: telecommand, length: 3, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 2}]}
  - {name: Other, id: 255, kind: telecommand, length: 1}
"""


@pytest.fixture
def shared(tmp_path):
    icd = loaded(tmp_path, ICD).icd
    (node,) = icd.nodes
    vectors = make_vectors(icd, node)
    lines = line_numbers(vectors, vector_file_text(vectors))
    return (
        icd,
        vectors.shared,
        lines.shared,
        SharedIds(icd, {"demo": vectors}, {"demo": lines}),
    )


def outcome(icd, messages, frame):
    """Return the message of a frame or its expected length, from the codec."""
    try:
        message = codec.message_of_frame(icd, messages, frame)
    except codec.LengthError as error:
        return error.expected
    return message and message.name


def with_constant(message, value):
    node = message.layout.nodes[0]
    now = with_node(message.layout, node, replace(node, const=value))
    return replace(message, layout=now)


def test_a_changed_constant_fails_the_frames_that_change_their_message(shared):
    icd, rows, numbers, ids = shared
    stop, go, long, _ = icd.nodes[0].messages
    assert len(rows) == len(numbers) > 5
    for message, value in ((stop, 2), (stop, 9), (go, 3), (long, 1)):
        now = with_constant(message, value)
        messages = [now if each is message else each for each in (stop, go, long)]
        expected = [
            number
            for number, row in zip(numbers, rows, strict=True)
            if outcome(icd, messages, row.frame)
            != (row.message if row.expected is None else row.expected)
        ]
        assert ids.detect_message(message, now) == {"demo": expected}


def test_an_unchanged_message_fails_no_frame(shared):
    icd, _, _, ids = shared
    for message in icd.nodes[0].messages:
        assert ids.detect_message(message, message) == {}


def test_a_message_of_another_id_fails_no_frame(shared):
    icd, _, _, ids = shared
    *_, other = icd.nodes[0].messages
    assert ids.detect_message(other, replace(other, id=0)) == {}


def test_a_lost_id_fails_the_frames_of_its_message(shared):
    icd, rows, numbers, ids = shared
    stop, *_ = icd.nodes[0].messages
    detected = ids.detect_message(stop, replace(stop, id=9))["demo"]
    of_stop = [
        number
        for number, row in zip(numbers, rows, strict=True)
        if row.message == "Stop"
    ]
    assert {*of_stop} <= {*detected}


def test_other_orders_of_a_node_fail_frames_of_its_shared_ids(shared):
    icd, _, _, ids = shared
    (node,) = icd.nodes
    assert ids.detect_node(node, node) == {}
    assert set(ids.detect_node(node, replace(node, bit_order="msb0"))) <= {"demo"}


BOTH = """\
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
messages:
  - {name: Stop, id: 1, kind: telecommand, length: 2, fields: [
      {at: 0, bits: 16, name: Kind, type: uint, const: 1}]}
  - {name: Go, id: 1, kind: telecommand, length: 2, fields: [
      {at: 0, bits: 16, name: Kind, type: uint, const: 2}]}
  - {name: Low, id: 1, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 1}]}
  - {name: High, id: 1, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 2}]}
"""
USER = """\
icdgen: 1
node: {name: user, title: User, byte_order: little, bit_order: lsb0}
include: [base.yaml]
messages:
  - {name: Last, id: 1, kind: telecommand, length: 3}
"""


@pytest.fixture
def nodes(tmp_path):
    for name, text in (("base", BOTH), ("user", USER)):
        (tmp_path / f"{name}.yaml").write_text(text, "utf-8")
    icd = load([tmp_path]).icd
    vectors = {node.name: make_vectors(icd, node) for node in icd.nodes}
    lines = {
        name: line_numbers(each, vector_file_text(each))
        for name, each in vectors.items()
    }
    return icd, vectors, lines, SharedIds(icd, vectors, lines)


def rows_of(nodes, name, direction):
    _, vectors, lines, _ = nodes
    pairs = zip(lines[name].shared, vectors[name].shared, strict=True)
    return {number: row for number, row in pairs if row.direction == direction}


def test_a_byte_order_changes_frames_of_wide_constants_in_all_nodes(nodes):
    icd, *_, ids = nodes
    base = icd.node("base")
    detected = ids.detect_node(base, replace(base, byte_order="big"))
    assert detected.keys() == {"base", "user"}
    for name, numbers in detected.items():
        telecommands = rows_of(nodes, name, "telecommand")
        named = {
            number
            for number, row in telecommands.items()
            if row.message in ("Stop", "Go")
        }
        assert named <= {*numbers} <= telecommands.keys()


def test_a_message_of_one_direction_fails_only_frames_of_it(nodes):
    icd, *_, ids = nodes
    low = next(m for m in icd.node("base").messages if m.name == "Low")
    detected = ids.detect_message(low, with_constant(low, 9))
    for name in ("base", "user"):
        telemetry = rows_of(nodes, name, "telemetry")
        named = {number for number, row in telemetry.items() if row.message == "Low"}
        assert named and named <= {*detected[name]} <= telemetry.keys()
