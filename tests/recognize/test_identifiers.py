"""CAN identifiers are the ids of messages if a node has no section about CAN, as in
imported CAN databases.
"""

from __future__ import annotations

import pytest

from icdgen.icd.model import Icd
from icdgen.recognize import recognize
from icdgen.recognize.packets import packets
from icdgen.values.errors import Ambiguous, BadLength, NotFound
from tests.features.outputs import icd_of

TRAIN = """\
icdgen: 1
node: {name: train, title: Train, byte_order: little, bit_order: lsb0, id_bits: 29}
messages:
  - {name: Drive, id: 0x100, kind: telemetry, length: 8, fields: [{at: 0, bits: 64, name: Speed, type: uint}]}
  - {name: Brake, id: 0x101, kind: telemetry, length: 8, fields: [{at: 0, bits: 64, name: Pressure, type: uint}]}
  - {name: Cells, id: 0x18914001, kind: telemetry, length: 2, fields: [{at: 0, bits: 16, name: Cell, type: uint}]}
  - {name: Set Mode, id: 0x200, kind: telecommand, length: 1, fields: [{at: 0, bits: 8, name: Mode, type: uint}]}
  - {name: Mode, id: 0x200, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Mode, type: uint}]}
"""
DRIVE, BRAKE = "393001010a000000", "0100000000000000"


def train(folder) -> Icd:
    return icd_of(TRAIN, folder)


@pytest.fixture(scope="module")
def icd(tmp_path_factory) -> Icd:
    return train(tmp_path_factory.mktemp("train"))


@pytest.mark.parametrize(
    "text",
    [
        f"100#{DRIVE}",
        f"(1600000000.000000) can0 100#{DRIVE}",
        f"(1600000000.000000) can0 100##5{DRIVE}",
        "  can0  100   [8]  39 30 01 01 0A 00 00 00",
        f"t1008{DRIVE}",
    ],
)
@pytest.mark.parametrize("names", [(), ("train",), ("train", "Drive")])
def test_exactly_the_message_of_the_identifier_is_read(icd, text, names):
    (decoded,) = recognize(icd, text, *names)
    assert (decoded.message.name, decoded.what, decoded.id, decoded.data.hex()) == (
        "Drive",
        "telemetry",
        0x100,
        DRIVE,
    )
    assert decoded.frame.remarks == ("CAN identifier 0x100 removed",)


@pytest.mark.parametrize(
    "text", ["can0  18914001   [2]  01 F4", "18914001#01F4", "T18914001201F4"]
)
def test_identifiers_of_29_bits_are_ids_too(icd, text):
    (decoded,) = recognize(icd, text)
    assert (decoded.message.name, decoded.frame.remarks) == (
        "Cells",
        ("CAN identifier 0x18914001 removed",),
    )


def test_every_packet_of_a_log_is_a_message_and_unknown_ones_are_reported(icd):
    log = f"can0 100#{DRIVE}\ncan0 7FF#00\ncan0 101#{BRAKE}\ncan0 100#{BRAKE}"
    frames = recognize(icd, log)
    assert [(frame.message.name, frame.data.hex()) for frame in frames] == [
        ("Drive", DRIVE),
        ("Brake", BRAKE),
        ("Drive", BRAKE),
    ]
    assert frames[0].left_out == (
        "no message of train has the CAN identifier 0x7FF (1 CAN packet)",
    )
    assert [frame.message.name for frame in recognize(icd, log, "train", "Brake")] == [
        "Brake"
    ]


@pytest.mark.parametrize(
    ("text", "names", "error", "says"),
    [
        (
            f"7FF#{DRIVE}",
            (),
            NotFound,
            "no message of train has the CAN identifier 0x7FF",
        ),
        (f"00000300#{DRIVE}", (), NotFound, "CAN identifier 0x00000300"),
        ("100#3930", (), BadLength, r"`Drive` \(telemetry 256\) has 8 bytes, 2 given"),
        (f"100#{DRIVE}", ("train", "Brake"), NotFound, "is not `Brake` but `Drive`"),
        (
            "200#01",
            (),
            Ambiguous,
            "the CAN identifier 0x200 can be `Set Mode` .*, or `Mode`",
        ),
    ],
)
def test_an_identifier_of_no_message_or_of_another_is_an_error(
    icd, text, names, error, says
):
    with pytest.raises(error, match=says):
        recognize(icd, text, *names)


@pytest.mark.parametrize(
    "names",
    [("train", "Mode"), ("train", None, "telemetry"), (None, None, "telemetry")],
)
def test_where_both_directions_share_an_identifier_the_message_or_the_kind_decides(
    icd, names
):
    (decoded,) = recognize(icd, "200#01", *names)
    assert (decoded.message.name, decoded.what) == ("Mode", "telemetry")


def test_a_message_that_is_named_is_read_from_an_identifier_that_none_has(icd):
    (decoded,) = recognize(icd, f"7FF#{DRIVE}", "train", "Drive")
    assert (
        decoded.data.hex() == DRIVE
        and "no message of train has the CAN identifier 0x7FF" in decoded.frame.remarks
    )


@pytest.mark.parametrize(
    ("text", "time"),
    [
        ("100#R", ""),
        ("can0 100 [8] remote request", ""),
        ("r1008", ""),
        ("r10081234", "4.660"),
    ],
)
def test_a_remote_request_asks_for_the_telemetry_of_its_identifier(icd, text, time):
    (decoded,) = recognize(icd, text)
    assert (decoded.what, decoded.message.name, decoded.time) == (
        "request",
        "Drive",
        time,
    )


def test_only_adapters_append_a_time_to_the_data():
    assert packets("tcan0 100 [1] 2A 12 34") is None
    ((id, data, extended, time),) = packets("R0592020161234")
    assert (id, data, extended, time) == (0x05920201, b"", True, "4.660")


CANDUMP = f"(1600000000.250000) can0 100#{DRIVE}\n(1600000001.500000) can0 7FF#00\n(1600000002.000000) can0 101#{BRAKE}"


def test_times_of_candump_are_shown(icd):
    frames = recognize(icd, CANDUMP)
    assert [frame.time for frame in frames] == [
        "1600000000.250000",
        "1600000002.000000",
    ]
    assert frames[0].to_json()["time"] == "1600000000.250000"
    assert "time" not in recognize(icd, f"100#{DRIVE}")[0].to_json()


def test_times_of_slcan_are_seconds_of_the_minute(icd):
    frames = recognize(icd, f"t1008{DRIVE}1234\nt1018{BRAKE}EA5F\nt1008{DRIVE}")
    assert [frame.time for frame in frames] == ["4.660", "59.999", ""]


def test_a_message_of_several_packets_has_the_time_of_the_last(shipped):
    (message,) = [
        message
        for message in shipped.node("cubeacp").messages
        if message.telemetry_id == 0xBE
    ]
    pieces = [
        bytes(range(at, at + 7))[: message.length - at].ljust(7, b"\0")
        for at in range(0, message.length, 7)
    ]
    lines = [
        f"(10.{number}) can0 08BE0201#{piece.hex()}{len(pieces) - 1 - number:02x}"
        for number, piece in enumerate(pieces)
    ]
    (decoded,) = recognize(shipped, "\n".join(lines))
    assert (decoded.message.name, decoded.time) == (
        message.name,
        f"10.{len(pieces) - 1}",
    )


@pytest.mark.parametrize(
    ("packet", "name"),
    [
        ("100#2a", "Brake"),
        ("00000100#2a", "Cells"),
        ("00000101#2a", None),
        ("101#2a", None),
    ],
)
def test_standard_and_extended_frames_of_one_number_are_two_messages(
    packet, name, tmp_path
):
    messages = [
        f"  - {{name: {name}, id: {id}, kind: telemetry, length: 1, fields: [{{at: 0, bits: 8, name: Level, type: uint}}]}}\n"
        for name, id in (("Brake", "0x100"), ("Cells", "0x80000100"))
    ]
    node = "icdgen: 1\nnode: {name: both, title: Both, byte_order: little, bit_order: lsb0, id_bits: 32}\nmessages:\n"
    icd = icd_of(node + "".join(messages), tmp_path)
    if name is None:
        with pytest.raises(NotFound):
            recognize(icd, packet)
    else:
        assert [frame.message.name for frame in recognize(icd, packet)] == [name]
