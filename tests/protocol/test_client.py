"""The client: one request at a time, and whatever happens it ends."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import can, uart
from icdgen.protocol.client import Client, Request
from icdgen.protocol.errors import BusyError, LengthError, UnknownIdError
from icdgen.protocol.sections import Settings
from tests.protocol import quick

SETTINGS = Settings(reply_timeout=100, retries=2, poll_interval=10, poll_timeout=50)
OUTCOMES = {"done", "refused", "timeout"}


def talking(known, bus="uart", **options):
    return Client(known, bus, settings=SETTINGS, **options)


def line(known, *data):
    return uart.encode(known.framing, bytes(data))


def test_the_next_telecommand_waits_for_the_acknowledge(known):
    client = talking(known)
    client.start(0, Request("telecommand", 31, b"\1"))
    assert client.out == [line(known, 31, 1)]
    client.out.clear()
    with pytest.raises(BusyError):
        client.start(1, Request("telecommand", 31, b"\1"))
    (event,) = client.received(2, line(known, 31, 0))
    assert (event["event"], event["attempts"]) == ("done", 1)
    client.start(3, Request("telecommand", 31, b"\1"))


def test_what_the_node_does_not_have_is_refused_before_it_is_sent(known):
    client = talking(known)
    with pytest.raises(UnknownIdError):
        client.start(0, Request("telecommand", 0))
    with pytest.raises(LengthError):
        client.start(0, Request("telecommand", 31, b""))
    assert client.out == [] and client.deadline is None


def test_a_telecommand_without_acknowledge_is_not_sent_twice_unless_it_may_be(known):
    for repeat, attempts in ((False, 1), (True, 3)):
        client, events, now = talking(known), [], 0
        client.start(0, Request("telecommand", 31, b"\1", repeat))
        while client.deadline is not None:
            now = client.deadline
            events += client.tick(now)
        assert [(e["event"], e["attempts"]) for e in events] == [("timeout", attempts)]
        assert len(client.out) == attempts


def test_a_setting_may_always_be_sent_again(known):
    client = talking(known)
    client.start(0, Request("telecommand", 3, b"\1"))
    assert client.tick(100) == [] and len(client.out) == 2


def test_a_late_acknowledge_is_not_taken_for_that_of_the_next(known):
    client = talking(known)
    client.start(0, Request("telecommand", 31, b"\1", repeat=True))
    client.tick(100)
    assert client.received(110, line(known, 31, 0))[0]["event"] == "done"
    client.out.clear()
    client.start(111, Request("telecommand", 31, b"\2"))
    assert client.out == []
    assert client.received(150, line(known, 31, 0))[0]["event"] == "stray"
    client.tick(210)
    assert client.out == [line(known, 31, 2)]
    assert client.received(220, line(known, 31, 3))[0]["reason"] == "parameter"


actions = st.one_of(
    st.tuples(
        st.just("ask"),
        st.sampled_from(
            [Request("telecommand", 31, b"\1"), Request("telecommand", 31, b"\1", True)]
        ),
    ),
    st.tuples(
        st.just("ask"),
        st.sampled_from(
            [Request("telemetry", 146), Request("telecommand", 115, bytes(22))]
        ),
    ),
    st.tuples(
        st.just("reply"),
        st.sampled_from(
            [
                bytes([31, 0]),
                bytes([31, 4]),
                bytes([146, *bytes(6)]),
                bytes([146]),
                bytes([119, 0]),
            ]
        ),
    ),
    st.tuples(st.just("noise"), st.binary(max_size=20)),
    st.tuples(st.just("wait"), st.integers(0, 150)),
)


@quick
@given(st.lists(actions, max_size=40), st.booleans())
def test_every_request_has_exactly_one_outcome(known, script, checked):
    client, now, asked, outcomes = talking(known, crc=checked), 0, 0, 0
    for action, value in script:
        now += 1
        events = []
        if action == "ask":
            client.out.clear()
            try:
                events = client.start(now, value)
                asked += 1
            except BusyError:
                assert client.deadline is not None
        elif action == "wait":
            now += value
            events = client.tick(now)
        else:
            events = client.received(
                now, line(known, *value) if action == "reply" else value
            )
        outcomes += sum(event["event"] in OUTCOMES for event in events)
        assert asked - outcomes == (client.deadline is not None)
    for _ in range(10):
        if client.deadline is not None:
            outcomes += sum(
                event["event"] in OUTCOMES for event in client.tick(client.deadline)
            )
    assert asked == outcomes


@quick
@given(
    st.lists(
        st.tuples(
            st.booleans(),
            st.one_of(st.none(), st.binary(max_size=9)),
            st.integers(0, 60),
        ),
        max_size=30,
    )
)
def test_on_i2c_nothing_hangs_either(known, script):
    client, now = talking(known, "i2c", crc=True), 0
    for telecommand, data, pause in script:
        client.out.clear()
        if client.deadline is None:
            client.start(
                now,
                (
                    Request("telecommand", 31, b"\1")
                    if telecommand
                    else Request("telemetry", 146)
                ),
            )
        now += pause
        client.transferred(now, data)
    for _ in range(100):
        if client.deadline is not None:
            client.tick(client.deadline)
    assert client.deadline is None


def test_on_can_a_frame_is_split_and_joined(known):
    client = talking(known, "can", address=0x42)
    client.start(0, Request("telemetry", 206))
    packets = can.split(
        known, can.Message("reply", 206, 1, 0x42, bytes(range(252)) * 2)
    )
    events = [event for packet in packets for event in client.packet(5, packet)]
    assert [bytes.fromhex(e["bytes"]) for e in events] == [bytes(range(252)) * 2]
