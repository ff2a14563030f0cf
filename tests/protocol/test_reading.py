"""Sections of the protocol are read with their defaults; absent ones are no facts."""

from __future__ import annotations

from dataclasses import asdict
from types import SimpleNamespace

import pytest

from icdgen.protocol.reading import (
    Assumption,
    ProtocolReader,
    assumptions_of,
    by_role,
    declared_algorithm,
    declared_value,
    end,
)
from icdgen.protocol.sections import LogBit
from tests.icd.files import loaded


def message(name="M", telecommand=None, telemetry=None, length=2, **more):
    ids = tuple(id for id in (telecommand, telemetry) if id is not None)
    return SimpleNamespace(
        name=name, telecommand_id=telecommand, telemetry_id=telemetry, ids=ids,
        length=length, assumptions=(), **more,
    )  # fmt: skip


def reader(protocol, *messages, included=(), loggable=(), procedures=None):
    """Return the reader of a node with this protocol section and these messages."""
    node = SimpleNamespace(name="demo", loggable=loggable, enums=())
    icd = SimpleNamespace(
        protocol_of=lambda node: protocol,
        messages_of=lambda node: messages,
        included=lambda node: included,
        procedures_of=lambda node: procedures or {},
    )
    return ProtocolReader(icd, node)


def test_a_section_that_is_no_mapping_is_empty():
    tested = reader({"a": {"b": {"c": 1}, "d": 2}, "e": [1]})
    paths = [
        (),
        ("a", "b"),
        ("a", "d"),
        ("a", "x"),
        ("a", "d", "y"),
        ("e",),
        ("x", "y"),
    ]
    assert [tested.section(*path) for path in paths] == [
        tested.protocol, {"c": 1}, {}, {}, {}, {}, {},
    ]  # fmt: skip
    assert reader({"link": {"buses": {"can": {"x": 1}}}}).bus("can") == {"x": 1}


@pytest.mark.parametrize(
    ("link", "ids", "expected"),
    [
        ({}, (130, 144, 7), (7, 144)),
        ({}, (), (1, 0)),
        ({"ids": {"telemetry": {"first": 128}}}, (130, 144), (128, 144)),
        ({"ids": {"telemetry": {"last": 239}}}, (130, 144), (130, 239)),
        ({"ids": {"telemetry": {"first": 0, "last": 9}}}, (), (0, 9)),
        ({"framing": {}}, (130, 144), (1, 0)),
    ],
)
def test_the_range_of_telemetry_ids_is_that_of_the_messages(link, ids, expected):
    tested = reader({"link": link}, *(message(telemetry=id) for id in ids))
    result = tested.telemetry_ids()
    assert (result.first, result.last) == expected


def test_messages_of_both_directions_are_found_by_id():
    both, sent, frame = message("B", 3, 130), message("S", 0), message("F", None, 131)
    tested = reader({}, both, sent, frame)
    assert tested.telecommands == {3: both, 0: sent}
    assert tested.telemetry == {130: both, 131: frame}
    assert tested.messages == {"B": both, "S": sent, "F": frame}


@pytest.mark.parametrize(
    ("write", "address"),
    [
        ({"address_7bit": 0x20}, 0x20),
        ({"address_8bit": 0x41}, 0x20),
        ({"address_8bit": 0xFE}, 0x7F),
        ({"address_7bit": 0x20, "address_8bit": 0xFE}, 0x20),
        ({}, None),
    ],
)
def test_an_address_of_8_bits_has_the_direction_as_its_last_bit(write, address):
    tested = reader({"link": {"buses": {"i2c": {"write": write}}}})
    assert tested.i2c_address() == address


@pytest.mark.parametrize(
    ("i2c", "expected"),
    [
        ({}, True),
        ({"telemetry_request": ["repeated start"]}, True),
        ({"telemetry_request": ["stop", "repeated start"]}, True),
        ({"telemetry_request": ["stop"]}, False),
        ({"telemetry_request": []}, False),
    ],
)
def test_a_read_follows_its_write_with_a_repeated_start_unless_stated(i2c, expected):
    assert reader({"link": {"buses": {"i2c": i2c}}}).i2c_repeated_start() == expected


CAN_LINK = {
    "packets": {
        "command": {"from": "host", "type": 1},
        "part": {"from": "host", "type": 2, "segment_of": "command"},
        "frame": {"from": "device", "type": 3},
        "ack": {"from": "device", "type": 4},
        "request": {"from": "host", "type": 5},
    },
    "commands": {"ack": {"packet": "ack"}},
    "requests": {"packet": "request"},
    "buses": {
        "can": {
            "node_address": 9,
            "identifier": [
                {"name": "Type", "bits": 8, "role": "type"},
                {"name": "Own", "bits": 3},
                {"name": "From", "bits": 8, "role": "source"},
                {"name": "To", "bits": 10, "role": "destination"},
            ],
            "segments": {"data_bytes": 7, "packets_left_byte": 7},
        }
    },
}


def test_the_identifier_of_can_is_listed_from_its_highest_part():
    can = reader({"link": CAN_LINK}).can()
    assert {role: (part.bits, part.shift) for role, part in can.parts.items()} == {
        "type": (8, 21),
        "Own": (3, 18),
        "source": (8, 10),
        "destination": (10, 0),
    }
    assert (can.node_address, can.data_bytes) == (9, 8)
    assert can.types == {"telecommand": 1, "acknowledge": 4, "request": 5, "reply": 3}
    assert can.extended_types == {"telecommand": 2}
    assert (can.extended.data_bytes, can.extended.left_at) == (7, 7)


def test_can_needs_an_identifier_and_packets():
    bus = CAN_LINK["buses"]["can"]
    nameless = {key: value for key, value in bus.items() if key != "identifier"}
    assert reader({"link": {**CAN_LINK, "buses": {"can": nameless}}}).can() is None
    assert reader({"link": {**CAN_LINK, "packets": {}}}).can() is None
    assert reader({"link": {**CAN_LINK, "buses": {}}}).can() is None
    assert reader({}).can() is None


def loggable(bit, id, name=""):
    return SimpleNamespace(bit=bit, id=id, name=name)


def test_a_mask_has_the_frames_of_the_node_before_those_of_others():
    common = SimpleNamespace(
        loggable=(loggable(0, 130), loggable(1, 131)), enums=()
    )  # fmt: skip
    tested = reader(
        {"log_mask": {"bytes": 1, "frame_bytes": 6}},
        message("Short", None, 130, 4),
        message("Long", None, 131, 9),
        message("Own", None, 132, 6),
        included=(common,),
        loggable=(loggable(1, 132), loggable(5, 99, "Gone"), loggable(6, 98)),
    )
    mask = tested.mask()
    assert {bit: asdict(row) for bit, row in mask.bits.items()} == {
        bit: asdict(LogBit(bit, *row))
        for bit, row in {
            0: (130, 4, "Short"),
            1: (132, 6, "Own"),
            5: (99, 6, "Gone"),
            6: (98, 6, None),
        }.items()
    }
    assert (mask.size, mask.slot_bytes, mask.msb0, mask.fill) == (1, 6, False, 0)
    assert reader({}).mask() is None


HEADER = [{"byte": 2, "bytes": 3, "role": "mask"}, {"byte": 0, "bytes": 2, "name": "A"}]
ENTRY = [
    {"byte": 4, "bytes": 2, "role": "milliseconds"},
    {"byte": 0, "bytes": 4, "role": "seconds"},
]
LOG = {"header": HEADER, "entry": ENTRY, "frames_byte": 6}


def test_a_log_file_has_the_places_of_mask_and_time():
    tested = reader({"telemetry_log": LOG, "log_mask": {"bytes": 3}})
    assert asdict(tested.log_file()) == {
        "mask_at": 2,
        "header_bytes": 5,
        "seconds": (0, 4),
        "milliseconds": (4, 2),
        "frames_at": 6,
        "file_type": None,
    }


@pytest.mark.parametrize(
    "protocol",
    [
        {"telemetry_log": LOG},
        {"log_mask": {"bytes": 3}},
        {"telemetry_log": {**LOG, "header": HEADER[1:]}, "log_mask": {"bytes": 3}},
        {"telemetry_log": {**LOG, "entry": ENTRY[1:]}, "log_mask": {"bytes": 3}},
        {"telemetry_log": {**LOG, "entry": ENTRY[:1]}, "log_mask": {"bytes": 3}},
    ],
)
def test_a_log_file_needs_a_mask_and_both_parts_of_the_time(protocol):
    assert reader(protocol).log_file() is None


def test_an_unsolicited_log_has_the_place_of_its_mask():
    rows = [{"byte": 1, "bytes": 3, "role": "mask"}]
    log = {"id": 255, "message": rows, "frames_byte": 4}
    tested = reader({"unsolicited_log": log, "log_mask": {"bytes": 3}}).log_message()
    assert asdict(tested) == {"id": 255, "mask_at": 1, "frames_at": 4}
    assert reader({"unsolicited_log": log}).log_message() is None
    without = {"unsolicited_log": {**log, "message": []}, "log_mask": {"bytes": 3}}
    assert reader(without).log_message() is None
    assert reader({"log_mask": {"bytes": 3}}).log_message() is None


def test_parts_of_a_time_count_units_from_0_by_default():
    rows = [
        {"name": "second", "at": 0, "bits": 5, "factor": 2},
        {"name": "year", "at": 25, "bits": 7, "offset": 1980},
        {"name": "day", "at": 16, "bits": 5},
    ]
    parts = reader({"msdos_time": {"parts": rows}}).time()
    assert {name: tuple(asdict(part).values()) for name, part in parts.items()} == {
        "second": (0, 5, 2, 0),
        "year": (25, 7, 1, 1980),
        "day": (16, 5, 1, 0),
    }
    assert reader({}).time() == {}


def test_an_index_has_the_fields_that_have_a_role():
    rows = [{"byte": 1, "bytes": 4, "role": "size"}, {"byte": 0, "bytes": 1}]
    index = reader({"index_file": {"entry_bytes": 9, "entry": rows}}).index()
    assert (index.entry_bytes, index.file_type) == (9, None)
    assert {role: asdict(field) for role, field in index.fields.items()} == {
        "size": {"at": 1, "bytes": 4}
    }
    assert reader({}).index() is None


def test_rows_of_a_role_and_the_end_of_the_last():
    assert by_role(HEADER) == {"mask": HEADER[0]}
    assert (end(HEADER), end(HEADER[1:]), end(ENTRY)) == (5, 2, 6)


def test_a_report_needs_its_message():
    tested = reader({}, own := message("Own"))
    report = tested.report({"message": "Own", "fields": {"a": "B"}})
    assert (report.message, report.fields) == (own, {"a": "B"})
    assert tested.report({"message": "Own"}).fields == {}
    assert tested.report({"message": "Other"}) is None
    assert tested.report({}) is None


UNASKED = """\
protocol:
  link:
    buses:
      uart: {framing: {by: escape, escape: 0x10, start: 0x02, end: 0x03, data: 0x10}}
    packets:
      telemetry: {from: device, header: [{bits: 8, role: id}]}
      event: {from: device, header: [{bits: 8, role: constant, value: 0xF1}], messages: [Event]}
messages:
  - {name: Event, set_id: 3, get_id: 131, kind: configuration, length: 1}
  - {name: State, id: 130, kind: telemetry, length: 1}
"""


def test_unsolicited_telemetry_is_headed_by_a_constant(tmp_path):
    icd = loaded(tmp_path, UNASKED).icd
    assert ProtocolReader(icd, icd.nodes[0]).unsolicited() == {0xF1: 131}
    assert reader({}).unsolicited() == {}


def test_other_kinds_than_a_crc_have_defaults_of_its_parameters():
    algorithm = declared_algorithm("sum", {"kind": "sum", "width": 16, "init": 5})
    assert (algorithm.name, algorithm.kind, algorithm.seeds) == ("sum", "sum", {})
    assert asdict(algorithm.crc) == {
        "width": 16, "polynomial": 0, "init": 5, "reflect_in": False,
        "reflect_out": False, "xor_out": 0, "empty": None,
    }  # fmt: skip
    crc = {
        "kind": "crc", "width": 8, "polynomial": 7, "init": 1, "reflect_in": True,
        "reflect_out": True, "xor_out": 9, "empty": 4, "seeds": {"M": 3},
    }  # fmt: skip
    algorithm = declared_algorithm("c", crc)
    assert algorithm.seeds == {"M": 3}
    assert list(asdict(algorithm.crc).values()) == [8, 7, 1, True, True, 9, 4]


def test_the_reasons_of_refusals_need_a_response():
    links = {"link": {"commands": {"reasons": {"checksum": 3, "length": "Long"}}}}
    tested = reader(links)
    assert tested.reasons({}) == {}
    silent = SimpleNamespace(command=None)
    assert tested.reasons({"uart": silent}) == {}
    long = SimpleNamespace(value=7, name="Long")
    plain, named = (
        SimpleNamespace(enum=None),
        SimpleNamespace(enum=SimpleNamespace(members=(long,))),
    )
    answered = SimpleNamespace(command=SimpleNamespace(responses=(plain,)))
    assert tested.reasons({"uart": answered}) == {"checksum": 3}
    answered = SimpleNamespace(command=SimpleNamespace(responses=(plain, named)))
    assert tested.reasons({"uart": silent, "i2c": answered}) == {
        "checksum": 3, "length": 7,
    }  # fmt: skip


SECTION = {
    "a": 1,
    "assumptions": {"a": "Top.", "b": {"x": 1}},
    "link": {
        "c": [1, 2],
        "assumptions": {"c": "Inner."},
        "rows": [
            {"name": "R", "d": 4, "assumptions": {"d": "Row."}},
            {"d": 5, "assumptions": {"d": "Nameless."}},
            {"send": {"x": 1}, "get": "G", "d": 6, "assumptions": {"d": "Step."}},
            {"map": "send", "d": 7, "assumptions": {"d": "Map."}},
            3,
        ],
    },
}


def test_assumptions_have_the_path_of_their_section_and_the_value_of_their_key():
    assert list(assumptions_of(SECTION, ())) == [
        Assumption("", "a", 1, "Top."),
        Assumption("", "b", None, {"x": 1}),
        Assumption("link", "c", [1, 2], "Inner."),
        Assumption("link.R", "d", 4, "Row."),
        Assumption("link", "d", 5, "Nameless."),
        Assumption("link.G", "d", 6, "Step."),
        Assumption("link.map", "d", 7, "Map."),
    ]


def test_assumptions_of_sections_come_before_those_of_procedures_and_messages():
    reset = message("Reset", 1, acknowledge=False, expects_reset=True)
    reset.assumptions = (("acknowledge", "Why."), ("length", "Table 3."))
    other = message("Other", 2, acknowledge=True, expects_reset=False)
    other.assumptions = (("acknowledge", "Stated."), ("none", "Odd."))
    procedures = {"list": {"limits": {"time_s": 3, "assumptions": {"time_s": "Long."}}}}
    tested = reader({"x": {"y": 1, "assumptions": {"y": "Y."}}}, reset, other,
                    procedures=procedures)  # fmt: skip
    assert list(tested.assumptions()) == [
        Assumption("x", "y", 1, "Y."),
        Assumption("procedures.list.limits", "time_s", 3, "Long."),
        Assumption("message Reset", "acknowledge", "reset", "Why."),
        Assumption("message Reset", "length", 2, "Table 3."),
        Assumption("message Other", "acknowledge", True, "Stated."),
        Assumption("message Other", "none", None, "Odd."),
    ]
    assert declared_value(reset, "length") == 2
