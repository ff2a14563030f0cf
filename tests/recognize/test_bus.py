"""Packets on CAN: the messages in them, and the reason why others are left out."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.can import CanMessage, CanPacket, can_split

from icdgen.recognize import bus, recognize
from icdgen.recognize.packets import Printed
from icdgen.recognize.reading import endpoint_of
from icdgen.recognize.selection import Selection
from icdgen.runtime_objects.links import link_of_node
from icdgen.values.errors import BadLength, NotFound

HOST, NODE = 2, 1


def split(icd, kind: str, id: int, data: bytes = b"") -> list[CanPacket]:
    link = link_of_node(icd, icd.node("cubeacp"))
    source, destination = (
        (NODE, HOST)
        if kind in ("acknowledge", "refusal", "reply", "request_refusal")
        else (HOST, NODE)
    )
    return can_split(link, CanMessage(kind, id, source, destination, data))


def read(icd, packets: list[CanPacket], times: list[str] | None = None) -> list:
    printed = [
        Printed(packet.id, packet.data, True, times[n] if times else "")
        for n, packet in enumerate(packets)
    ]
    return bus.readings([endpoint_of(icd, icd.node("cubeacp"))], printed, Selection())


def long_message(icd):
    """Return telemetry that needs several packets."""
    messages = icd.messages_of(icd.node("cubeacp"))
    return next(m for m in messages if m.telemetry_id and m.length > 21)


@pytest.mark.parametrize(
    ("kind", "id", "data", "what"),
    [
        ("telecommand", 17, bytes(6), "telecommand"),
        ("acknowledge", 17, b"", "acknowledge"),
        ("refusal", 17, b"", "refusal"),
        ("request", 146, b"", "request"),
        ("reply", 146, bytes(range(6)), "telemetry"),
        ("request_refusal", 146, b"", "refusal"),
    ],
)
def test_each_kind_of_packet_is_a_reading_of_its_message(shipped, kind, id, data, what):
    (reading,) = read(shipped, split(shipped, kind, id, data))
    assert (reading.what, reading.id, reading.data) == (what, id, data)
    ends = (
        "1 to 2"
        if kind in ("acknowledge", "refusal", "reply", "request_refusal")
        else "2 to 1"
    )
    assert reading.remarks == (f"CAN, from address {ends}",)
    assert reading.left_out == ()
    ids = (reading.message.telecommand_id, reading.message.telemetry_id)
    assert id in ids


def test_packets_without_a_message_are_counted_once_each(shipped):
    known = split(shipped, "reply", 146, bytes(6))
    unknown_id = split(shipped, "request", 255)
    wrong_length = [known[0]._replace(data=bytes(5))]
    long = long_message(shipped)
    pieces = split(shipped, "reply", long.telemetry_id, bytes(range(long.length)))
    for others, count in (
        ([], 0),
        (unknown_id, 1),
        (wrong_length, 1),
        (unknown_id + wrong_length, 2),
        (pieces[1:], 1),  # incomplete
        (pieces[:1] * 2, 1),  # a packet that was captured twice begins no message
    ):
        request = split(shipped, "request", 144)
        reading, *more = read(shipped, known + others + request)
        note = f"{count} of the CAN messages are no message of the ICD, or not complete"
        assert reading.left_out == ((note,) if count else ())
        assert [(each.id, each.left_out) for each in more] == [(144, ())]


def test_the_time_of_a_message_is_that_of_its_last_packet(shipped):
    long = long_message(shipped)
    pieces = split(shipped, "reply", long.telemetry_id, bytes(range(long.length)))
    times = [str(number) for number in range(len(pieces) + 1)]
    first, second = read(shipped, pieces + split(shipped, "request", 146), times)
    assert (first.time, second.time) == (times[-2], times[-1])
    assert (first.message.name, first.data) == (long.name, bytes(range(long.length)))


def test_missing_packets_are_counted_with_the_received_ones(shipped):
    long = long_message(shipped)
    pieces = split(shipped, "reply", long.telemetry_id, bytes(range(long.length)))
    for received in (pieces[1:], pieces[:1], pieces[:1] * 3, pieces[2:]):
        with pytest.raises(BadLength) as error:
            read(shipped, received)
        count = len(dict.fromkeys(received))
        missing = len(pieces) - count
        assert str(error.value) == (
            f"{missing} of {len(pieces)} packets of the message with id {long.telemetry_id} are missing"
        )
        assert (error.value.expected, error.value.actual) == (len(pieces), count)
        assert error.value.help == "give all packets of the message"


def test_an_error_names_the_first_packet_or_the_message_with_another_length(shipped):
    (packet,) = split(shipped, "reply", 146, bytes(6))
    with pytest.raises(BadLength) as error:
        read(shipped, [packet._replace(data=bytes(5))])
    assert str(error.value) == (
        "`Estimated Attitude Angles` (telemetry 146) has 6 bytes, 5 given after the id 146"
    )
    unknown_type = CanPacket(0x1F920201, b"\0")
    too_long = packet._replace(data=bytes(9))
    for packets, text in (
        ([unknown_type], "0x1F920201 is none of cubeacp: unknown type"),
        ([too_long, unknown_type], f"0x{packet.id:08X} is none of cubeacp: malformed"),
    ):
        with pytest.raises(NotFound) as error:
            read(shipped, packets)
        assert str(error.value) == f"the packet with identifier {text}"
        assert error.value.help == "see the `can` section of its ICD"


def test_an_identifier_of_11_bits_is_refused(shipped):
    with pytest.raises(NotFound) as error:
        recognize(shipped, "can0 05920201 [1] 00\ncan0 123 [1] 00")
    assert str(error.value) == (
        "a packet has an 11-bit identifier, but the identifiers of the ICD have 29 bits"
    )
    assert error.value.help == "candump prints them with 8 digits"
