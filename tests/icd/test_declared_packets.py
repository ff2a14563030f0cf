"""Packet formats of a link as the ICD declares them."""

from __future__ import annotations

import random

import pytest

from icdgen.icd.layout import Layout
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Message
from icdgen.icd.packets import (
    Packets,
    declared_packets,
    id_shifts,
    is_requested,
    place_fields,
    value_of,
)

ID = {"bits": 8, "role": "id"}
FLAGS = {"bits": 4, "role": "flags", "name": "Mode"}
CRC = {"bits": 8, "role": "checksum"}


def message(name: str, kind: str = TELECOMMAND, id: int = 1, **keys) -> Message:
    return Message(name, kind, Layout(name, 0, ()), id=id, **keys)


def names(packets) -> list[str]:
    return [packet.name for packet in packets]


def test_a_link_without_packets_is_a_packet_for_both_directions():
    packets = declared_packets({"header": [ID, "x"], "trailer": [CRC]})
    (packet,) = packets.all
    assert (packet.name, packet.header, packet.trailer) == ("", [ID], [CRC])
    assert packet.rows == [ID, CRC]
    assert packet.directions == (TELECOMMAND, TELEMETRY)
    assert (packet.messages, packet.segment_of, packet.reserved) == (None, None, 0)
    empty = declared_packets({"packets": 7})
    assert (empty.all[0].header, empty.all[0].trailer) == ([], [])
    assert (empty.responding, empty.requesting, empty.answering) == (
        frozenset(),
        None,
        None,
    )


@pytest.mark.parametrize(
    ("sender", "directions"),
    [
        ("host", (TELECOMMAND,)),
        ("device", (TELEMETRY,)),
        ("both", (TELECOMMAND, TELEMETRY)),
        ("other", ()),
        (["host"], ()),
    ],
)
def test_the_sender_of_a_packet_gives_its_directions(sender, directions):
    (packet,) = declared_packets({"packets": {"one": {"from": sender}}}).all
    assert packet.directions == directions


def test_packets_have_the_header_and_trailer_of_the_link_or_their_own():
    link = {
        "header": [ID],
        "trailer": [CRC],
        "packets": {
            "same": {"reserved": 3, "segment_of": "own", "messages": ["A", "B"]},
            "own": {"header": [FLAGS, ID], "messages": "A"},
            "bare": {"header": [], "trailer": []},
            "broken": 7,
        },
    }
    packets = declared_packets(link)
    assert names(packets.all) == ["same", "own", "bare"]
    assert [packet.rows for packet in packets.all] == [[ID, CRC], [FLAGS, ID, CRC], []]
    same, own, bare = packets.all
    assert (same.reserved, same.segment_of, same.messages) == (3, "own", ["A", "B"])
    assert (own.reserved, own.segment_of, own.messages) == (0, None, None)
    assert own.fields_of_role("id") == [ID] and own.fields_of_role("checksum") == [CRC]
    assert (own.named("Mode"), own.named("flags"), own.named("id")) == (
        FLAGS,
        FLAGS,
        ID,
    )
    assert own.named("other") is None and bare.named("id") is None
    assert [packets.number_of(name) for name in ("same", "bare", "broken", 7)] == [
        0,
        2,
        None,
        None,
    ]
    assert packets.by_name("own") is own and packets.by_name(None) is None


LINK = {
    "packets": {
        "command": {"from": "host"},
        "request": {"from": "host", "reserved": 1},
        "part": {"from": "host", "segment_of": "command"},
        "listed": {"from": "host", "messages": ["Save"]},
        "frame": {"from": "device"},
        "log": {"from": "device", "messages": ["Log"]},
        "ack": {"from": "device", "reserved": 2},
        "nak": {"from": "device"},
    },
    "requests": {"packet": "request", "reserved": 4, "response": "frame", "nak": {"packet": "nak"}},
    "commands": {"ack": {"packet": "ack"}, "reply": {"packet": "log"}, "busy": {"packet": "command"}},
}  # fmt: skip


def test_packets_carry_messages_unless_they_respond_request_or_are_parts():
    """A packet with a list of messages does not only respond."""
    packets = declared_packets(LINK)
    assert packets.responding == {"ack", "nak"}
    assert (packets.requesting, packets.answering) == ("request", "frame")
    assert names(packets.carrying(TELECOMMAND)) == ["command", "listed"]
    assert names(packets.carrying(TELEMETRY)) == ["frame", "log"]
    sent_in = packets.packets_of_message
    assert names(sent_in("Save", TELECOMMAND)) == ["listed"]
    assert names(sent_in("Other", TELECOMMAND)) == ["command"]
    assert names(sent_in("Log", TELEMETRY)) == ["log"]
    assert names(sent_in("Save", TELEMETRY)) == ["frame"]


def test_a_request_has_the_reserved_bytes_of_requests():
    packets = declared_packets(LINK)
    reserved = [packets.reserved_in(packet) for packet in packets.all]
    assert reserved == [0, 4, 0, 0, 0, 0, 2, 0]


def requests(packets: dict, **keys) -> Packets:
    return declared_packets({"packets": packets, "requests": keys})


def test_the_only_packet_of_the_host_requests_telemetry():
    host, device = {"from": "host"}, {"from": "device"}
    assert requests({"a": host, "b": device}).requesting == "a"
    assert requests({"a": host, "b": {"from": "both"}}).requesting is None
    assert requests({"a": device, "b": {"from": "both"}}).requesting == "b"
    assert requests({"a": device}).requesting is None
    assert requests({"a": host, "b": host}, packet="b").requesting == "b"
    assert requests({"a": host}, packet=7).requesting is None
    assert requests({"a": host, "b": device}).requested_bytes == 0
    both = {"a": host, "b": device}
    answers = [requests(both, response=name).answering for name in ("a", "b", "c")]
    assert answers == [None, "b", None]


def test_telecommands_share_the_only_packet_of_the_host_with_requests():
    host, device = {"from": "host"}, {"from": "device"}
    for packets, expected in (
        ({"a": host, "b": device}, False),
        ({"a": host, "b": {"from": "both"}}, True),
        ({"a": host, "b": host}, True),
    ):
        declared = requests(packets, packet="a")
        assert declared.only_requests(declared.all[0]) == expected
        assert not declared.only_requests(declared.all[1])
        assert ("a" in names(declared.carrying(TELECOMMAND))) == (not expected)


def test_a_packet_that_only_responds_is_no_packet_of_telecommands():
    packets = {"ask": {"from": "host"}, "ack": {"from": "both"}}
    link = {"packets": packets, "requests": {"packet": "ask"}}
    assert names(declared_packets(link).carrying(TELECOMMAND)) == ["ack"]
    responding = declared_packets({**link, "commands": {"ack": {"packet": "ack"}}})
    assert names(responding.carrying(TELECOMMAND)) == ["ask"]


def test_responses_of_single_telecommands_name_packets_too():
    link = {
        "packets": {
            "in": {"from": "device"},
            "ack": {"from": "device"},
            "out": {"from": "host"},
        }
    }
    own = message("Save", response={"ack": {"packet": "ack"}, "nak": {"packet": "out"}})
    assert declared_packets(link, [own]).responding == {"ack"}
    none = message("Save", response="none")
    assert declared_packets(
        {**link, "commands": {"ack": {"packet": "in"}}}, [none]
    ).responding == {"in"}
    telemetry = message("Frame", TELEMETRY, response={"ack": {"packet": "ack"}})
    assert declared_packets(link, [telemetry]).responding == frozenset()
    assert (
        declared_packets({**link, "commands": 7, "requests": 7}, [own]).responding
        == frozenset()
    )


def test_fields_without_a_position_follow_the_field_in_front_of_them():
    def link() -> dict:
        return {
            "header": [{"bits": 8}, {"bits": 4}, {"at": 20, "bits": 3}, {"bits": 1}, {"bits": "x"}, {"bits": 8}],
            "trailer": [{"bits": 16}, "x", {"bits": True}, {"bits": 8}],
            "packets": {"one": {"header": [{"at": "x", "bits": 8}, {"bits": 8}], "trailer": 7}, "two": 7},
        }  # fmt: skip

    placed = link()
    place_fields(placed)

    def positions(rows) -> list:
        return [row["at"] for row in rows if isinstance(row, dict)]

    assert positions(placed["header"]) == [0, 8, 20, 23, 24, 24]
    assert positions(placed["trailer"]) == [0, 16, 16]
    assert positions(placed["packets"]["one"]["header"]) == ["x", 0]
    for broken in (None, 7, {"packets": 7, "header": 7}):
        place_fields(broken)


def test_a_value_is_that_of_the_direction():
    assert value_of({}, TELEMETRY, False) == 0
    assert value_of({"value": 7}, TELEMETRY, True) == 7
    both = {"value": {TELECOMMAND: 1, TELEMETRY: [0x12, 0x34]}}
    assert value_of(both, TELECOMMAND, False) == 1
    assert value_of(both, TELEMETRY, False) == 0x1234
    assert value_of(both, TELEMETRY, True) == 0x3412
    assert value_of({"value": {TELECOMMAND: 1}}, TELEMETRY, False) == 0


def test_the_parts_of_an_id_are_its_bits_from_the_most_significant():
    source = random.Random(1)
    for count in range(1, 5):
        parts = [{"bits": source.randint(1, 9), "role": "id"} for _ in range(count)]
        rows = [{"bits": 3, "role": "flags"}]
        for part in parts:
            rows += [part, {"bits": 5, "role": "length"}]
        id = source.getrandbits(sum(part["bits"] for part in parts))
        joined = "".join(
            f"{id >> shift & (1 << part['bits']) - 1:0{part['bits']}b}"
            for part, shift in id_shifts(rows)
        )
        assert int(joined, 2) == id
        assert [part for part, _ in id_shifts(rows)] == parts


def asked(link: dict, telemetry: Message, commands=(), excluded=()) -> bool:
    return is_requested(declared_packets(link), telemetry, commands, excluded)


def test_telemetry_is_requested_by_its_id_if_nothing_else_has_it():
    frame = message("Frame", TELEMETRY, id=130)
    shared = {
        "header": [ID],
        "packets": {"out": {"from": "host"}, "in": {"from": "device"}},
        "requests": {},
    }
    assert asked(shared, frame)
    assert not asked(shared, frame, excluded=[130])
    assert asked(shared, frame, commands=[129, 131])
    assert not asked(shared, frame, commands=[130])
    own = {
        **shared,
        "packets": {**shared["packets"], "ask": {"from": "host"}},
        "requests": {"packet": "ask"},
    }
    assert asked(own, frame, commands=[130])
    assert not asked({**shared, "requests": {"packet": "none"}}, frame)
    assert not asked({**shared, "requests": 7}, frame)
    assert not asked(shared, message("Frame", TELEMETRY, id=130, requested=False))
    assert not asked(shared, message("Save", TELECOMMAND, id=130))


def test_requested_telemetry_is_recognized_by_its_id_or_its_packet():
    frame, log = message("Frame", TELEMETRY, id=130), message("Log", TELEMETRY, id=131)

    def link(own: dict, **requests) -> dict:
        packets = {
            "out": {"from": "host", "header": [ID]},
            "in": {"from": "device", "header": [FLAGS]},
            "log": {"from": "device", "header": [ID], "messages": ["Log"]},
        }
        return {
            "packets": {**packets, **own},
            "requests": {"packet": "out", **requests},
        }

    assert [asked(link({}), each) for each in (frame, log)] == [False, True]
    answered = link({}, response="in")
    assert [asked(answered, each) for each in (frame, log)] == [True, False]
    without_id = link({"out": {"from": "host", "header": [FLAGS]}}, response="in")
    assert not asked(without_id, frame)
