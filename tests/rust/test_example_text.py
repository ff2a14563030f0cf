"""Statements of the examples in the documentation of generated Rust."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.rust import examples
from icdgen.describe import describe
from icdgen.describe.examples import ExampleValue, example_of_message
from tests.icd.files import loaded, status

ENUMS = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 3, name: Self test}]}
"""
STATEMENTS = [
    (
        "bits: 16, type: int, unit: V, formula: raw*0.01",
        "assert_eq!(message.type_v(), 12.34);",
        "command.set_type_v(12.34)?;",
    ),
    (
        "bits: 16, type: uint",
        "assert_eq!(message.r#type, 1_234);",
        "command.r#type = 1_234;",
    ),
    (
        "bits: 32, type: float",
        "assert_eq!(message.r#type, 1.5);",
        "command.r#type = 1.5;",
    ),
    ("bits: 1, type: bool", "assert!(message.r#type);", "command.r#type = true;"),
    (
        "bits: 8, type: enum, enum: Mode",
        "assert_eq!(message.r#type, enums::Mode::SelfTest);",
        "command.r#type = enums::Mode::SelfTest.into();",
    ),
]


@pytest.mark.parametrize(("field", "reading", "writing"), STATEMENTS)
def test_an_example_reads_and_sets_the_shown_value(tmp_path, field, reading, writing):
    result = loaded(tmp_path, ENUMS + status(f"at: 0, name: Type, {field}", length=4))
    (message,) = describe(result.icd).nodes[0].messages
    shown = example_of_message(message).shown
    assert examples.read_example(shown) == reading
    assert examples.write_example(shown) == writing


def test_a_value_without_setter_is_set_raw(tmp_path):
    field = "bits: 8, type: uint, points: [[0, 0], [100, 5], [255, 0]]"
    result = loaded(tmp_path, status(f"at: 0, name: Rate, {field}", length=1))
    ((member,),) = (m.members for m in describe(result.icd).nodes[0].messages)
    shown = ExampleValue(member, 100, 5.0)
    assert examples.read_example(shown) == "assert_eq!(message.rate_physical(), 5.0);"
    assert examples.write_example(shown) == "command.rate = 100;"


def test_a_flag_that_is_not_set_is_false(tmp_path):
    result = loaded(
        tmp_path, status("at: 0, bits: 1, name: Flag, type: bool", length=1)
    )
    ((member,),) = (m.members for m in describe(result.icd).nodes[0].messages)
    assert examples.write_example(ExampleValue(member, 0, None)) == (
        "command.flag = false;"
    )


def test_bytes_are_shown_if_there_are_eight_at_most():
    assert examples.is_short(bytes(8)) and not examples.is_short(bytes(9))
    assert examples.byte_array(b"\x00\x0a\xff") == "[0x00, 0x0a, 0xff]"
    assert examples.byte_array(b"") == "[]"


TELEMETRY = """\
messages:
  - {name: Long, id: 0, kind: telemetry, length: 9, fields: [
      {at: 0, bits: 8, name: Rate, type: uint, formula: raw*0.5}]}
  - {name: Other, id: 1, kind: telemetry, length: 8, fields: [
      {at: 0, bits: 8, name: Rate, type: uint, formula: raw*0.5}]}
  - {name: Raw, id: 2, kind: telemetry, length: 8, fields: [
      {at: 0, bits: 8, name: Rate, type: uint}]}
  - {name: Scaled, id: 255, kind: telemetry, length: 8, fields: [
      {at: 0, bits: 8, name: Rate, type: uint, formula: raw*0.5}]}
"""


def test_a_client_requests_a_short_message_with_a_scale(tmp_path):
    (node,) = describe(loaded(tmp_path, TELEMETRY).icd).nodes

    def requested(ids, framing="escape"):
        facts = SimpleNamespace(framing=framing, telemetry=dict.fromkeys(ids))
        message = examples.client_message(node, SimpleNamespace(facts=facts))
        return message and message.model.name

    assert requested({0, 2, 255}) == "Scaled"
    assert requested({0, 2}) == "Raw"
    assert requested({0}) is None
    assert requested({2}, framing=None) is None
    assert examples.client_message(node, None) is None
