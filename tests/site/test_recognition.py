"""Data by which pages recognize a frame: messages, ids, and lengths."""

from __future__ import annotations

import json

from icdgen.backends.html import recognition
from icdgen.backends.html.relations import Relations
from icdgen.loading import load
from tests.conformance.icds import LINKS
from tests.icd.files import loaded, status

ICD = """\
messages:
  - {name: Stop, id: 0, kind: telecommand, length: 2, fields: [
      {at: 0, bits: 8, name: Kind, type: uint, const: 1}]}
  - {name: Go, id: 0, kind: telecommand, length: 2, fields: [
      {at: 4, bits: 4, name: Kind, type: uint, const: 2}]}
  - {name: Limits, set_id: 255, get_id: 0, kind: configuration, length: 3, may_end_early: zeros, fields: [
      {at: 0, bits: 8, name: Limit, type: uint}]}
  - {name: Levels, id: 3, kind: telemetry, length: 2, fields: [
      {at: 4, bits: 8, name: Last, type: uint},
      {at: 16, bits: 16, name: Levels, type: uint, count: {field: Last, plus: -4}, up_to: 3}]}
  - {name: Rest, id: 4, kind: telemetry, length: 0, fields: [
      {at: 0, bits: 8, name: Rest, type: uint, count: rest, up_to: 3}]}
"""


def test_the_index_lists_messages_with_their_lengths(tmp_path):
    relations = Relations(loaded(tmp_path, ICD).icd)
    index = recognition.frame_index(relations)
    assert index["messages"] == [
        ["Stop", "demo/stop.html", 2, "demo"],
        ["Go", "demo/go.html", 2, "demo"],
        [
            "Limits",
            "demo/limits.html",
            3,
            "demo",
            {"least": 1, "step": 1, "pieces": []},
        ],
        [
            "Levels",
            "demo/levels.html",
            8,
            "demo",
            {"least": 2, "step": 2, "pieces": [[0, 4, 4, 0], [1, 0, 4, 4]], "low": 4},
        ],
        ["Rest", "demo/rest.html", 3, "demo", {"least": 0, "step": 1, "pieces": []}],
    ]


def test_a_shared_id_lists_the_constants_of_its_messages(tmp_path):
    relations = Relations(loaded(tmp_path, ICD).icd)
    (speaker,) = recognition.frame_index(relations)["speakers"]
    assert speaker["telecommands"] == {
        "0": [(0, ((0, 255, 1),)), (1, ((0, 240, 32),))],
        "255": 2,
    }
    assert speaker["telemetry"] == {"0": 2, "3": 3, "4": 4}
    assert (speaker["node"], speaker["title"]) == ("demo", "Demo")
    assert (speaker["id_bytes"], speaker["id_bits"]) == (1, 8)
    assert not speaker.keys() & {"stream", "protocol", "crc", "can", "acknowledge"}


def test_the_script_defines_the_index(tmp_path):
    relations = Relations(loaded(tmp_path, ICD).icd)
    first, second, end = recognition.script(relations).split("\n")
    assert (first, end) == ('"use strict";', "")
    text = second.removeprefix("globalThis.icdgenFrameIndex = ").removesuffix(";")
    index = recognition.frame_index(relations)
    assert text == json.dumps(index, separators=(",", ":"))


def test_a_node_with_buses_has_its_acknowledge_and_identifier():
    relations = Relations(load([LINKS / "battery.yaml"]).icd)
    (speaker,) = recognition.frame_index(relations)["speakers"]
    assert speaker["framing"] == [0x1F, 0x7F, 0xFF, 0x1F]
    assert speaker["acknowledge"] == [
        2,
        0,
        1,
        {0: "None", 1: "Unknown Id", 2: "Length", 3: "Parameter", 4: "Checksum"},
    ]
    assert speaker["crc"]["bytes"] == 2 and speaker["crc"]["covers_id"]
    assert "stream" not in speaker


def test_a_node_with_packets_links_to_its_protocol():
    relations = Relations(load([LINKS / "formats.yaml"]).icd)
    (speaker,) = recognition.frame_index(relations)["speakers"]
    assert speaker["protocol"] == "formats/protocol.html"
    assert not speaker.keys() & {"crc", "can", "acknowledge"}


def test_counters_in_elements_are_left_to_the_decoder(tmp_path):
    fields = (
        "at: 0, bits: 8, name: Number, type: uint",
        "at: 8, bits: 8, name: Samples, type: uint, count: Number, up_to: 5",
        "at: 8, after: Samples, bits: 8, name: Sum, type: uint",
    )
    relations = Relations(loaded(tmp_path, status(*fields, length=1)).icd)
    (message,) = recognition.frame_index(relations)["messages"]
    assert message[4:] == [{"least": 2, "step": 1, "pieces": []}]
