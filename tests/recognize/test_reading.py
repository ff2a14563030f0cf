"""Results of the recognition: titles, JSON, remarks, and the split of an id."""

from __future__ import annotations

import pytest

from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.recognize.reading import FrameReading, all_endpoints, endpoint_of
from icdgen.values.frame import decoded_frame

DEMO = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0{id_bits}}}
messages:
  - name: Status
    id: 5
    kind: telemetry
    length: 2
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint, const: 7}}
      - {{at: 8, bits: 8, name: Level, type: uint}}
"""


def icd_of(folder, id_bits: str = "") -> Icd:
    path = folder / "demo.yaml"
    path.write_text(DEMO.format(id_bits=id_bits))
    return load([path]).icd


@pytest.fixture
def reading(tmp_path) -> FrameReading:
    icd = icd_of(tmp_path)
    (endpoint,) = all_endpoints(icd)
    return FrameReading(endpoint, "telemetry", endpoint.node.messages[0])


@pytest.mark.parametrize(
    ("id_bits", "body", "expected"),
    [
        ("", "", None),
        ("", "00", (0, b"")),
        ("", "0506", (5, b"\6")),
        (", id_bits: 16", "05", None),
        (", id_bits: 16", "0105", (0x0105, b"")),
        (", id_bits: 16", "010203", (0x0102, b"\3")),
    ],
)
def test_an_id_has_the_size_of_its_node(tmp_path, id_bits, body, expected):
    icd = icd_of(tmp_path, id_bits)
    assert endpoint_of(icd, icd.nodes[0]).split_id(bytes.fromhex(body)) == expected


@pytest.mark.parametrize(
    ("what", "error", "title"),
    [
        ("telemetry", None, "`Status` (telemetry 5) of demo"),
        ("request", None, "request for `Status` (telemetry 5) of demo"),
        ("acknowledge", None, "acknowledge of `Status` (telemetry 5) of demo"),
        ("acknowledge", 0, "acknowledge of `Status` (telemetry 5) of demo: error 0"),
        ("refusal", 3, "refusal of `Status` (telemetry 5) of demo: error 3"),
    ],
)
def test_a_title_has_direction_message_node_and_error(reading, what, error, title):
    read = FrameReading(reading.endpoint, what, reading.message, error=error)
    assert read.title == title
    assert read.key == (what, "demo", "Status")
    assert read.is_own and not read.has_wrong_constant


def test_a_message_without_data_has_a_short_form_in_json(reading):
    short = {"node": "demo", "message": "Status", "direction": "telemetry", "id": None}
    assert reading.to_json() == short
    more = FrameReading(
        reading.endpoint,
        "acknowledge",
        reading.message,
        id=0,
        error=0,
        remarks=("a",),
        time="12.5",
    )
    assert list(more.to_json().items()) == [
        ("node", "demo"),
        ("message", "Status"),
        ("direction", "acknowledge"),
        ("id", 0),
        ("error", 0),
        ("time", "12.5"),
        ("remarks", ["a"]),
    ]


@pytest.mark.parametrize(("kind", "is_wrong"), [(7, False), (0, True)])
def test_a_frame_in_json_has_direction_time_and_remarks(reading, kind, is_wrong):
    endpoint, message = reading.endpoint, reading.message
    frame = decoded_frame(endpoint.icd, endpoint.node, message, bytes([kind, 9]))
    read = FrameReading(endpoint, "telemetry", message, frame=frame, time="1.0")
    assert read.has_wrong_constant == is_wrong
    read = read.with_remarks("one").with_remarks("two", "three")
    document = read.to_json()
    assert (document["direction"], document["time"]) == ("telemetry", "1.0")
    remarks = [*frame.remarks, "one", "two", "three"]
    assert document["remarks"] == list(read.frame.remarks) == remarks
    assert read.remarks == ("one", "two", "three")


def test_packets_that_are_left_out_are_remarks_too(reading):
    read = reading.with_left_out("a").with_left_out("b", "c")
    assert read.left_out == ("a", "b", "c")
    assert read.remarks == ("left out: a", "left out: b", "left out: c")
    assert reading.left_out == reading.remarks == ()
