"""A truncated frame is an error. It is never decoded as another message, nor with
header bytes as values.
"""

from __future__ import annotations

import random
import sys

import pytest
from icdgen_runtime.wire.stream import stream_encode
from icdgen_runtime.wire.uart import uart_encode

from icdgen.errors import UserError
from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.runtime_objects.links import link_of
from icdgen.values.errors import Ambiguous, BadLength, NotFound
from icdgen.vectors.make import make_vectors
from tests.conftest import ROOT
from tests.features.outputs import icd_of

LINKS = sorted((ROOT / "examples" / "links").glob("*.yaml"))
DEVICES = [ROOT / "examples" / "devices" / "ublox" / "ublox.yaml"]
MOST_ROWS = 3  # golden frames of each message

MOTOR = """\
icdgen: 1
node: {name: motor, title: Motor, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: length}
    header:
      - {at: 0, bits: 16, role: sync, value: [0xA5, 0x5A]}
      - {at: 16, bits: 8, role: id}
      - {at: 24, bits: 8, role: length}
    trailer:
      - {at: 0, bits: 8, role: checksum, checksum: sum8, covers: {from: id, to: data}}
    checksums:
      sum8: {kind: sum, width: 8, init: 0, xor_out: 0}
messages:
  - name: Power
    id: 2
    kind: telemetry
    length: 6
    fields:
      - {at: 0, bits: 16, name: Voltage, type: uint, formula: raw*0.001, unit: V}
      - {at: 16, bits: 16, name: Current, type: int, formula: raw*0.001, unit: A}
      - {at: 32, bits: 16, name: Temperature, type: int, formula: raw*0.01, unit: C}
  - name: Set Speed
    id: 3
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 16, name: Speed, type: uint}
  - {name: Stop, id: 4, kind: telecommand, length: 0}
"""
SPEED, POWER = "a55a030201868c", "a55a02060001000200030e"

BATTERY = """\
icdgen: 1
node: {name: battery, title: Battery whose replies have a status, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: length}
    header:
      - {at: 0, bits: 8, role: sync, value: 0xDD}
      - {at: 8, bits: 8, role: id}
      - {at: 16, bits: 8, role: flags}
      - {at: 24, bits: 8, role: length}
    trailer:
      - {at: 0, bits: 16, role: checksum, checksum: sum16, covers: {from: flags, to: data}}
      - {at: 16, bits: 8, role: constant, value: 0x77}
    checksums:
      sum16: {kind: sum, width: 16, init: 0xFFFF, xor_out: 0xFFFF}
messages:
  - {name: Basic, id: 3, kind: telemetry, length: 2, fields: [{at: 0, bits: 16, name: Voltage, type: uint, unit: mV}]}
  - {name: Version, id: 5, kind: telemetry, length: 0, fields: [{at: 0, name: Version, type: text, size: rest, up_to: 40}]}
"""


def packets(icd: Icd) -> list[tuple[str, bytes]]:
    """Return some golden frames of each message as sent, with the name of the message."""
    named_packets = []
    for node in icd.nodes:
        node_facts = facts.of(icd, node)
        link = link_of(icd, node_facts)
        for message in make_vectors(icd, node).messages:
            for row in message.rows[:: max(1, len(message.rows) // MOST_ROWS)][
                :MOST_ROWS
            ]:
                for direction in ("telecommand", "telemetry"):
                    id = getattr(message.message, f"{direction}_id")
                    if id is None:
                        continue
                    if node_facts.stream:
                        named_packets.append(
                            (
                                message.message.name,
                                stream_encode(link, id, row.frame, direction),
                            )
                        )
                    elif node_facts.framing:
                        body = bytes([id]) + row.frame
                        named_packets.append(
                            (message.message.name, uart_encode(link, body))
                        )
    return named_packets


def names_in(icd: Icd, data: bytes, *words: str) -> list[str]:
    try:
        return [decoded.message.name for decoded in recognize(icd, data, *words)]
    except UserError:
        return []


def prefixes(packet: bytes, most: int = 60) -> list[bytes]:
    """Yield the packet cut after each byte, or after every few bytes of a long packet."""
    sizes = range(1, len(packet))
    chosen = sorted(
        {
            *sizes[:most],
            *sizes[-20:],
            *random.Random(len(packet)).sample(sizes, min(len(sizes), 20)),
        }
    )
    return [packet[:size] for size in chosen]


@pytest.fixture(scope="module", params=[*LINKS, *DEVICES], ids=lambda file: file.stem)
def link(request) -> Icd:
    loaded = load([request.param])
    assert loaded.ok
    return loaded.icd


def test_every_golden_frame_of_a_link_is_found_while_it_is_complete(link):
    for name, packet in packets(link):
        try:
            (decoded,) = recognize(link, packet)
        except Ambiguous as error:
            assert f"`{name}`" in str(error)
        else:
            assert decoded.message.name == name and not decoded.left_out


def test_no_beginning_of_a_golden_frame_of_a_link_is_decoded(link):
    decoded = [
        (name, cut.hex())
        for name, packet in packets(link)
        for cut in prefixes(packet)
        if names_in(link, cut)
    ]
    assert decoded == []


def test_no_end_of_a_golden_frame_of_a_link_is_decoded_as_another_message(link):
    source = random.Random(5)
    for name, packet in packets(link):
        for at in source.sample(range(1, len(packet)), min(12, len(packet) - 1)):
            # SLIP, HDLC and COBS need no delimiter at the start: complete packets may be
            # read.
            assert set(names_in(link, packet[at:])) <= {name}, packet[at:].hex()


def test_no_golden_frame_of_a_link_that_lacks_bytes_is_decoded_as_another_message(link):
    source = random.Random(6)
    for name, packet in packets(link):
        for _ in range(8):
            at = source.randrange(1, len(packet))
            cut = packet[:at] + packet[at + source.randint(1, 4) :]
            assert set(names_in(link, cut)) <= {name}, cut.hex()


def test_no_piece_of_a_framed_message_is_decoded(shipped):
    for _name, packet in packets(shipped)[::7]:
        for at in range(1, len(packet)):
            assert names_in(shipped, packet[:at]) == [], packet[:at].hex()
        for at in range(1, len(packet) - 2):
            assert names_in(shipped, packet[at:]) == [], packet[at:].hex()


@pytest.fixture(scope="module")
def motor(tmp_path_factory) -> Icd:
    return icd_of(MOTOR, tmp_path_factory.mktemp("motor"))


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        (
            "A5 5A 03 02 01 86",
            BadLength,
            r"`Set Speed` \(telecommand 3\) is cut off: 6 bytes came, 7 are needed",
        ),
        (
            "A5 5A 02",
            BadLength,
            r"`Power` \(telemetry 2\) is cut off: 3 bytes came, its header has 4",
        ),
        ("A5", BadLength, "a packet of motor is cut off: 1 byte came"),
        (
            POWER[:-2] + "0f",
            BadLength,
            r"`Power` \(telemetry 2\) has a wrong checksum: it is 0F, expected 0E",
        ),
        (
            "A5 5A 09 00 09",
            NotFound,
            "a packet of motor with the id 9 and 0 bytes of data is no message",
        ),
        (
            "A5 5A 03 01 07 0B",
            BadLength,
            r"`Set Speed` \(telecommand 3\) has 1 byte of data, the ICD says 2",
        ),
        ("A5 5A 03 FF", BadLength, "says that it has 260 bytes; packets have up to 11"),
        (
            "5A 03 02 01 86 8C",
            Ambiguous,
            "6 bytes are no packet of motor, which begin with A5 5A; .* can be `Power`",
        ),
        (
            "00 01 02",
            NotFound,
            "3 bytes are no packet of motor, which begin with A5 5A",
        ),
    ],
)
def test_an_incomplete_packet_is_an_error_with_the_reason(motor, text, error, says):
    with pytest.raises(error, match=says):
        recognize(motor, text)


def test_a_packet_cut_to_the_length_of_the_named_message_is_no_data_of_it(motor):
    with pytest.raises(BadLength, match="is cut off: 6 bytes came, 11 are needed"):
        recognize(motor, POWER[:12], "motor", "Power")


def test_bare_data_of_a_named_message_are_decoded_with_a_note_if_they_look_like_a_packet(
    motor,
):
    (decoded,) = recognize(motor, "A5 5A 00 02 00 03", "motor", "Power")
    assert (
        decoded.data.hex() == "a55a00020003"
        and "the data begin like a packet" in decoded.remarks[0]
    )
    (decoded,) = recognize(motor, "01 86", "motor", "Set Speed")
    assert decoded.data.hex() == "0186" and not decoded.remarks


def test_packets_of_both_directions_are_read_in_their_order(motor):
    frames = recognize(motor, SPEED + POWER + SPEED)
    assert [(frame.message.name, frame.what) for frame in frames] == [
        ("Set Speed", "telecommand"),
        ("Power", "telemetry"),
        ("Set Speed", "telecommand"),
    ]
    assert not any(frame.left_out for frame in frames)


def test_each_packet_that_cannot_be_decoded_is_reported(motor):
    (decoded,) = recognize(motor, SPEED + "a55a090009" + POWER[:-2] + "ff" + "a55a03")
    assert [
        text.partition(" is ")[0].partition(" has ")[0] for text in decoded.left_out
    ] == [
        "a packet of motor with the id 9 and 0 bytes of data",
        "a packet of motor, `Power` (telemetry 2)",
        "a packet of motor, `Set Speed` (telecommand 3)",
    ]
    assert "motor has no message with this id" in decoded.left_out[0]


def test_a_request_without_a_message_in_the_icd_is_a_packet(tmp_path):
    battery = icd_of(BATTERY, tmp_path)
    for words in ((), ("battery",)):
        with pytest.raises(
            NotFound,
            match="a packet of battery with the id 165 and 0 bytes of data is no message",
        ):
            recognize(battery, "DD A5 03 00 FF FD 77", *words)
    (reply,) = recognize(battery, "DD 03 00 02 0E 10 FF E0 77")
    assert reply.message.name == "Basic" and reply.data.hex() == "0e10"


def test_a_long_recording_with_much_damage_costs_work_that_grows_with_its_length(
    motor,
):
    def calls(count: int) -> int:
        """Return the number of function calls while a recording is read."""
        number = 0

        def profile(frame, event, argument) -> None:
            nonlocal number
            number += event.endswith("call")  # of Python and of C

        data = bytes.fromhex((SPEED + "a55a090009" + POWER[:-2] + "ff") * count)
        sys.setprofile(profile)
        try:
            frames = recognize(motor, data)
        finally:
            sys.setprofile(None)
        assert len(frames) == count and len(frames[0].left_out) == 2 * count
        return number

    calls(1)  # fill the caches of the ICD before counting
    assert calls(800) < 8.5 * calls(100)  # 64 times where it is quadratic
