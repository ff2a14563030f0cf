"""Packet formats and responses of a link on each bus."""

from __future__ import annotations

import pytest

from icdgen.icd.buses import bus_link, buses_with, can_packets

LINK = {
    "packets": {
        "Command": {"from": "host", "header": [{"name": "Start", "bits": 8}]},
        "Special": {"from": "host", "messages": ["Reset"]},
        "Request": {"from": "host", "header": []},
        "Ack": {"from": "device"},
        "Nak": {"from": "device", "buses": ["can", "uart"]},
        "Denied": {"from": "device", "buses": ["uart"]},
        "Listed": {"from": "device", "messages": ["State"]},
        "Reply": {"from": "device"},
        "Part": {"from": "device", "segment_of": "Reply"},
        "Broken": "none",
    },
    "commands": {
        "ack": {"packet": "Ack", "status": "Code"},
        "nak": {"packet": "Nak"},
        "reasons": {"checksum": 2},
    },
    "requests": {"packet": "Request", "nak": {"packet": "Denied"}},
    "buses": {
        "uart": {"commands": {"nak": "none", "timeout_ms": 5}},
        "i2c": {"requests": {"packet": "Command", "nak": {"packet": "Ack"}}},
        "can": {},
    },
}


def names(packets) -> list[str]:
    return [packet.name for packet in packets]


@pytest.mark.parametrize(
    ("buses", "expected"),
    [
        (None, ("uart", "i2c", "can")),
        ("uart", ("uart", "i2c", "can")),
        ([], ()),
        (["can", "spi", "uart"], ("uart", "can")),
        (("i2c",), ("i2c",)),
    ],
)
def test_a_packet_is_sent_on_all_buses_or_on_those_it_lists(buses, expected):
    assert buses_with({} if buses is None else {"buses": buses}) == expected


@pytest.mark.parametrize(
    ("bus", "without"),
    [("uart", {"Broken"}), ("i2c", {"Broken", "Nak", "Denied"}), ("can", {"Broken", "Denied"})],
)  # fmt: skip
def test_a_bus_has_the_packets_that_are_sent_on_it(bus, without):
    expected = [name for name in LINK["packets"] if name not in without]
    assert names(bus_link(LINK, bus).packets.all) == expected


def test_a_bus_overrides_single_keys_of_the_responses():
    uart, i2c = bus_link(LINK, "uart"), bus_link(LINK, "i2c")
    ack = LINK["commands"]["ack"]
    assert uart.commands == {"ack": ack}
    assert uart.requests == {"nak": {"packet": "Denied"}}
    assert i2c.commands == {"ack": ack, "nak": {"packet": "Nak"}}
    assert i2c.requests == {"nak": {"packet": "Ack"}}
    assert uart.reasons == i2c.reasons == {"checksum": 2}
    assert (uart.packets.requesting, i2c.packets.requesting) == ("Request", "Command")


def test_packets_of_responses_keep_their_numbers_if_one_is_absent():
    uart, i2c = (bus_link(LINK, bus).responses for bus in ("uart", "i2c"))
    assert names(uart.all) == ["Ack", "", "Denied"]
    assert names(i2c.all) == ["Ack", "", "Ack"]
    assert [packet.rows for packet in uart.all] == [[], [], []]
    assert uart.requesting == "Request"


def test_messages_that_no_packet_lists_have_the_general_packet_of_their_direction():
    link = bus_link(LINK, "uart")
    assert link.carrying("telecommand").name == "Command"
    assert link.carrying("telemetry").name == "Nak", "no response names it on this bus"
    assert bus_link(LINK, "can").carrying("telemetry").name == "Reply"
    requests_only = {"packets": {"Request": {"from": "host"}}, "requests": {}}
    assert bus_link(requests_only, "uart").carrying("telecommand") is None
    assert bus_link({}, "uart").carrying("telemetry") is None


def test_the_packet_with_a_part_of_a_message_is_found_by_the_packet_of_the_message():
    link = bus_link(LINK, "uart")
    reply, ack = (link.packets.by_name(name) for name in ("Reply", "Ack"))
    assert link.segment_of(reply).name == "Part"
    assert link.segment_of(ack) is None
    assert link.segment_of(None) is None


def test_responses_on_can_repeat_the_id_in_front_of_the_data():
    link = bus_link(LINK, "can")
    id_row = {"at": 0, "bits": 8, "role": "id"}
    assert [list(packet.header) for packet in link.packets.all] == [[id_row]] * 8
    assert link.commands == {
        "ack": {"echo": "id", "packet": "Ack", "status": "Code"},
        "nak": {"echo": "id", "packet": "Nak"},
    }
    assert link.requests == {"nak": {"echo": "id", "packet": "Denied"}}
    assert link.reasons == {"checksum": 2}
    own = {"commands": {"ack": {"packet": "Ack", "echo": "Number"}}}
    assert bus_link(own, "can").commands["ack"]["echo"] == "Number"


def test_packets_on_can_are_listed_by_purpose():
    link = {**LINK, "packets": {**LINK["packets"], "Denied": {"from": "device"}}}
    packets = {kind: each.name for kind, each in can_packets(bus_link(link, "can")).items()}  # fmt: skip
    assert packets == {
        "telecommand": "Command",
        "acknowledge": "Ack",
        "refusal": "Nak",
        "request": "Request",
        "reply": "Reply",
        "request_refusal": "Denied",
    }
    assert "request_refusal" not in can_packets(bus_link(LINK, "can"))
    assert can_packets(bus_link({}, "can")) == {}


@pytest.mark.parametrize("key", ["packets", "commands", "requests", "buses"])
def test_a_section_of_another_type_counts_as_empty(key):
    link = bus_link({**LINK, key: ["x"]}, "uart")
    absent = {name: value for name, value in LINK.items() if name != key}
    assert link.packets.all == bus_link(absent, "uart").packets.all or key == "packets"
    assert link.commands == bus_link(absent, "uart").commands
    assert link.requests == bus_link(absent, "uart").requests
