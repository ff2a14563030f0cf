"""``icdgen fmt`` converts ICDs of earlier versions to the current one."""

from __future__ import annotations

import pytest
import yaml

from icdgen.icd.fmt import format_text
from icdgen.loading import load
from tests.conftest import ROOT

EARLIER = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: big, bit_order: msb0}
protocol:
  # once more after a time-out
  client: {retries: 1}  # as the manual says
  uart: {baud_rate: 9600}
  stream:
    delimited_by: none  # one datagram each
    header: [{bits: 8, role: id}]
    packets:
      out:
        from: host
        trailer:
          - {bits: 8, role: checksum, checksum: parity}
      in:
        from: device
        trailer:
          - {bits: 8, role: checksum, checksum: parity, covers: {from: data, to: data}}
  checksums:
    parity: {kind: xor, width: 8, covers: {from: id, to: data}}
messages:
  - {name: Save, id: 8, kind: telecommand, length: 0}
"""


def test_the_link_is_one_section(tmp_path):
    text = format_text(EARLIER, "pump.yaml")
    assert yaml.safe_load(text)["protocol"] == {
        "link": {
            "framing": {"by": "datagram"},
            "line": {"baud_rate": 9600},
            "header": [{"bits": 8, "role": "id"}],
            "packets": {
                "out": {"from": "host", "trailer": [trailer(first="id")]},
                "in": {"from": "device", "trailer": [trailer(first="data")]},
            },
            "checksums": {"parity": {"kind": "xor", "width": 8}},
            "client": {"retries": 1},
        }
    }
    assert [text.count(word) for word in ("# once", "# as the", "# one datagram")] == [
        1,
        1,
        1,
    ]
    (tmp_path / "pump.yaml").write_text(text, encoding="utf-8")
    assert load([tmp_path / "pump.yaml"]).findings == []


def trailer(first):
    covers = {"from": first, "to": "data"}
    return {"bits": 8, "role": "checksum", "checksum": "parity", "covers": covers}


def test_times_of_a_client_alone_are_moved_too():
    text = EARLIER[: EARLIER.index("  uart")] + EARLIER[EARLIER.index("messages") :]
    converted = yaml.safe_load(format_text(text, "pump.yaml"))
    assert converted["protocol"] == {"link": {"client": {"retries": 1}}}


BUSES = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: big, bit_order: msb0}
protocol:
  # by the first bit
  message_id:
    source: {table: 2}
    direction_bit: 7
    telecommand: {direction: 0, first: 0, last: 127}
    telemetry: {direction: 1, first: 128, last: 255}
  uart:
    source: {table: 3}  # of the manual
    baud_rate: 9600
    parity: none
    framing: {escape: 16, start_of_message: 2, end_of_message: 3, escaped_data: 16, assumptions: {escaped_data: Not given.}}
    assumptions:
      # measured
      parity: Not given.
  i2c: {write: {address_7bit: 0x57}}
  client: {retries: 1}
messages:
  - {name: Save, id: 8, kind: telecommand, length: 0}
"""


def test_buses_are_in_the_link_with_the_keys_of_framed_links(tmp_path):
    text = format_text(BUSES, "pump.yaml")
    link = yaml.safe_load(text)["protocol"]["link"]
    assert yaml.safe_load(text)["protocol"].keys() == {"link"}
    assert link.keys() == {"ids", "client", "buses"}
    assert link["ids"]["source"] == {"table": 2}
    assert link["buses"] == {
        "uart": {
            "source": {"table": 3},
            "line": {
                "baud_rate": 9600,
                "parity": "none",
                "assumptions": {"parity": "Not given."},
            },
            "framing": {
                "by": "escape",
                "escape": 16,
                "start": 2,
                "end": 3,
                "data": 16,
                "assumptions": {"data": "Not given."},
            },
        },
        "i2c": {"write": {"address_7bit": 0x57}},
    }
    comments = "# by the first bit", "# of the manual", "# measured"
    assert [text.count(comment) for comment in comments] == [1, 1, 1]
    (tmp_path / "pump.yaml").write_text(text, encoding="utf-8")
    assert load([tmp_path / "pump.yaml"]).findings == []


CHECKSUMS = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: big, bit_order: msb0}
protocol:
  link: {buses: {uart: {line: {baud_rate: 9600}}, i2c: {write: {address_7bit: 0x57}}}}
  # of section 5.5
  crc8:
    source: {section: "5.5"}
    width: 8
    polynomial: 0x07
    init: 0
    reflect_in: false
    reflect_out: false
    xor_out: 0
    covers: [parameters, frame]
    telecommand: {optional: true, extra_bytes: 1, failure_enum: Code, failure: 4}
    telemetry: {optional: false, buses: [uart]}
    covers_id: true
    assumptions: {covers_id: Not said., telecommand: Of all buses., init: Not given.}
  crc16: {width: 16, polynomial: 0x1021, init: 0, reflect_in: false, reflect_out: false, xor_out: 0, covers: [block, file]}
messages:
  - {name: Save, id: 8, kind: telecommand, length: 0}
"""


def test_checksums_are_in_the_link_and_packets_name_them():
    text = format_text(CHECKSUMS, "pump.yaml")
    protocol = yaml.safe_load(text)["protocol"]
    assert protocol.keys() == {"link"}
    crc8, crc16 = (protocol["link"]["checksums"][name] for name in ("crc8", "crc16"))
    assert crc8 == {
        "source": {"section": "5.5"}, "kind": "crc", "width": 8, "polynomial": 7, "init": 0,
        "reflect_in": False, "reflect_out": False, "xor_out": 0, "assumptions": {"init": "Not given."},
    }  # fmt: skip
    assert (crc16["kind"], crc16["summary"]) == ("crc", "Covers block, file.")
    trailer = {
        "bits": 8,
        "role": "checksum",
        "checksum": "crc8",
        "covers": {"from": "id", "to": "data"},
    }
    assert protocol["link"]["packets"] == {
        "telecommand": {
            "from": "host",
            "trailer": [{**trailer, "optional": True}],
            "assumptions": {"trailer": "Not said.", "buses": "Of all buses."},
        },
        "telemetry": {"from": "device", "buses": ["uart"], "trailer": [trailer]},
    }
    assert text.count("# of section 5.5") == 1


ERRATA = """\
errata: 1
node: pump
notes:
  - id: PUMP-001
    title: Markers
    where: {section: protocol.uart.framing}
    printed: {escaped_data: 31}
    what: W.
  - id: PUMP-002
    title: Places
    where: [{section: protocol.uart.parity}, {section: protocol.can.identifier.0}, {section: protocol.message_id}]
    what: W.
  - {id: PUMP-003, title: Other, where: {section: protocol.canning}, what: W.}
"""


RESPONSES = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: big, bit_order: msb0}
protocol:
  link:
    # by the status
    reasons: {source: {table: 4}, enum: Code, none: 0, length: 1, parameter: 2}  # of all buses
    buses:
      uart:
        framing: {by: escape, escape: 16, start: 2, end: 3, data: 16}
        acknowledge:
          source: {table: 5}
          required_before_next: true  # the buffer holds one
          data:
            - {byte: 0, bytes: 1, name: Number, role: id, type: uint}
            - {byte: 2, bytes: 1, name: Status, role: error, type: enum, enum: Code}
            - {byte: 3, bytes: 4, name: Since, type: uint, format: msdos_time}
          assumptions: {data: Not given.}
        unsolicited:
          - {message: Level, id_of: Save}  # in a stream
      i2c:
        write: {address_7bit: 0x57}
        acknowledge: {required_before_next: true, message: Outcome, id: Last, until: Done, error: Code, parameter: Index}
      can:
        identifier:
          - {name: Type, role: type, bits: 5}
          - {name: Channel, role: channel, bits: 8}
          - {name: From, role: source, bits: 8}
          - {name: To, role: destination, bits: 8}
        message_types:
          source: {table: 7}
          values:
            - {value: 1, name: Command, summary: A telecommand.}  # short
            - {value: 2, name: Accepted}
            - {value: 3, name: Failed}
            - {value: 4, name: Request}
            - {value: 5, name: Frame}
            - {value: 6, name: Unknown}
            - {value: 7, name: Long Command}
            - {value: 8, name: Long Frame}
        telecommand:
          {request: Command, extended_request: Long Command, acknowledge: Accepted, failure: Failed, acknowledge_bytes: 0}
        telemetry:
          source: {table: 8}
          request: Request
          request_bytes: 0
          response: Frame
          extended_response: Long Frame
          failure: Unknown
        extended: {data_bytes: 7, packets_left_byte: 7}
enums:
  - {name: Code, members: [{value: 0, name: None}, {value: 1, name: Length}]}
messages:
  - {name: Save, id: 8, kind: telecommand, length: 0}
  - {name: Level, id: 130, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Level, type: uint}]}
  - name: Outcome
    id: 131
    kind: telemetry
    length: 4
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 8, bits: 8, name: Done, type: uint}
      - {at: 16, bits: 8, name: Code, type: uint}
      - {at: 24, bits: 8, name: Index, type: uint}
"""


def test_responses_on_buses_are_packets_and_commands(tmp_path):
    text = format_text(RESPONSES, "pump.yaml")
    link = yaml.safe_load(text)["protocol"]["link"]
    assert link["commands"] == {
        "source": {"table": 4},
        "reasons": {"length": "Length", "value": 2},
    }
    packets = link["packets"]
    assert packets["acknowledge"] == {
        "source": {"table": 5},
        "from": "device",
        "buses": ["uart"],
        "header": [
            {"bits": 8, "role": "id", "name": "Number"},
            {"at": 16, "bits": 8, "role": "status", "name": "Status", "enum": "Code"},
            {"bits": 32, "role": "time", "name": "Since"},
        ],
        "assumptions": {"header": "Not given."},
    }
    constant = {"bits": 8, "role": "constant", "value": 8}
    assert packets["unasked"]["header"] == [constant]
    assert packets["unasked"]["messages"] == ["Level"]
    assert packets["Long Frame"] == {
        "source": {"table": 7},
        "from": "device",
        "buses": ["can"],
        "type": 8,
        "segment_of": "Frame",
    }
    uart, i2c, can = (link["buses"][bus] for bus in ("uart", "i2c", "can"))
    assert uart["commands"]["ack"] == {
        "packet": "acknowledge",
        "echo": "id",
        "status": "status",
        "success": ["None"],
    }
    assert i2c["commands"]["ack"] == {
        "message": "Outcome",
        "echo": "Last",
        "until": "Done",
        "status": "Code",
        "success": [0],
        "detail": "Index",
    }
    assert can["commands"] == {
        "ack": {"packet": "Accepted"},
        "nak": {"packet": "Failed"},
    }
    assert can["requests"] == {
        "source": {"table": 8},
        "packet": "Request",
        "nak": {"packet": "Unknown"},
    }
    assert can["segments"] == {"data_bytes": 7, "packets_left_byte": 7}
    words = ("by the status", "of all buses", "the buffer holds one", "in a stream")
    assert [text.count(f"# {comment}") for comment in (*words, "short")] == [1] * 5
    (tmp_path / "pump.yaml").write_text(text, encoding="utf-8")
    assert load([tmp_path / "pump.yaml"]).findings == []


def test_errata_name_the_present_places():
    marked, moved, other = yaml.safe_load(format_text(ERRATA, "pump.yaml"))["notes"]
    assert marked["where"] == {"section": "protocol.link.buses.uart.framing"}
    assert marked["printed"] == {"data": 31}
    assert [place["section"] for place in moved["where"]] == [
        "protocol.link.buses.uart.line.parity",
        "protocol.link.buses.can.identifier.0",
        "protocol.link.ids",
    ]
    assert other["where"] == {"section": "protocol.canning"}


@pytest.mark.parametrize(
    "text",
    [
        EARLIER,
        BUSES,
        CHECKSUMS,
        RESPONSES,
        ERRATA,
        "icdgen: 1\nprotocol: {client: {}}\n",
    ],
)
def test_a_second_conversion_changes_nothing(text):
    once = format_text(text, "pump.yaml")
    assert format_text(once, "pump.yaml") == once


@pytest.mark.parametrize(
    "path", sorted((ROOT / "icd").glob("*.yaml")), ids=lambda path: path.name
)
def test_current_icds_stay_unchanged(path):
    text = path.read_text(encoding="utf-8")
    assert format_text(text, path.name) == text
