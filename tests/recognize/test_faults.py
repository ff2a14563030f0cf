"""Complete reports about packets that cannot be decoded, and how much they explain."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.stream import stream_encode

from icdgen.icd.model import Icd
from icdgen.recognize import faults, framed
from icdgen.recognize.faults import FrameFault
from icdgen.recognize.reading import Endpoint, endpoint_of
from icdgen.values.errors import BadLength, NotFound
from tests.conformance.icds import icd_of as checked
from tests.conftest import ROOT
from tests.features.outputs import icd_of
from tests.recognize.test_cut_frames import BATTERY, MOTOR, POWER, SPEED

CUT = (
    "check that the capture is complete; if these are the data of a message alone, "
    "name it: `icdgen decode motor MESSAGE FRAME`"
)
WRONG = "bytes are missing, or too many"
DAMAGED = "bytes are missing, or too many, or damaged"
OTHER = "a byte of it is damaged or missing, or the packet is of another node"
LISTED = "`icdgen show motor` lists its messages"
HEADER = "a byte of the header is damaged, or bytes are missing"
SET_SPEED, POWER_2 = "`Set Speed` (telecommand 3)", "`Power` (telemetry 2)"


def endpoint(icd: Icd, name: str) -> Endpoint:
    return endpoint_of(icd, icd.node(name))


@pytest.fixture(scope="module")
def motor(tmp_path_factory) -> Endpoint:
    return endpoint(icd_of(MOTOR, tmp_path_factory.mktemp("motor")), "motor")


@pytest.fixture(scope="module")
def battery(tmp_path_factory) -> Endpoint:
    return endpoint(icd_of(BATTERY, tmp_path_factory.mktemp("battery")), "battery")


def links(name: str) -> Endpoint:
    icd = checked([ROOT / "examples" / "links" / f"{name}.yaml"])
    return endpoint_of(icd, icd.nodes[0])


def fault(
    of: Endpoint, data: str, direction: str = "telecommand", is_whole: bool = True
) -> FrameFault | None:
    return faults.fault_of(of, direction, bytes.fromhex(data), is_whole)


# The header has 16 constant bits, 100 is for a known id, 200 for a wrong checksum and
# 300 for a wrong message.
@pytest.mark.parametrize(
    ("data", "is_whole", "expected"),
    [
        ("a4", True, None),
        ("a55b03", True, None),
        (
            "a5",
            False,
            FrameFault(
                8,
                "a packet of motor is cut off: 1 byte came, its header has 4",
                CUT,
                4,
                1,
            ),
        ),
        (
            "a55a03",
            False,
            FrameFault(
                116,
                f"a packet of motor, {SET_SPEED} is cut off: 3 bytes came, its header has 4",
                CUT,
                4,
                3,
                is_of_message=True,
            ),
        ),
        (
            "a55a0902",
            False,
            FrameFault(
                16,
                "a packet of motor with the id 9 is cut off: 4 bytes came, 7 are needed",
                CUT,
                7,
                4,
            ),
        ),
        (
            "a55a03020186",
            True,
            FrameFault(
                116,
                f"a packet of motor, {SET_SPEED} is cut off: 6 bytes came, 7 are needed",
                CUT,
                7,
                6,
                is_of_message=True,
                is_certain=True,
            ),
        ),
        (
            "a55a03030186",
            True,
            FrameFault(
                116,
                f"a packet of motor, {SET_SPEED} is cut off: 6 bytes came, 8 are needed",
                CUT,
                8,
                6,
                is_of_message=True,
            ),
        ),
        (
            "a55a0307",
            True,
            FrameFault(
                116,
                f"a packet of motor, {SET_SPEED} says that it has 12 bytes; packets have up to 11",
                HEADER,
                11,
                4,
                is_of_message=True,
            ),
        ),
        (
            "a55a0907",
            True,
            FrameFault(
                16,
                "a packet of motor with the id 9 says that it has 12 bytes; packets have up to 11",
                HEADER,
                11,
                4,
            ),
        ),
        (
            "a55a030201868d",
            True,
            FrameFault(
                316,
                f"a packet of motor, {SET_SPEED} has a wrong checksum: it is 8D, expected 8C",
                OTHER,
                7,
                7,
                is_of_message=True,
                is_certain=True,
            ),
        ),
        (
            "a55a03020186",
            False,
            FrameFault(
                116,
                f"a packet of motor, {SET_SPEED} is cut off: 6 bytes came, 7 are needed",
                CUT,
                7,
                6,
                is_of_message=True,
                is_certain=True,
            ),
        ),
        (
            "a55a0301070b",
            True,
            FrameFault(
                416,
                f"a packet of motor, {SET_SPEED} has 1 byte of data, the ICD says 2",
                WRONG,
                2,
                1,
                is_of_message=True,
                is_certain=True,
            ),
        ),
        (
            "a55a03020186 8c00",
            True,
            FrameFault(
                116,
                f"a packet of motor, {SET_SPEED} has 8 bytes, its length says 7",
                DAMAGED,
                7,
                8,
                is_of_message=True,
            ),
        ),
        (
            "a55a090009",
            True,
            FrameFault(
                316,
                "a packet of motor with the id 9 and 0 bytes of data is no message: motor has no message with this id",
                LISTED,
                0,
                5,
                is_unknown=True,
            ),
        ),
        (
            "a55a020103 06",
            True,
            FrameFault(
                316,
                "a packet of motor with the id 2 and 1 byte of data is no message: "
                "motor has no telecommand with this id, but telemetry `Power`",
                LISTED,
                0,
                6,
                is_unknown=True,
            ),
        ),
    ],
)
def test_each_fault_of_a_packet_with_a_length_has_its_report(
    motor, data, is_whole, expected
):
    assert fault(motor, data, is_whole=is_whole) == expected


def test_a_fault_of_telemetry_is_about_its_messages(motor):
    result = fault(motor, POWER[:-2] + "0f", "telemetry")
    assert result.text == (
        f"a packet of motor, {POWER_2} has a wrong checksum: it is 0F, expected 0E"
    )
    unknown = fault(motor, SPEED, "telemetry").text
    assert unknown == (
        "a packet of motor with the id 3 and 2 bytes of data is no message: "
        "motor has no telemetry with this id, but telecommand `Set Speed`"
    )


def test_an_unknown_message_is_not_found_and_others_have_a_wrong_length(motor):
    unknown = fault(motor, "a55a090009").error
    assert (type(unknown), unknown.help) == (NotFound, LISTED)
    damaged = fault(motor, "a55a030201868d").error
    assert isinstance(damaged, BadLength)
    assert (damaged.expected, damaged.actual, damaged.help) == (7, 7, OTHER)


def test_a_wrong_constant_of_the_trailer_and_a_checksum_of_two_bytes(battery):
    title = "a packet of battery, `Basic` (telemetry 3)"
    assert fault(battery, "dd0300020e10ffe078", "telemetry").text == (
        f"{title} ends with 78, expected 77"
    )
    assert fault(battery, "dd0300020e10ffe177", "telemetry").text == (
        f"{title} has a wrong checksum: it is FF E1, expected FF E0"
    )


def test_bytes_begin_a_packet_by_the_constants_of_their_direction(motor, battery):
    form = motor.link.stream
    for data, expected in (
        ("", False),
        ("a5", True),
        ("a55a", True),
        ("a55b", False),
        ("5a", False),
        ("a55a99", True),
    ):
        begins = faults.begins_packet(form, "telecommand", bytes.fromhex(data))
        assert begins is expected, data
    assert faults.has_sync(form, "telecommand") and faults.has_sync(form, "telemetry")
    assert faults.has_sync(battery.link.stream, "telemetry")
    assert framed.sync_of(motor) == "A5 5A"
    assert framed.sync_of(battery) == "DD"


@pytest.mark.parametrize(
    ("name", "opening", "sync"),
    [
        ("slip", "c0", "C0"),
        ("hdlc", "7e", "7E"),
        ("tsip", "10", "10"),
        ("kiss", "c0", "C0"),
    ],
)
def test_delimiters_in_front_begin_a_packet(name, opening, sync):
    of = links(name)
    form, begin = of.link.stream, bytes.fromhex(opening)
    assert framed.sync_of(of) == sync
    for direction in framed.DIRECTIONS:
        if form.packets_of(direction):
            assert faults.has_sync(form, direction)
            assert faults.begins_packet(form, direction, begin)
            assert not faults.begins_packet(form, direction, b"\x55" + begin)
            assert not faults.begins_packet(form, direction, b"")


def test_cobs_packets_begin_without_a_delimiter():
    of = links("cobs")
    assert framed.sync_of(of) == "" or not framed.sync_of(of).startswith("00")
    assert not faults.begins_packet(of.link.stream, "telecommand", b"\0")


@pytest.mark.parametrize(
    ("name", "end"),
    [
        ("slip", "the byte C0 that ends it is missing"),
        ("hdlc", "the byte 7E that ends it is missing"),
        ("tsip", "the bytes 10 03 that end it are missing"),
    ],
)
def test_a_packet_without_its_delimiter_is_cut_off(name, end):
    of = links(name)
    reports = set()
    for direction in framed.DIRECTIONS:
        for id, variants in getattr(of.ids, direction).items():
            message = variants[0].message
            data = bytes(message.layout.longest)
            packet = stream_encode(of.link, id, data, direction)
            size = 2 if name == "tsip" else 1
            begun = faults.packet_begun(of, direction, packet[:-size])
            assert begun[1] is False
            reports.add(faults.fault_of(of, direction, *begun).text.split(", ")[-1])
    assert reports == {end}


def test_a_packet_of_the_right_length_is_whole(motor):
    speed = bytes.fromhex(SPEED)
    for data, expected in (
        (speed, (speed, True)),
        (speed + b"\1\2", (speed, True)),
        (speed[:-1], (speed[:-1], False)),
        (speed[:3], (speed[:3], False)),
    ):
        assert faults.packet_begun(motor, "telecommand", data) == expected
