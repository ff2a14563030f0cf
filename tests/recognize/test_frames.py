"""Frames in a text or in received bytes: the complete readings and reports."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.uart import uart_encode

from icdgen.errors import UserError
from icdgen.icd.model import Icd
from icdgen.recognize import recognize
from icdgen.runtime_objects.links import link_of_node
from icdgen.values.errors import BadLength
from tests.features.outputs import icd_of
from tests.recognize.test_cut_frames import MOTOR, POWER, SPEED
from tests.recognize.ways import DATA

FRAME = bytes([146]) + DATA
ATTITUDE = "`Estimated Attitude Angles` (telemetry 146)"
CUT, DAMAGED = (
    "the frame is cut off",
    "the frame is cut off, or a byte of it is damaged",
)


def sent(icd: Icd, *messages: bytes) -> bytes:
    link = link_of_node(icd, icd.node("cubeacp"))
    return b"".join(uart_encode(link, message) for message in messages)


def error_of(icd: Icd, *arguments: object) -> UserError:
    with pytest.raises(UserError) as error:
        recognize(icd, *arguments)
    return error.value


@pytest.fixture(scope="module")
def motor(tmp_path_factory) -> Icd:
    return icd_of(MOTOR, tmp_path_factory.mktemp("motor"))


@pytest.mark.parametrize(
    ("before", "after", "remarks", "left_out"),
    [
        (b"", b"", (), ()),
        (b"\0", b"", ("1 byte around the frame belong to none",), ()),
        (b"\0\1", b"\2\3", ("4 bytes around the frame belong to none",), ()),
        # An escape byte alone begins no message yet.
        (b"", b"\x1f", ("1 byte around the frame belong to none",), ()),
        (
            b"",
            b"\x1f\x7f",
            ("2 bytes around the frame belong to none",),
            ("the framing begins, but the end of the message is missing",),
        ),
        (
            b"\x1f\x7f\x11\x1f\x02",
            b"",
            ("5 bytes around the frame belong to none",),
            ("the stream has an error: protocol error",),
        ),
        (
            b"\x1f\x7f\x11",
            b"",
            ("3 bytes around the frame belong to none",),
            ("the stream has an error: unexpected start",),
        ),
    ],
)
def test_bytes_around_a_frame_are_reported(shipped, before, after, remarks, left_out):
    (reading,) = recognize(shipped, before + sent(shipped, FRAME) + after, "cubeacp")
    assert (reading.what, reading.id, reading.data) == ("telemetry", 146, DATA)
    assert reading.remarks == (
        "framing with id 146 removed",
        *(f"left out: {text}" for text in left_out),
        *remarks,
    )
    assert reading.left_out == left_out


def test_a_body_that_is_no_message_is_left_out(shipped):
    data = sent(shipped, bytes([99, 1]), FRAME, FRAME)
    first, second = recognize(shipped, data, "cubeacp")
    assert first.left_out == ("no message of cubeacp has the id 99 (0x63)",)
    assert second.left_out == ()
    assert second.remarks == ("framing with id 146 removed",)


@pytest.mark.parametrize(
    ("text", "says", "help", "actual"),
    [
        ("1F 7F", "the framing begins, but the end of the message is missing", DAMAGED, 2),
        ("1F 7F 1F FF", "the framing is empty", DAMAGED, 4),
        (
            "1F 7F 92 1F 02",
            "the framing is broken: the escape byte is followed by neither itself nor an end of message",
            DAMAGED,
            5,
        ),
        ("1F", "the framing begins, but the end of the message is missing", CUT, 1),
        ("00 1F FF", "the framing ends, but the start of the message is missing", CUT, 3),
    ],
)  # fmt: skip
def test_a_frame_without_its_start_or_its_end_is_an_error(
    shipped, text, says, help, actual
):
    error = error_of(shipped, text)
    assert isinstance(error, BadLength)
    assert (str(error), error.help, error.expected, error.actual) == (
        says,
        help,
        0,
        actual,
    )


def test_no_bytes_are_an_error(shipped):
    error = error_of(shipped, b"")
    assert (str(error), error.help) == ("there are no bytes", "give a frame")
    assert (error.expected, error.actual) == (1, 0)


def test_a_message_without_framing_is_found_by_its_id_or_by_its_length(tmp_path):
    text = (
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
        "messages:\n"
        "  - {name: Level, id: 5, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}\n"
        "  - {name: Rate, id: 6, kind: telemetry, length: 2, fields: [{at: 0, bits: 16, name: B, type: uint}]}\n"
    )
    icd = icd_of(text, tmp_path)
    (level,) = recognize(icd, "05 07")
    assert (level.message.name, level.id, level.data) == ("Level", 5, b"\7")
    assert level.remarks == (
        "id 5 removed",
        "without an id in front it could be `Rate` (telemetry 6) of demo",
    )
    (rate,) = recognize(icd, "07 05")
    assert (rate.message.name, rate.id, rate.data) == ("Rate", None, b"\7\5")
    assert rate.remarks == ("found by its length alone",)
    (named,) = recognize(icd, "05 07", "demo", "Rate")
    assert (named.message.name, named.remarks) == ("Rate", ())
    lines = recognize(icd, "05 01\n\n05 02\n")
    assert [each.data for each in lines] == [b"\1", b"\2"]
    assert [each.frame.rows[0].text for each in lines] == ["1", "2"]
    assert [each.id for each in recognize(icd, "07 01\n07 02")] == [None, None]
    # Without ids, two lines are rather one frame, if they can be.
    (joined,) = recognize(icd, "07\n01", "demo")
    assert (joined.message.name, joined.data) == ("Rate", b"\7\1")


def test_the_notation_is_a_remark_if_it_is_no_plain_hexadecimal(shipped):
    (reading,) = recognize(shipped, "kS77CgAAAA==", "cubeacp")
    assert reading.remarks[-1].startswith("read as ")
    (plain,) = recognize(shipped, FRAME.hex(), "cubeacp")
    assert not any(remark.startswith("read as") for remark in plain.remarks)


def test_a_frame_of_another_message_than_the_named_one_is_named(shipped):
    error = error_of(shipped, sent(shipped, bytes([17]) + bytes(6)), "cubeacp", "146")
    assert str(error).startswith("the frame is not `Estimated Attitude Angles` but `")
    assert str(error).endswith(" (telecommand 17) of cubeacp")
    assert error.help == "leave the message out, or name that one"


def test_of_a_stream_only_the_named_message_remains_with_all_reports(shipped):
    data = sent(shipped, bytes([146]), bytes([99, 1]), FRAME, bytes([17]) + bytes(6))
    readings = recognize(shipped, data, "cubeacp", "17")
    assert [(each.what, each.data) for each in readings] == [("telecommand", bytes(6))]
    assert readings[0].left_out == ("no message of cubeacp has the id 99 (0x63)",)
    assert readings[0].remarks.count("left out: no message of cubeacp has the id 99 (0x63)") == 1  # fmt: skip


def test_bytes_without_the_packet_of_their_link_are_reported_with_a_remedy(motor):
    error = error_of(motor, "00 01 02")
    assert str(error) == "3 bytes are no packet of motor, which begin with A5 5A"
    assert error.help == (
        "check that the capture is complete; name the node and the message: "
        "`icdgen decode NODE MESSAGE FRAME` reads the data of a message alone"
    )
    error = error_of(motor, "00 01")
    assert str(error) == (
        "2 bytes are no packet of motor, which begin with A5 5A; as data alone they can "
        "be `Set Speed` (telecommand 3) of motor"
    )


def test_with_the_kind_alone_bytes_without_a_packet_are_read(motor):
    (reading,) = recognize(motor, "01 86", None, None, "telecommand")
    assert (reading.message.name, reading.remarks) == (
        "Set Speed",
        ("found by its length alone",),
    )


def test_a_packet_in_front_of_noise_is_read(motor):
    (reading,) = recognize(motor, bytes.fromhex(SPEED) + b"\1\2")
    assert reading.remarks == (
        "header with id 3 removed",
        "2 bytes around the frame belong to none",
    )
    both = recognize(motor, bytes.fromhex(SPEED + POWER))
    assert [each.message.name for each in both] == ["Set Speed", "Power"]
