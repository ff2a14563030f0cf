"""Requests that join CAN packets show lost, repeated, late and foreign packets, with the
events that their purpose states.
"""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of_node
from icdgen.vectors.wire import packets
from tests.conformance.icds import icd_of

ICD = icd_of()
NODE = ICD.node("cubeacp")
FACTS = facts.of(ICD, NODE)
REQUESTS = list(packets.requests(link_of_node(ICD, NODE), FACTS, Random(1)))
CAN = FACTS.can


def answer(request):
    return reference.answer(ICD, {**request, "node": NODE.name})


def request_of(why, op="can_join"):
    (request,) = [r for w, r in REQUESTS if (w, r["op"]) == (why, op)]
    return request


def names(why):
    """Return the events of joined packets, and "telecommand" for a message."""
    rows = answer(request_of(why))["events"]
    return [row.get("kind") or row["event"] for row in rows]


def test_each_kind_has_a_message_of_each_length_that_is_split_and_joined():
    kinds = {}
    for why, request in REQUESTS:
        if request["op"] != "can_split" or not answer(request)["ok"]:
            continue
        kinds.setdefault(request["kind"], []).append(request)
        join = [r for w, r in REQUESTS if (w, r["op"]) == (why, "can_join")]
        if join:
            (event,) = answer(join[0])["events"]
            keys = ("kind", "id", "source", "destination", "bytes")
            assert [event[key] for key in keys] == [request[key] for key in keys]
    assert list(kinds) == [kind for kind in packets.CAN_KINDS if kind in CAN.types]
    lengths = [len(each["bytes"]) // 2 for each in kinds["telecommand"]]
    assert lengths[:-1] == sorted({m.length for m in FACTS.telecommands.values()})
    assert lengths[-1] == CAN.extended.bytes
    lengths = [len(each["bytes"]) // 2 for each in kinds["reply"]]
    assert lengths == sorted({m.length for m in FACTS.telemetry.values()})
    for kind in ("acknowledge", "request"):
        assert [each["bytes"] for each in kinds[kind]] == [""] * 2
    # The first message of each length stands for it.
    for each in kinds["reply"]:
        size = len(each["bytes"]) // 2
        ids = [id for id, m in FACTS.telemetry.items() if m.length == size]
        assert each["id"] == ids[0]


def test_a_telecommand_goes_to_the_node_and_all_else_comes_from_it():
    node = CAN.node_address
    for _, request in REQUESTS:
        if request["op"] == "can_split":
            ends = request["source"], request["destination"]
            assert ends == ((0x42, node) if request["kind"] == "telecommand"
                            or request["id"] == 0x7F else (node, 0x42))  # fmt: skip


def test_the_largest_message_is_split_and_one_byte_more_is_not():
    most = CAN.extended.bytes
    assert answer(request_of(f"{most} bytes", "can_split"))["ok"]
    assert not answer(request_of(f"{most + 1} bytes", "can_split"))["ok"]
    assert not answer(request_of("data where none is expected", "can_split"))["ok"]


@pytest.mark.parametrize(
    ("why", "expected"),
    [
        ("out of order", ["telecommand"]),
        ("two messages, one after the other", ["telecommand"] * 2),
        ("the same message twice", ["telecommand"] * 2),
        ("two senders, in turn", ["telecommand"] * 2),
        ("no receiver for them", []),
        ("one after the other, room for one", ["telecommand"] * 2),
        ("a pause just short enough", ["telecommand"]),
    ],
)
def test_complete_messages_are_joined(why, expected):
    assert names(why) == expected


@pytest.mark.parametrize(
    ("why", "messages", "event"),
    [
        ("each packet twice", 1, "duplicate"),
        ("the last packet twice, then another message", 2, None),
        ("a lost packet, then the same message again", 1, None),
        ("a lost last packet, then another message", 1, "incomplete"),
        ("two senders in turn, one packet lost", 1, "incomplete"),
        ("an unknown id", 1, None),
        ("a count that is too high", 1, "malformed"),
        ("a packet that is too short", 1, None),
        ("a message type that does not exist", 1, "unknown_type"),
        ("a pause that is too long", 1, "incomplete"),
        ("five senders, room for 4", 4, "busy"),
        ("five senders, room for 5", 5, None),
    ],
)
def test_faults_of_packets_have_their_event(why, messages, event):
    rows = names(why)
    assert rows.count("telecommand") == messages, rows
    assert event is None or event in rows, rows


def test_pauses_are_those_of_the_time_limit():
    late = CAN.extended.packet_timeout
    short, long = (
        [row.get("at", 0) for row in request_of(why)["packets"]]
        for why in ("a pause just short enough", "a pause that is too long")
    )
    assert short == [0] + [late - 1] * (len(short) - 1)
    assert long == [0] + [late] * (len(long) - 1)
    assert request_of("an unknown id")["end"] == late


def test_an_unknown_id_is_the_largest_free_one():
    unknown = next(id for id in range(127, -1, -1) if id not in FACTS.telecommands)
    (event,) = answer(request_of("an unknown id"))["events"]
    assert event["id"] == unknown
    packets_of_id = request_of("an unknown id")["packets"]
    lost = request_of("an unknown id, the first packet lost")["packets"]
    assert lost == packets_of_id[1:]
