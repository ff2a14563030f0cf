"""Facts and data of the page of a message."""

from __future__ import annotations

import pytest

from icdgen.backends.html import messages
from icdgen.backends.html.examples import example_frames
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.sections import MessageSection
from tests.icd.files import loaded

ICD = """\
structs:
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Points, type: uint, count: Inner, up_to: 3}
messages:
  - {name: Stop, id: 0, kind: telecommand, length: 3, reserved: 2, group: Setup, source: {table: 3, page: 12}, fields: [
      {at: 0, bits: 8, name: Level, type: uint}]}
  - {name: Quiet, id: 255, kind: telecommand, acknowledge: false, length: 1, reserved: 1}
  - {name: Early, id: 1, kind: telemetry, length: 3, may_end_early: zeros, period_ms: 100, fields: [
      {at: 0, bits: 24, name: Level, type: uint}]}
  - {name: Levels, id: 2, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Count, type: uint},
      {at: 8, bits: 16, name: Levels, type: uint, count: Count, up_to: 3}]}
  - {name: Bytes, id: 3, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Kind, type: uint},
      {at: 8, name: Content, type: bytes, size: rest, up_to: 1}]}
  - {name: Behind, id: 4, kind: telemetry, length: 0, fields: [
      {at: 0, bits: 16, name: Values, type: int, count: rest, up_to: 6},
      {at: 0, after: Values, bits: 32, name: Time, type: float}]}
  - {name: Curves, id: 5, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 8, name: Last, type: uint},
      {at: 8, bits: 8, name: Inner, type: uint},
      {at: 16, name: Curves, struct: Curve, count: {field: Last, plus: 1}, up_to: 2},
      {at: 16, after: Curves, bits: 16, name: CRC, type: uint}]}
"""
FACTS = {
    "Stop": [
        ("Length", "3 bytes"),
        ("Fields", "1"),
        ("Reserved", "last 2 bytes"),
        ("Group", "Setup"),
        ("Acknowledged", "yes"),
        ("Manual", "table 3, page 12"),
    ],
    "Quiet": [
        ("Length", "1 byte"),
        ("Fields", "0"),
        ("Reserved", "last 1 byte"),
        ("Acknowledged", "no"),
    ],
    "Early": [
        ("Length", "1 to 3 bytes"),
        ("Fields", "1"),
        ("End", "trailing zeros may be omitted"),
        ("Period", "100 ms"),
    ],
    "Levels": [
        ("Length", "1 to 7 bytes"),
        ("Fields", "2"),
        ("Variable end", "Levels: up to 3 elements, as many as Count says"),
    ],
    "Bytes": [
        ("Length", "1 to 2 bytes"),
        ("Fields", "2"),
        ("Variable end", "Content: up to 1 byte, up to the end"),
    ],
    "Behind": [
        ("Length", "4 to 16 bytes"),
        ("Fields", "2"),
        ("Variable part", "Values: up to 6 elements, up to the fields behind it"),
    ],
    "Curves": [
        ("Length", "5 to 18 bytes"),
        ("Fields", "5"),
        ("Variable part", "Curves: up to 2 elements, as many as Last + 1 says"),
        (
            "Variable part",
            "Points in each of Curves: up to 3 elements, as many as Inner says",
        ),
    ],
}


@pytest.mark.parametrize("name", FACTS)
def test_a_page_states_the_facts_of_its_message(tmp_path, name):
    result = loaded(tmp_path, ICD)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = result.icd.nodes
    (message,) = (message for message in node.messages if message.name == name)
    facts = messages._facts(Relations(result.icd), node, message)
    assert [(label, text) for label, text, _ in facts] == FACTS[name]


def test_the_data_of_the_decoder_has_the_sections_with_fields(tmp_path):
    result = loaded(tmp_path, ICD)
    (node,) = result.icd.nodes
    relations = Relations(result.icd)
    stop, *_, curves = node.messages
    shares = [
        MessageSection("Byte 0", 0, 1, [1]),
        MessageSection("Bytes 1 to 2", 1, 3, []),
        MessageSection("Levels", 1, 3, [2, 3], open=False),
    ]
    plan = messages._plan(relations, node, stop, [], shares)
    assert plan["sections"] == [
        {"title": "Byte 0, 1 field", "keys": [1], "open": True},
        {"title": "Levels, bytes 1 to 2, 2 fields", "keys": [2, 3], "open": False},
    ]
    assert (plan["enums"], plan["drawings"]) == ({}, [])
    assert plan["wire"]["id_bytes"] == 1
    # The decoder lists the elements of arrays itself.
    assert "sections" not in messages._plan(relations, node, curves, [], shares)


PAIR = """\
messages:
  - {name: Level, id: 1, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Level, type: uint, const: 7}]}
  - {name: Set Level, id: 2, kind: telecommand, length: 1, fields: [
      {at: 0, bits: 8, name: Level, type: uint, const: 5}]}
  - {name: Empty, id: 3, kind: telemetry, length: 0}
"""


def test_telemetry_shows_an_example_and_a_telecommand_its_initial_values(
    tmp_path, monkeypatch
):
    result = loaded(tmp_path, PAIR)
    (node,) = result.icd.nodes
    relations = Relations(result.icd)
    shown = []
    monkeypatch.setattr(
        messages.wire, "buses", lambda message, wire, data: shown.append(data)
    )
    monkeypatch.setattr(messages, "snippets", lambda *arguments: [])
    values = {
        message.name: messages.values(relations, node, message, None)
        for message in node.messages
    }
    example = example_frames(node.messages[0], node)[0].frame
    assert shown == [example, b"\x05", b""] and example != b"\x07"
    assert [row["example_data"] for row in values.values()] == [True, False, False]
    level = values["Level"]
    assert level["url"] == "demo/level.html"
    assert [id.value for id in level["ids"]] == [1]
    assert (len(level["drawings"]), level["bands"]) == (1, [])
    assert len(level["shares"]) == 1 and level["contains"] == []
