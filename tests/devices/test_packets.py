"""Links with several packet formats decode recorded frames of devices and frames of
their manuals.
"""

from __future__ import annotations

import pytest
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.device import PacketData, response_to
from icdgen_runtime.wire.events import Arrived, Done, Refused, Stray
from icdgen_runtime.wire.sender import Sender
from icdgen_runtime.wire.stream import StreamDecoder, stream_encode_packet

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT

LINKS = ROOT / "examples" / "links"
JBD, TFMINI, DALY, TSIP = (
    load([LINKS / f"{name}.yaml"]).icd for name in ("jbd", "tfmini", "daly", "tsip")
)

# Frames of batteries in public logs.
RECORDED = [
    "DD 03 00 1B 17 00 00 00 02 D0 03 E8 00 00 20 78 00 00 00 00 00 00 10 48 03 0F 02 0B 76 0B 82 FB FF 77",
    "DD 03 00 1B 05 28 00 00 1B B2 2A EF 00 02 29 0A 00 00 00 00 00 00 25 41 03 04 02 0B 74 0B 6B FC 39 77",
    "DD 04 00 1E 0F 66 0F 63 0F 63 0F 64 0F 3E 0F 63 0F 37 0F 5B 0F 65 0F 3B 0F 63 0F 63 0F 3C 0F 66 0F 3D F9 F9 77",
    "DD 05 00 0A 30 31 32 33 34 35 36 37 38 39 FD E9 77",
]
BASIC, CELLS, VERSION, SWITCH_OFF = 0x03, 0x04, 0x05, 0xE1


def link_to(icd):
    (node,) = icd.nodes
    return link_of(icd, facts.of(icd, node))


def test_the_frames_of_jbd_batteries_are_received():
    decoder = StreamDecoder(link_to(JBD))
    events = [event for line in RECORDED for event in decoder.feed(bytes.fromhex(line))]
    assert [(event.event, event.id) for event in events] == [
        ("message", BASIC),
        ("message", BASIC),
        ("message", CELLS),
        ("message", VERSION),
    ]
    assert decoder.discarded == decoder.pending == 0
    (reading,) = recognize(JBD, RECORDED[1])
    values = {
        field["name"]: field.get("value", field["raw"])
        for field in reading.frame.to_json()["fields"]
    }
    assert values["Total Voltage"] == 13.2 and values["State of Charge"] == 65


def test_the_packets_of_a_gps_clock_are_received_though_doubled_bytes_precede_an_end():
    # Of a Thunderbolt, in a public mailing list.
    recorded = [
        "10 8F AB 00 03 92 88 06 F9 00 10 10 03 2C 01 11 19 03 07 DE 10 03",
        "10 8F AB 00 03 CC 16 06 F9 00 10 10 03 12 07 15 19 03 07 DE 10 03",
    ]
    for packet, time in zip(recorded, [(17, 1, 44), (21, 7, 18)], strict=True):
        (reading,) = recognize(TSIP, packet)
        values = {
            field["name"]: field.get("value", field["raw"])
            for field in reading.frame.to_json()["fields"]
        }
        assert values["UTC Offset"] == 16 and values["UTC Time"]
        assert (values["Year"], values["Month"], values["Day"]) == (2014, 3, 25)
        assert (values["Hour"], values["Minute"], values["Second"]) == time
        seconds = values["Time of Week"] - values["UTC Offset"]
        hour, minute, second = time
        assert seconds == 2 * 86400 + hour * 3600 + minute * 60 + second  # a Tuesday


def test_a_gps_clock_is_requested_and_answers_or_cannot_read_the_request():
    client = Client(link_to(TSIP))
    version, request = 0x45, bytes.fromhex("10 1F 10 03")
    client.start(0, Request("telemetry", version))
    assert client.output() == request
    (done,) = client.received(10, bytes.fromhex("10 45 030001056403 00 01 05 64 10 03"))
    assert isinstance(done, Done) and done.reply == version
    client.start(20, Request("telemetry", version))
    assert client.output() == request
    (refused,) = client.received(30, bytes.fromhex("10 13 1F 10 03"))
    assert isinstance(refused, Refused)


def test_a_jbd_battery_is_requested_and_answers_or_refuses():
    client = Client(link_to(JBD))
    client.start(0, Request("telemetry", BASIC))
    assert client.output().hex(" ") == "dd a5 03 00 ff fd 77"
    (done,) = client.received(10, bytes.fromhex(RECORDED[0]))
    assert isinstance(done, Done) and done.reply == BASIC
    client.start(20, Request("telemetry", CELLS))
    assert client.output().hex(" ") == "dd a5 04 00 ff fc 77"
    # A refusal has no data, and the id of the request.
    refusal = stream_encode_packet(client.link, 3, CELLS, "telemetry", reason=0x80)
    assert refusal.hex(" ") == "dd 04 80 00 ff 80 77"
    other = stream_encode_packet(client.link, 3, BASIC, "telemetry", reason=0x80)
    (stray,) = client.received(30, other)
    assert isinstance(stray, Stray)
    (refused,) = client.received(31, refusal)
    assert isinstance(refused, Refused) and refused.reason == "Error"


def test_only_packets_without_a_message_that_the_device_sends_are_encoded_alone():
    link, refusal = link_to(JBD), 3
    for packet in (-1, 0, 2, 99):
        with pytest.raises(RangeError, match="packet takes one of 3"):
            stream_encode_packet(link, packet, CELLS)
    with pytest.raises(RangeError):
        stream_encode_packet(link, refusal, CELLS, "telecommand")


def test_the_values_of_a_packet_take_precedence_over_those_of_its_sender():
    sender = Sender(link_to(JBD), "telemetry", {"reason": 0x81})
    assert sender.encode_packet(3, CELLS, {"reason": 0x80}).hex(" ") == (
        "dd 04 80 00 ff 80 77"
    )
    assert sender.encode_packet(3, CELLS, {}).hex(" ")[6:8] == "81"


def test_a_jbd_battery_confirms_a_telecommand_without_data():
    client = Client(link_to(JBD))
    client.start(0, Request("telecommand", SWITCH_OFF, b"\0\1"))
    assert client.output().hex(" ") == "dd 5a e1 02 00 01 ff 1c 77"
    (done,) = client.received(10, bytes.fromhex("dd e1 00 00 00 00 77"))
    assert isinstance(done, Done) and done.reply == SWITCH_OFF


def test_the_formats_of_the_tfmini_are_received_in_one_stream():
    link = link_to(TFMINI)
    client = Client(link)
    client.start(0, Request("telemetry", 0x01))
    assert client.output().hex(" ") == "5a 04 01 5f"  # of the manual
    measurement = bytes.fromhex("59 59 64 00 10 27 00 09 56")
    version = bytes.fromhex("5a 07 01 03 02 02 69")
    first, second, third = client.received(5, measurement + version + measurement)
    assert isinstance(first, Arrived) and isinstance(third, Arrived)
    assert first.data.hex() == "640010270009"
    assert isinstance(second, Done) and second.data == b"\3\2\2"
    client.start(10, Request("telecommand", 0x03, (100).to_bytes(2, "little")))
    assert client.output().hex(" ") == "5a 06 03 64 00 c7"  # of the manual
    (done,) = client.received(12, bytes.fromhex("5a 06 03 64 00 c7"))
    assert isinstance(done, Done)


def test_requests_of_a_daly_battery_have_eight_reserved_bytes():
    client = Client(link_to(DALY))
    client.start(0, Request("telemetry", 0x90))
    assert client.output().hex(" ") == "a5 40 90 08 00 00 00 00 00 00 00 00 7d"
    (done,) = client.received(
        5, bytes.fromhex("a5 01 90 08 02 14 00 00 75 2c 02 6d 64")
    )
    assert isinstance(done, Done) and done.reply == 0x90


@pytest.mark.parametrize("icd", [JBD, TFMINI, DALY], ids=["jbd", "tfmini", "daly"])
def test_the_response_of_the_device_completes_the_request(icd):
    link = link_to(icd)
    requested = [row.id for row in link.stream.telemetry if row.is_requested]
    assert requested
    for id in requested:
        for verdict, kind in (("nak", Refused), ("reply", Done)):
            client, device = Client(link), StreamDecoder(link, "telecommand")
            client.start(0, Request("telemetry", id))
            (event,) = device.feed(client.output())
            assert (event.event, event.id) == ("request", id)
            reason = 0x80 if verdict == "nak" and icd is JBD else None
            response = response_to(link, id, b"", verdict, reason, is_request=True)
            if response is None:
                assert verdict == "nak" and icd is not JBD
                continue
            sender = Sender(link, "telemetry")
            is_packet = isinstance(response, PacketData)
            encode = sender.encode_packet if is_packet else sender.encode
            (outcome,) = client.received(1, encode(*response))
            assert isinstance(outcome, kind)


def test_verification_reports_count_for_the_sequence_number_that_they_repeat():
    icd = load([ROOT / "tests" / "conformance" / "links" / "verification.yaml"]).icd
    link = link_to(icd)
    client, payload = Client(link), Sender(link, "telemetry")
    decoder = StreamDecoder(link, "telecommand")
    exposure = 0x8001
    headers = []
    for now in (0, 10):
        client.start(now, Request("telecommand", exposure, b"\0\1"))
        (sent,) = decoder.feed(client.output())
        headers.append(sent.header)
        if now == 0:
            report = response_to(link, exposure, sent.data, "ack", header=sent.header)
            (done,) = client.received(5, payload.encode(*report))
            assert isinstance(done, Done)
    first, second = headers
    assert first[2:4] == bytes([0xC0, 0]) and second[2:4] == bytes([0xC0, 1])
    repeated = response_to(link, exposure, b"\0\1", "ack", header=first)
    (stray,) = client.received(20, payload.encode(*repeated))
    assert isinstance(stray, Stray)
    refusal = response_to(link, exposure, b"\0\1", "nak", 3, header=second)
    (refused,) = client.received(30, payload.encode(*refusal))
    assert isinstance(refused, Refused) and refused.reason == "Illegal type"
