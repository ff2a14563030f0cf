"""Conversions of a composite message copy each member from the fields with its bits."""

from __future__ import annotations

from icdgen.backends.rust.parts import parts_of
from icdgen.describe import describe
from tests.icd.files import loaded

ICD = """\
structs:
  - {name: Point, length: 2, fields: [
      {at: 0, bits: 8, name: Type, type: uint}, {at: 8, bits: 8, name: Height, type: uint}]}
messages:
  - {name: Mode, id: 1, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Type, type: uint}]}
  - {name: Levels, id: 2, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Levels, type: uint, count: 2}]}
  - {name: Track, id: 3, kind: telemetry, length: 6, fields: [
      {at: 0, name: Start, struct: Point}, {at: 16, name: Ends, struct: Point, count: 2}]}
  - {name: Empty, id: 4, kind: telemetry, length: 0}
  - name: All
    id: 0
    kind: telemetry
    length: 12
    contains:
      - {at: 8, message: Mode}
      - {at: 0, message: Mode}
      - {at: 16, message: Levels}
      - {at: 32, message: Levels}
      - {at: 48, message: Track}
      - {at: 48, message: Empty}
    fields:
      - {at: 0, bits: 8, name: Type, type: uint}
      - {at: 8, bits: 8, name: Other, type: uint}
      - {at: 16, bits: 8, name: Levels, type: uint, count: 2}
      - {at: 32, bits: 8, name: First, type: uint}
      - {at: 40, bits: 8, name: Second, type: uint}
      - {at: 48, name: Start, struct: Point}
      - {at: 64, name: Ends, struct: Point, count: 2}
"""


def test_each_contained_message_is_a_conversion(tmp_path):
    result = loaded(tmp_path, ICD)
    assert result.ok, [finding.message for finding in result.findings]
    message = describe(result.icd).nodes[0].messages[-1]
    conversions = parts_of(message)
    assert [(each.type, each.is_array, each.message) for each in conversions] == [
        ("[super::Mode; 2]", True, "super::Mode"),
        ("[super::Levels; 2]", True, "super::Levels"),
        ("super::Track", False, "super::Track"),
    ]
    assert [each.values for each in conversions] == [
        (("r#type: message.other",), ("r#type: message.r#type",)),
        (
            ("levels: message.levels",),
            ("levels: [message.first, message.second]",),
        ),
        (
            (
                "start: super::Point { r#type: message.start.r#type, height: message.start.height }",
                "ends: [super::Point { r#type: message.ends[0].r#type, height: message.ends[0].height },"
                " super::Point { r#type: message.ends[1].r#type, height: message.ends[1].height }]",
            ),
        ),
    ]
    assert [each.about for each in conversions] == [
        "Mode, repeated from byte 1 and from byte 0.",
        "Levels, repeated from byte 2 and from byte 4.",
        "Track, repeated from byte 6.",
    ]
