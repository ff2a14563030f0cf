"""Candidate messages of bytes: which one is chosen, and the error without one."""

from __future__ import annotations

from dataclasses import replace

import pytest
from icdgen_runtime.wire.i2c import i2c_write

from icdgen.errors import UserError
from icdgen.icd.model import Icd
from icdgen.recognize import match
from icdgen.recognize.reading import Endpoint, FrameReading, endpoint_of
from icdgen.recognize.selection import Selection, selection_of
from icdgen.values.errors import Ambiguous, BadLength, NotFound
from tests.icd.files import loaded
from tests.limits import assert_limits

HEATER = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  link:
    buses: {i2c: {}}
    packets:
      telecommand:
        from: host
        buses: [i2c]
        trailer:
          - {bits: 8, role: checksum, checksum: crc8, covers: {from: id, to: data}, optional: true}
      telemetry:
        from: device
        buses: [i2c]
        trailer:
          - {bits: 8, role: checksum, checksum: crc8, covers: {from: id, to: data}, optional: true}
    checksums:
      crc8: {kind: crc, width: 8, polynomial: 7, init: 0, reflect_in: false, reflect_out: false, xor_out: 0}
messages:
  - {name: Power, id: 16, kind: telemetry, length: 2, fields: [{at: 0, bits: 16, name: Level, type: uint}]}
  - {name: Set Power, id: 16, kind: telecommand, length: 2, fields: [{at: 0, bits: 16, name: Level, type: uint}]}
  - {name: Limit, set_id: 21, get_id: 21, kind: configuration, length: 3, fields: [{at: 0, bits: 24, name: Limit, type: uint}]}
  - {name: Stop, id: 22, kind: telecommand, length: 0}
"""
COUNTED = """\
messages:
  - name: Levels
    id: 30
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, bits: 16, name: Levels, type: uint, count: Count, up_to: 4}
"""


def icd_of(folder, text: str) -> Icd:
    result = loaded(folder, text)
    assert result.ok, result.findings
    return result.icd


@pytest.fixture
def endpoint(tmp_path) -> Endpoint:
    icd = icd_of(tmp_path, HEATER)
    return endpoint_of(icd, icd.node("demo"))


def readings(endpoint: Endpoint, body: bytes) -> dict[str, FrameReading]:
    return {
        f"{each.what} {each.message.name}": each
        for each in match.by_id([endpoint], body)
    }


def test_an_id_has_the_candidates_of_both_directions(endpoint):
    assert [*readings(endpoint, b"\x10\1\2")] == [
        "telecommand Set Power",
        "telemetry Power",
    ]
    assert [*readings(endpoint, b"\x15\1\2\3")] == [
        "telecommand Limit",
        "telemetry Limit",
    ]
    for each in readings(endpoint, b"\x10\1\2").values():
        assert (each.id, each.data, each.checked) == (16, b"\1\2", False)
    for body in (b"", b"\x10\1", b"\x10\1\2\3\4", b"\x17\1\2"):
        assert readings(endpoint, body) == {}


def test_an_id_alone_requests_telemetry(endpoint):
    assert [*readings(endpoint, b"\x10")] == ["request Power"]
    assert [*readings(endpoint, b"\x15")] == ["request Limit"]
    assert [*readings(endpoint, b"\x16")] == ["telecommand Stop"]


def test_a_right_checksum_after_the_data_is_removed(endpoint):
    frame = i2c_write(endpoint.link, 16, b"\1\2", crc=True)
    for each in readings(endpoint, frame).values():
        assert (each.data, each.checked) == (b"\1\2", True)
        assert each.remarks == ("CRC is right",)
    assert len(readings(endpoint, frame)) == 2
    assert readings(endpoint, frame[:-1] + bytes([frame[-1] ^ 1])) == {}


def test_a_checksum_needs_exactly_its_room(endpoint):
    power = endpoint.facts.telemetry[16]
    crc = i2c_write(endpoint.link, 16, b"\1\2", crc=True)[-1:]
    assert_limits(
        lambda size: match.checksum(endpoint, 16, power, bytes(size)) is not None,
        least=3,
        most=3,
    )
    assert match.checksum(endpoint, 16, power, b"\1\2\0") == crc
    assert match.checksum(endpoint, 17, power, b"\1\2\0") != crc


def test_bytes_without_an_id_are_found_by_their_length(endpoint):
    def found(data: bytes) -> list[tuple[str, int]]:
        return [(e.message.name, e.id) for e in match.by_length([endpoint], data)]

    assert found(b"") == [("Stop", 22)]
    assert found(b"\1\2") == [("Set Power", 16), ("Power", 16)]
    assert found(b"\1\2\3") == [("Limit", 21), ("Limit", 21)]
    frame = i2c_write(endpoint.link, 16, b"\1\2", crc=True)
    assert found(frame[1:]) == [
        ("Set Power", 16),
        ("Limit", 21),
        ("Power", 16),
        ("Limit", 21),
    ]


def test_data_with_separate_ids_are_read_with_the_id_of_each_node(endpoint):
    results = match.of_ids([(endpoint, 16), (endpoint, 22)], b"\1\2")
    assert [(e.message.name, e.id) for e in results] == [
        ("Set Power", 16),
        ("Power", 16),
    ]
    assert match.of_ids([], b"\1\2") == []


def test_of_equal_readings_of_several_nodes_the_declaring_node_has_precedence(
    tmp_path,
):
    text = (
        "icdgen: 1\n"
        "node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
        "include: [part.yaml]\n"
        "messages: []\n"
        "# part.yaml\n"
        "icdgen: 1\n"
        "node: {name: part, title: Part, byte_order: little, bit_order: lsb0}\n"
        "messages:\n"
        "  - {name: Power, id: 16, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Level, type: uint}]}\n"
    )
    icd = icd_of(tmp_path, text)
    for order in (("demo", "part"), ("part", "demo")):
        endpoints = [endpoint_of(icd, icd.node(name)) for name in order]
        (reading,) = match.by_id(endpoints, b"\x10\1")
        assert (reading.endpoint.node.name, reading.is_own) == ("part", True)


def test_a_right_checksum_makes_a_reading_the_likeliest(endpoint):
    power, set_power = (
        readings(endpoint, b"\x10\1\2")[f"{what}"]
        for what in ("telemetry Power", "telecommand Set Power")
    )
    checked = replace(power, checked=True)
    chosen = match.most_likely([set_power, checked], "a frame", Selection())
    assert (chosen.message.name, chosen.remarks) == (
        "Power",
        ("it can also be `Set Power` (telecommand 16) of demo",),
    )
    with pytest.raises(Ambiguous) as error:
        match.most_likely([set_power, power], "3 bytes", Selection())
    assert str(error.value) == (
        "3 bytes can be `Set Power` (telecommand 16) of demo, "
        "or `Power` (telemetry 16) of demo"
    )
    assert error.value.help == match.HELP


def test_an_acknowledge_is_less_likely_than_another_message(endpoint):
    power = readings(endpoint, b"\x10\1\2")["telemetry Power"]
    acknowledge = replace(
        readings(endpoint, b"\x16")["telecommand Stop"], what="acknowledge"
    )
    for order in ([power, acknowledge], [acknowledge, power]):
        chosen = match.most_likely(order, "a frame", Selection())
        assert chosen.what == "telemetry"
        assert chosen.remarks == (
            "it can also be acknowledge of `Stop` (telecommand 22) of demo",
        )
    chosen = match.most_likely([acknowledge], "a frame", Selection())
    assert (chosen.what, chosen.remarks) == ("acknowledge", ())


def test_a_named_message_in_both_directions_leaves_the_direction_open(endpoint):
    icd, node = endpoint.icd, endpoint.node
    both = [*readings(endpoint, b"\x15\1\2\3").values()]
    named = selection_of(icd, node, "Limit", None)
    assert match.most_likely(both, "a frame", named).what == "configuration"
    with pytest.raises(Ambiguous):
        match.most_likely(both, "a frame", Selection())
    with pytest.raises(Ambiguous, match=r"a frame can be .*, not `Stop`$"):
        match.most_likely(both, "a frame", selection_of(icd, node, "Stop", None))
    with pytest.raises(Ambiguous):
        other = replace(both[1], data=b"\1\2\4")
        match.most_likely([both[0], other], "a frame", named)
    sent = selection_of(icd, node, "Limit", "telecommand")
    chosen = match.most_likely(both, "a frame", sent)
    assert (chosen.what, chosen.remarks) == ("telecommand", ())


@pytest.mark.parametrize(
    ("count", "ending"),
    [
        (1, ""),
        (match.MOST_LISTED - 1, ""),
        (match.MOST_LISTED, ""),
        (match.MOST_LISTED + 1, ", or one of 1 others"),
        (match.MOST_LISTED + 5, ", or one of 5 others"),
    ],
)
def test_at_most_eight_candidates_are_listed(endpoint, count, ending):
    first = readings(endpoint, b"\x10\1\2")["telemetry Power"]
    names = [f"M{number}" for number in range(count)]
    candidates = [
        replace(first, message=replace(first.message, name=name)) for name in names
    ]
    text = ", or ".join(f"`{name}` (telemetry 16) of demo" for name in names[:8])
    assert match.MOST_LISTED == 8
    assert match.titles_text(candidates) == text + ending
    assert match.titles_text([*candidates, *candidates]) == text + ending


def error_of(endpoint: Endpoint, body: bytes) -> UserError:
    return match.no_match_error([endpoint], body)


def test_an_unknown_id_and_a_wrong_length_are_reported_with_their_numbers(endpoint):
    crc = i2c_write(endpoint.link, 16, b"\1\2", crc=True)[-1:].hex().upper()
    expected = {
        b"": (
            BadLength,
            "an id of demo has 1 bytes, 0 given",
            "bytes are missing",
            (1, 0),
        ),
        b"\xff\1": (
            NotFound,
            "no message of demo has the id 255 (0xFF)",
            "`icdgen show NODE` lists what there is",
            None,
        ),
        b"\x16\1\2": (
            BadLength,
            "`Stop` (telecommand 22) has 0 bytes, 2 given after the id 22",
            "bytes are missing, or too many",
            (0, 2),
        ),
        b"\x10\1": (
            BadLength,
            "`Set Power` (telecommand 16) has 2 bytes or `Power` (telemetry 16) has 2 bytes, "
            "1 given after the id 16",
            "bytes are missing, or too many",
            (2, 1),
        ),
        b"\x10\1\2\0": (
            BadLength,
            f"`Set Power` has 2 bytes; as CRC after them {crc} would be right, not 00",
            "a byte was damaged, or there are too many",
            (2, 3),
        ),
    }
    for body, (kind, text, help, sizes) in expected.items():
        error = error_of(endpoint, body)
        assert (type(error), str(error), error.help) == (kind, text, help)
        if sizes is not None:
            assert (error.expected, error.actual) == sizes


def test_a_counter_that_does_not_match_the_length_is_named(tmp_path):
    icd = icd_of(tmp_path, COUNTED)
    endpoint = endpoint_of(icd, icd.node("demo"))
    (reading,) = match.by_id([endpoint], b"\x1e\2\0\0\0\0")
    assert reading.data == b"\2\0\0\0\0"
    assert match.by_id([endpoint], b"\x1e\2\0\0") == []
    error = error_of(endpoint, b"\x1e\2\0\0")
    assert (str(error), error.help, error.expected, error.actual) == (
        "`Levels` of 3 bytes: 5 are needed for as many elements as `Count` says",
        "bytes are missing, or too many, or damaged",
        5,
        3,
    )


def test_ids_of_several_nodes_are_listed_once(endpoint):
    twice = match.no_match_error([endpoint, endpoint], b"\xff\1")
    assert str(twice) == "no message of demo has the id 255 (0xFF)"
    assert match.nodes_of([endpoint, endpoint]) == "demo"


def test_all_items_are_read_and_only_without_a_reading_the_first_error_is_raised():
    first, second = NotFound("first"), BadLength("second", 1, 2)

    def read(item: object) -> object:
        if isinstance(item, UserError):
            raise item
        return item

    assert match.read_each([first, "a", second, "b"], read) == (
        ["a", "b"],
        [first, second],
    )
    with pytest.raises(UserError) as error:
        match.read_each([second, first], read)
    assert error.value is second


def test_remarks_of_a_stream_are_about_unused_bytes_and_errors():
    assert match.stream_remarks(0, []) == []
    assert match.stream_remarks(1, ["protocol_error", "overrun"]) == [
        "1 byte around the frame belong to none",
        "the stream has an error: protocol error",
        "the stream has an error: overrun",
    ]
