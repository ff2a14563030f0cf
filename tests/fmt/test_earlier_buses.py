"""``icdgen fmt`` converts acknowledges, message types and error codes of buses."""

from __future__ import annotations

from textwrap import indent

import pytest
import yaml

from icdgen.icd.fmt import format_text

ENUMS = """\
enums:
  - {name: Other, members: [{value: 0, name: Wrong}]}
  - {name: Code, members: [{value: 0, name: Fine}, {value: 1, name: Short}, {value: x, name: Odd}, {name: None}]}
messages:
  - {name: Save, id: 8}
  - {name: Level, id: 0x82}
  - {name: Setup, set_id: 5, get_id: 133}
  - {name: No Id}
"""


def text_of(link: str, rest: str = ENUMS) -> str:
    text = f"icdgen: 1\nprotocol:\n  link:\n{indent(link, '    ')}\n{rest}"
    return format_text(text, "pump.yaml")


def converted(link: str, rest: str = ENUMS) -> object:
    """Return the section `link` after the conversion."""
    return yaml.safe_load(text_of(link, rest))["protocol"]["link"]


ACKNOWLEDGE = "buses: {{uart: {{acknowledge: {{data: [{}]}}}}}}\n{}"
STATUS = "{byte: 0, bytes: 1, role: error, enum: Code}"


def test_reasons_are_commands_by_cause():
    """`none` is what a success is, and keys without a cause are dropped."""
    link = converted(
        "reasons: {unknown_id: 3, length: 1, parameter: 2, checksum: 4, busy: 9, none: 0}"
    )
    reasons = {"unknown_id": 3, "length": 1, "value": 2, "checksum": 4}
    assert link == {"commands": {"reasons": reasons}}
    assert converted("reasons: {source: {page: 1}, none: 0}") == {
        "commands": {"source": {"page": 1}}
    }


def test_reasons_without_a_cause_are_removed():
    assert converted("reasons: {none: 5}\nother: 1") == {"other": 1}


@pytest.mark.parametrize(
    ("row", "reasons", "success"),
    [
        (STATUS, {"length": "Short", "value": 2}, "Fine"),
        (STATUS.replace(", enum: Code", ""), {"length": 1, "value": 2}, 0),
    ],
)
def test_codes_are_members_if_the_field_has_their_enumeration(row, reasons, success):
    own = "reasons: {enum: Code, none: 0, length: 1, parameter: 2}"
    link = converted(ACKNOWLEDGE.format(row, own))
    assert link["commands"] == {"reasons": reasons}
    assert link["buses"]["uart"]["commands"]["ack"]["success"] == [success]


def test_without_reasons_a_telecommand_is_confirmed_by_zero():
    link = converted(ACKNOWLEDGE.format(STATUS, "other: 1"))
    assert link["buses"]["uart"]["commands"] == {
        "ack": {
            "packet": "acknowledge",
            "echo": "id",
            "status": "status",
            "success": [0],
        }
    }
    assert "commands" not in link


@pytest.mark.parametrize(
    ("rows", "header"),
    [
        (["{byte: 0, bytes: 1, role: id}"], [{"bits": 8, "role": "id"}]),
        (["{role: id}", "{role: error}"], [
            {"bits": 8, "role": "id"}, {"bits": 8, "role": "status"},
        ]),
        (["{byte: 1, bytes: 2, role: id}", "{bytes: 3}", "{byte: 6}", "{byte: 9, role: [a]}"], [
            {"at": 8, "bits": 16, "role": "id"}, {"bits": 24, "role": "flags"},
            {"bits": 8, "role": "flags"}, {"at": 72, "bits": 8, "role": "flags"},
        ]),
        (["{byte: 0, bytes: 4, format: msdos_time, type: uint, name: T, summary: S.}"], [
            {"bits": 32, "role": "time", "name": "T", "summary": "S."},
        ]),
        (["{byte: 0, role: error, format: x, name: C, enum: Code, other: 1}"], [
            {"bits": 8, "role": "status", "name": "C", "enum": "Code"},
        ]),
        (["{byte: 2}", "{byte: 0}"], [
            {"at": 16, "bits": 8, "role": "flags"}, {"at": 0, "bits": 8, "role": "flags"},
        ]),
    ],
)  # fmt: skip
def test_rows_of_an_acknowledge_are_fields_of_a_packet(rows, header):
    link = converted(ACKNOWLEDGE.format(", ".join(rows), ""))
    assert link["packets"]["acknowledge"] == {
        "from": "device",
        "buses": ["uart"],
        "header": header,
    }


def test_an_acknowledge_without_rows_is_a_packet_too():
    section = "{source: {page: 1}, required_before_next: true, assumptions: {data: A., source: B.}}"
    link = converted(f"buses: {{uart: {{acknowledge: {section}}}}}")
    assert link["packets"] == {
        "acknowledge": {
            "source": {"page": 1},
            "from": "device",
            "buses": ["uart"],
            "assumptions": {"header": "A.", "source": "B."},
        }
    }
    assert converted("buses: {uart: {acknowledge: 7}}") == {
        "buses": {"uart": {"acknowledge": 7}}
    }


def unasked(value: int, message: str) -> dict:
    return {
        "from": "device",
        "buses": ["uart"],
        "header": [{"bits": 8, "role": "constant", "value": value}],
        "messages": [message],
    }


def test_telemetry_that_is_sent_unasked_has_packets_of_its_own():
    one = "buses: {{uart: {{unsolicited: [{}], other: 1}}}}"
    link = converted(one.format("{message: Level, id_of: Save}"))
    assert link == {
        "buses": {"uart": {"other": 1}},
        "packets": {"unasked": unasked(8, "Level")},
    }
    two = "{message: Level, id_of: Save}, {message: Save, id_of: Level}"
    assert [*converted(one.format(two))["packets"]] == ["unasked 0", "unasked 1"]
    rows = f"{two}, {{message: Setup, id_of: Setup}}"
    assert converted(one.format(rows))["packets"] == {
        "unasked 0": unasked(8, "Level"),
        "unasked 1": unasked(0x82, "Save"),
        "unasked 2": unasked(5, "Setup"),
    }


@pytest.mark.parametrize(
    "row",
    ["{message: A, id_of: Missing}", "{message: A, id_of: No Id}", "{message: A}"],
)
def test_telemetry_with_the_id_of_another_file_stays(row):
    rows = f"[{{message: Level, id_of: Save}}, {row}]"
    link = converted(f"buses: {{uart: {{unsolicited: {rows}}}}}")
    assert link == {"buses": {"uart": {"unsolicited": yaml.safe_load(rows)}}}


def test_packets_join_those_of_the_link():
    rows = "unsolicited: [{message: Level, id_of: Save}], acknowledge: {data: [{role: id}]}"
    link = converted(f"packets: {{own: {{from: host}}}}\nbuses: {{uart: {{{rows}}}}}")
    assert [*link["packets"]] == ["own", "acknowledge", "unasked"]
    link = converted(f"packets: 7\nbuses: {{uart: {{{rows}}}}}")
    assert link["packets"] == 7


def test_telemetry_that_is_polled_confirms_telecommands():
    keys = "source: {page: 1}, message: M, id: A, until: B, error: C, parameter: D"
    section = f"{{{keys}, required_before_next: true, assumptions: {{id: E.}}}}"
    link = converted(
        f"reasons: {{none: 6}}\nbuses: {{i2c: {{write: 1, acknowledge: {section}}}}}"
    )
    assert link["buses"]["i2c"] == {
        "write": 1,
        "commands": {
            "ack": {
                "source": {"page": 1},
                "message": "M",
                "echo": "A",
                "until": "B",
                "status": "C",
                "detail": "D",
                "assumptions": {"id": "E."},
                "success": [6],
            }
        },
    }


TYPES = """\
buses:
  can:
    message_types:
      source: {page: 1}
      values:
        - {value: 1, name: Do, summary: S.}
        - {value: 2, name: Did}
        - {value: 3, name: Get}
        - {value: 4, name: Got}
        - {value: 5, name: Long Do}
        - {value: 6, name: Long Got}
        - {value: 7, name: Spare}
        - {value: 8, name: Not}
        - {value: 10, name: None Such}
        - {value: [9], name: Odd}
        - {name: None}
    telecommand: {request: Do, extended_request: Long Do, acknowledge: Did, failure: Not, acknowledge_bytes: 0}
    telemetry: {source: {page: 2}, request: Get, response: Got, extended_response: Long Got, failure: None Such}
    extended: {data_bytes: 7}
"""


def test_message_types_are_packets_by_their_use():
    link = converted(TYPES)
    common = {"source": {"page": 1}, "buses": ["can"]}
    assert link["packets"] == {
        "Do": {**common, "from": "host", "type": 1, "summary": "S."},
        "Did": {**common, "from": "device", "type": 2},
        "Get": {**common, "from": "host", "type": 3},
        "Got": {**common, "from": "device", "type": 4},
        "Long Do": {**common, "from": "host", "type": 5, "segment_of": "Do"},
        "Long Got": {**common, "from": "device", "type": 6, "segment_of": "Got"},
        "Spare": {**common, "from": "both", "type": 7},
        "Not": {**common, "from": "device", "type": 8},
        "None Such": {**common, "from": "device", "type": 10},
    }
    assert link["buses"]["can"] == {
        "commands": {"ack": {"packet": "Did"}, "nak": {"packet": "Not"}},
        "requests": {
            "source": {"page": 2},
            "packet": "Get",
            "nak": {"packet": "None Such"},
        },
        "segments": {"data_bytes": 7},
    }


def test_a_direction_without_responses_has_no_section():
    link = converted(
        "buses: {can: {telecommand: {request: Do}, telemetry: {response: Got}, other: 1}}"
    )
    assert link == {"buses": {"can": {"other": 1}}}


@pytest.mark.parametrize(
    ("key", "present", "value"),
    [
        ("extended", "segments", {"data_bytes": 7}),
        ("telecommand", "commands", {"ack": {"packet": "A"}}),
        ("telemetry", "requests", {"packet": "A"}),
    ],
)
def test_each_key_of_can_is_converted_alone(key, present, value):
    earlier = {
        "extended": "{data_bytes: 7}",
        "telecommand": "{acknowledge: A}",
        "telemetry": "{request: A}",
    }[key]
    link = converted(f"buses: {{can: {{{key}: {earlier}}}}}")
    assert link == {"buses": {"can": {present: value}}}


def test_comments_stay_next_to_what_they_are_about():
    link = """\
reasons:  # codes
  none: 0  # fine
  length: 1  # short
buses:
  uart:
    acknowledge:
      # rows
      data: [{byte: 0, role: id}]  # data
    unsolicited:
      # first
      - {message: Level,  # inside
         id_of: Save}  # last
  can:
    message_types:
      values:
        # above
        - {value: 1, name: Do}  # behind
    telecommand:
      acknowledge: Do  # done
"""
    text = text_of(link)
    words = ["codes", "fine", "short", "rows", "data", "first", "inside", "last", "above",
             "behind", "done"]  # fmt: skip
    assert [text.count(f"# {word}") for word in words] == [1] * len(words)
    lines = [line.strip() for line in text.splitlines()]
    assert lines[lines.index("# above") + 1].startswith("Do: ")
    assert next(line for line in lines if "# behind" in line).startswith("Do: ")
    for word in ("first", "inside", "last"):
        assert lines.index(f"# {word}") < lines.index("unasked:")


@pytest.mark.parametrize("value", ["7", "[a]", "[{packet: a}]"])
@pytest.mark.parametrize(
    "link",
    [
        "reasons: {}",
        "buses: {{uart: {{acknowledge: {}}}}}",
        "buses: {{i2c: {{acknowledge: {}}}}}",
        "buses: {{can: {{message_types: {}}}}}",
        "buses: {{can: {{telecommand: {}}}}}",
        "buses: {{can: {{telemetry: {}}}}}",
    ],
)
def test_no_value_of_another_type_is_lost(link, value):
    """The schema check reports it."""
    text = link.format(value)
    assert converted(text) == yaml.safe_load(text)
