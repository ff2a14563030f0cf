"""JSON requests on parts of a link: complete responses, limits and refusals."""

from __future__ import annotations

from typing import Any

import pytest
from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire.errors import UnsupportedError

from icdgen.icd import checksum
from icdgen.runtime_objects import operations
from icdgen.runtime_objects.links import link_of_node
from icdgen.runtime_objects.operations import OPERATIONS
from icdgen.runtime_objects.refusals import Refusal
from tests.conformance.icds import icd_of
from tests.conftest import ROOT
from tests.limits import assert_limits

ICD = icd_of()
LINK = link_of_node(ICD, ICD.node("cubeacp"))
WHEEL_ICD = icd_of([ROOT / "examples" / "links" / "wheel.yaml"])
WHEEL = link_of_node(WHEEL_ICD, WHEEL_ICD.node("wheel"))
SPEED = "a55a0302000001"  # without its checksum


def wheel_packet(body: str) -> str:
    """Return a packet of length, id and data, with its checksum."""
    octets = bytes.fromhex(body)
    crc = checksum.crc(octets, 16, 0x1021, 0xFFFF, False, False, 0)
    return f"a55a{body}{crc:04x}"


def is_accepted(operation: Any, link: Any, **request: Any) -> bool:
    try:
        operation(link, request)
    except Refusal as refusal:
        assert refusal.details["error"] == "request"
        return False
    except IcdError:
        return True
    return True


def detail(operation: Any, link: Any, **request: Any) -> str:
    with pytest.raises(Refusal) as refusal:
        operation(link, request)
    return refusal.value.details["detail"]


def test_each_operation_has_the_name_of_its_function():
    names = [operation.__name__ for operation in OPERATIONS]
    assert len(names) == len(set(names)) == 21
    assert all(getattr(operations, name) in OPERATIONS for name in names)


def test_a_message_is_framed_and_found_again_in_a_stream():
    line = operations.uart_encode(LINK, {"bytes": "921f00"})
    assert line == {"bytes": "1f7f921f1f001fff"}
    assert operations.uart_decode(LINK, {"bytes": "00" + line["bytes"] + "1f"}) == {
        "frames": ["921f00"]
    }
    assert operations.uart_decode(LINK, {"bytes": "1f7f1f02"}) == {"frames": []}


def test_events_of_a_uart_have_the_kind_of_their_message():
    chunks = ["00", "1f7f92", "1fff1f7f11", "051fff1f7f11", "1f02", "1f7f92"]
    assert operations.uart_events(LINK, {"chunks": chunks}) == {
        "events": [
            {"event": "message", "kind": "reply", "bytes": "92"},
            {"event": "message", "kind": "acknowledge", "bytes": "1105"},
            {"event": "protocol_error"},
        ],
        "discarded": 6,
        "pending": 3,
    }


def test_the_limit_of_a_decoder_is_from_1_to_the_longest_message():
    assert_limits(
        lambda n: is_accepted(operations.uart_events, LINK, limit=n, chunks=[]),
        least=1,
        most=LINK.longest,
    )
    for limit, expected in ((2, "message"), (1, "overrun")):
        request = {"limit": limit, "chunks": ["1f7f11051fff"]}
        (event,) = operations.uart_events(LINK, request)["events"]
        assert event["event"] == expected


def test_a_can_message_is_split_and_joined():
    request = {
        "kind": "reply",
        "id": 146,
        "source": 1,
        "destination": 2,
        "bytes": "2efb0a000000",
    }
    (packet,) = operations.can_split(LINK, request)["packets"]
    assert packet == {"id": 0x05920102, "bytes": "2efb0a000000"}
    event = {
        "event": "message",
        "id": 146,
        "source": 1,
        "kind": "reply",
        "destination": 2,
        "bytes": "2efb0a000000",
    }
    assert operations.can_join(LINK, {"packets": [packet]}) == {"events": [event]}
    for address, events in ((2, [event]), (1, [])):
        joined = operations.can_join(LINK, {"packets": [packet], "address": address})
        assert joined == {"events": events}
    for key in ("id", "source", "destination"):
        assert_limits(
            lambda n, key=key: is_accepted(
                operations.can_split, LINK, **(request | {key: n})
            ),
            least=0,
            most=255,
        )
    assert detail(operations.can_split, LINK, **(request | {"kind": "x"})) == (
        "there is no such kind"
    )


def test_incomplete_can_messages_end_at_the_given_time():
    long = next(id for id, length in LINK.frames.items() if length > 21)
    request = {"kind": "reply", "id": long, "source": 1, "destination": 2}
    data = bytes(LINK.frames[long]).hex()
    packets = operations.can_split(LINK, request | {"bytes": data})["packets"]
    timed = [{**packet, "at": 10} for packet in packets[1:]]
    late = LINK.can.extended.packet_timeout
    incomplete = {"event": "incomplete", "id": long, "source": 1, "missing": 1}
    for end, events in ((None, []), (late + 9, []), (late + 10, [incomplete])):
        script = {"packets": timed} | ({} if end is None else {"end": end})
        assert operations.can_join(LINK, script) == {"events": events}


def test_a_can_packet_has_29_bits_and_at_most_8_bytes():
    def accepted(id: int, size: int, **more: int) -> bool:
        packet = {"id": id, "bytes": bytes(size).hex()}
        return is_accepted(operations.can_join, LINK, packets=[packet], **more)

    assert_limits(lambda id: accepted(id, 0), least=0, most=(1 << 29) - 1)
    assert_limits(lambda size: accepted(0, size), most=8)
    assert_limits(lambda n: accepted(0, 0, senders=n), least=1, most=16)
    assert_limits(lambda n: accepted(0, 0, address=n), least=0, most=255)
    assert detail(
        operations.can_join, LINK, packets=[{"id": 0, "bytes": "00" * 9}]
    ) == ("a packet has too many bytes")


def test_four_senders_are_joined_at_once_by_default():
    long = next(id for id, length in LINK.frames.items() if length > 21)
    packets = []
    for source in range(5):
        request = {"kind": "reply", "id": long, "source": source, "destination": 9}
        data = bytes(LINK.frames[long]).hex()
        packets += operations.can_split(LINK, request | {"bytes": data})["packets"][:1]
    for senders, busy in ((None, 1), (3, 2), (5, 0)):
        more = {} if senders is None else {"senders": senders}
        events = operations.can_join(LINK, {"packets": packets} | more)["events"]
        assert [event["event"] for event in events] == ["busy"] * busy


def test_a_request_on_i2c_has_the_bytes_to_write_and_to_read():
    request = {"kind": "telemetry", "id": 146}
    assert operations.i2c_request(LINK, request) == {"write": "92", "read": 6}
    assert operations.i2c_request(LINK, request | {"crc": True}) == {
        "write": "92",
        "read": 7,
    }
    sent = {"kind": "telecommand", "id": 17, "bytes": "010203040506"}
    assert operations.i2c_request(LINK, sent) == {"write": "11010203040506", "read": 0}
    checked = operations.i2c_request(LINK, sent | {"crc": True})
    assert checked["write"].startswith("11010203040506") and len(checked["write"]) == 16
    for operation in (operations.i2c_request, operations.i2c_reply):
        assert_limits(
            lambda n, operation=operation: is_accepted(
                operation, LINK, kind="telemetry", id=n, bytes="00"
            ),
            least=0,
            most=255,
        )


def test_a_reply_on_i2c_loses_its_right_checksum():
    sent = operations.i2c_request(
        LINK, {"kind": "telecommand", "id": 146, "bytes": "2efb0a000000", "crc": True}
    )["write"][2:]
    reply = {"id": 146, "bytes": sent, "crc": True}
    assert operations.i2c_reply(LINK, reply) == {"bytes": "2efb0a000000"}
    plain = {"id": 146, "bytes": "2efb0a000000"}
    assert operations.i2c_reply(LINK, plain) == {"bytes": "2efb0a000000"}


def test_a_log_is_encoded_and_decoded():
    size = LINK.mask.size
    slots = LINK.mask.selected(b"\xff" * size)
    slot = slots[0]
    mask = bytearray(size)
    mask[slot.bit // 8] |= 1 << (7 - slot.bit % 8 if LINK.mask.msb0 else slot.bit % 8)
    frame = bytes(range(1, slot.length + 1)).hex()
    entry = {"seconds": 0xFFFFFFFF, "milliseconds": 999, "frames": [frame]}
    request = {"mask": bytes(mask).hex(), "entries": [entry, entry]}
    log = operations.log_encode(LINK, request)["bytes"]
    decoded = operations.log_decode(LINK, {"bytes": log + "00"})
    row = entry | {"frames": [{"bit": slot.bit, "id": slot.id, "bytes": frame}]}
    assert decoded == {"mask": bytes(mask).hex(), "entries": [row, row], "truncated": 1}
    assert operations.log_decode(LINK, {"bytes": "00"}) == {
        "mask": None,
        "entries": [],
        "truncated": 1,
    }
    assert_limits(
        lambda n: is_accepted(
            operations.log_encode,
            LINK,
            mask=bytes(mask).hex(),
            entries=[entry | {"milliseconds": n}],
        ),
        least=0,
        most=65535,
    )
    message = {"mask": bytes(mask).hex(), "frames": [frame]}
    encoded = operations.log_message_encode(LINK, message)
    assert operations.log_message_decode(LINK, encoded) == {
        "mask": bytes(mask).hex(),
        "frames": row["frames"],
    }


def test_a_packed_time_has_its_parts_and_says_whether_it_exists():
    parts = {
        "year": 2024,
        "month": 2,
        "day": 29,
        "hour": 23,
        "minute": 59,
        "second": 58,
    }
    value = operations.dos_time(LINK, parts)["value"]
    assert value == (2024 - 1980) << 25 | 2 << 21 | 29 << 16 | 23 << 11 | 59 << 5 | 29
    assert operations.dos_time(LINK, {"value": value}) == {**parts, "valid": True}
    assert operations.dos_time(LINK, {"value": 0})["valid"] is False
    with pytest.raises(Refusal) as refusal:
        operations.dos_time(LINK, parts | {"day": 30})
    assert refusal.value.details == {"error": "range", "field": "day"}
    assert_limits(
        lambda n: "detail" not in refused_time(parts | {"year": n}), least=0, most=9999
    )


def refused_time(request: dict[str, int]) -> dict[str, Any]:
    """Return the details of the refusal; empty without one."""
    try:
        operations.dos_time(LINK, request)
    except Refusal as refusal:
        return refusal.details
    return {}


def test_entries_of_an_index_are_encoded_and_decoded():
    fields = {"type": 2, "counter": 3, "checksum": 0xABCD, "size": 70000, "time": 9}
    meta = bytes(range(LINK.index_file.fields["meta"][1])).hex()
    entry = {**fields, "meta": meta}
    file = operations.index_encode(LINK, {"entries": [entry]})["bytes"]
    assert operations.index_decode(LINK, {"bytes": file + "00"}) == {
        "entries": [entry],
        "truncated": 1,
    }


def test_a_packet_of_a_framed_link_is_encoded_in_each_direction():
    status = {"id": 0x80, "bytes": "010203", "direction": "telemetry"}
    assert operations.stream_encode(WHEEL, status) == {
        "bytes": wheel_packet("0380010203")
    }
    speed = {"id": 2, "bytes": "000001", "direction": "telecommand"}
    assert operations.stream_encode(WHEEL, speed) == {
        "bytes": wheel_packet("0302000001")
    }
    assert detail(operations.stream_encode, WHEEL, id=2, bytes="", direction="x") == (
        "there is no such direction"
    )


def test_only_fields_that_a_sender_chooses_have_values():
    text = "`values` has the fields that the sender chooses, by role"
    request = {"id": 2, "bytes": "000001", "direction": "telecommand"}
    for values in ({"length": 1}, {"source": 1, "x": 2}, [], 7, None):
        assert detail(operations.stream_encode, WHEEL, **request, values=values) == text
    assert detail(
        operations.stream_encode, WHEEL, **request, values={"source": -1}
    ) == ("`source` is missing or is no number from 0 to 4294967295")


def test_events_of_a_stream_have_what_they_report():
    packet, status = wheel_packet("0302000001"), wheel_packet("0380010203")
    request = {"direction": "telecommand", "chunks": [packet[:6], packet[6:] + "00"]}
    assert operations.stream_events(WHEEL, request) == {
        "events": [{"event": "message", "id": 2, "bytes": "000001"}],
        "discarded": 0,
        "pending": 1,
    }
    unknown = operations.stream_events(
        WHEEL, {"direction": "telecommand", "chunks": [status]}
    )
    assert unknown["events"][0]["event"] == "unknown_id"
    assert unknown["events"][0]["id"] == 0x80
    assert "bytes" not in unknown["events"][0]
    least = max(form.overhead for form in WHEEL.stream.packets)
    assert_limits(
        lambda n: is_accepted(
            operations.stream_events,
            WHEEL,
            direction="telecommand",
            chunks=[],
            limit=n,
        ),
        least=least,
        most=WHEEL.longest,
    )


@pytest.mark.parametrize(
    ("verdict", "more", "expected"),
    [
        ("ack", {}, wheel_packet("010602")),
        ("nak", {}, wheel_packet("02150200")),
        ("nak", {"reason": 3}, wheel_packet("02150203")),
        ("busy", {}, wheel_packet("011602")),
        ("progress", {}, None),
    ],
)
def test_a_device_responds_to_each_telecommand(verdict, more, expected):
    chunk = wheel_packet("0302000001")
    request = {"verdict": verdict, "bytes": "", "chunks": [chunk + "ff", chunk]} | more
    response = {"bytes": expected} if expected else {"error": "unsupported"}
    assert operations.stream_respond(WHEEL, request) == {"responses": [response] * 2}


def test_a_device_reports_a_response_with_wrong_data():
    chunk = wheel_packet("0004")
    for data, response in (
        ("0102", {"bytes": wheel_packet("02830102")}),
        ("01", {"bytes": wheel_packet("02830100")}),
        ("010203", {"error": "length"}),
    ):
        request = {"verdict": "reply", "bytes": data, "chunks": [chunk]}
        assert operations.stream_respond(WHEEL, request) == {"responses": [response]}
    request = {
        "verdict": "nak",
        "reason": 256,
        "bytes": "",
        "chunks": [wheel_packet("0302000001")],
    }
    assert operations.stream_respond(WHEEL, request) == {
        "responses": [{"error": "range"}]
    }


def test_an_operation_of_a_framed_link_needs_one():
    for operation in (
        operations.stream_encode,
        operations.stream_encode_packet,
        operations.stream_events,
        operations.stream_respond,
    ):
        with pytest.raises(UnsupportedError):
            operation(LINK, {})
