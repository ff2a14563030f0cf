"""On each bus, every request of a client ends with exactly one outcome."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from icdgen_runtime._errors import LengthError, UnknownIdError
from icdgen_runtime.wire.awaited import MOST_AWAITED, Request
from icdgen_runtime.wire.can import CanMessage, can_split
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.errors import BusyError
from icdgen_runtime.wire.events import (
    OUTCOMES,
    Done,
    Late,
    LineError,
    Refused,
    Stray,
    Timeout,
)
from icdgen_runtime.wire.i2c import I2cTransfer, i2c_write
from icdgen_runtime.wire.link import Settings
from icdgen_runtime.wire.uart import uart_encode

from icdgen.protocol.sections import CAN_KINDS, CAN_WITH_DATA
from tests.protocol import NOISE

QUICK = Settings(reply_timeout=100, retries=2, poll_interval=10, poll_timeout=50)
OURS, NODE = 0x42, 1
TELECOMMANDS, TELEMETRY = [1, 2, 7, 31, 37], [128, 144, 146, 240]


def talking(link, bus="uart", **options):
    return Client(link, bus, settings=QUICK, requests=1, **options)


def line(link, *data):
    return uart_encode(link, bytes(data))


def test_the_next_telecommand_waits_for_the_acknowledge(link):
    client = talking(link)
    client.start(0, Request("telecommand", 31, b"\1"))
    assert client.output() == line(link, 31, 1)
    with pytest.raises(BusyError):
        client.start(1, Request("telecommand", 31, b"\1"))
    assert client.received(2, line(link, 31, 0)) == [Done(31, 1, b"\0")]
    client.start(3, Request("telecommand", 31, b"\1"))


def test_a_request_that_the_node_does_not_support_is_rejected_before_it_is_sent(link):
    client = talking(link)
    with pytest.raises(UnknownIdError):
        client.start(0, Request("telecommand", 0))
    with pytest.raises(LengthError):
        client.start(0, Request("telecommand", 31, b""))
    assert (client.output(), client.deadline) == (b"", None)


def test_a_telecommand_without_acknowledge_is_repeated_only_if_this_is_allowed(link):
    for repeat, attempts in ((False, 1), (True, 3)):
        client, events, sent = talking(link), [], b""
        client.start(0, Request("telecommand", 31, b"\1", repeat))
        while client.busy:
            sent += client.output()
            events += client.tick(client.deadline)
        assert events == [Timeout(31, attempts)]
        assert sent == attempts * line(link, 31, 1)


def test_a_setting_is_always_repeated(link):
    client = talking(link)
    client.start(0, Request("telecommand", 3, b"\1"))
    assert client.output() == line(link, 3, 1)
    assert client.tick(100) == [] and client.output() == line(link, 3, 1)


def test_a_late_acknowledge_is_not_taken_for_that_of_the_next(link):
    client = talking(link)
    client.start(0, Request("telecommand", 31, b"\1", repeat=True))
    client.output()
    client.tick(100)
    client.output()
    assert client.received(110, line(link, 31, 0)) == [Done(31, 2, b"\0")]
    client.start(111, Request("telecommand", 31, b"\2"))
    assert client.output() == b""
    assert client.received(150, line(link, 31, 0)) == [Late(31, b"\0")]
    client.tick(210)
    assert client.output() == line(link, 31, 2)
    assert client.received(220, line(link, 31, 3)) == [
        Refused(31, 1, 3, "Incorrect Parameter", None, b"\3")
    ]


def test_on_can_a_frame_is_split_and_joined(link):
    client, data = talking(link, "can", address=OURS), bytes(range(252)) * 2
    client.start(0, Request("telemetry", 206))
    client.packets()
    packets = can_split(link, CanMessage("reply", 206, NODE, OURS, data))
    (event,) = [event for packet in packets for event in client.packet(5, packet)]
    assert event.data == data


@pytest.mark.parametrize("cancelled", [9, 10])
def test_on_i2c_a_cancelled_request_leaves_the_transaction_of_an_equal_one(
    link, cancelled
):
    """The application takes no more transactions while eight have no result, also if
    their requests have ended.
    """
    client = Client(link, "i2c", settings=QUICK._replace(in_flight=10))
    for _ in range(MOST_AWAITED):
        client.start(0, Request("telemetry", 146))
    assert len(client.transfers()) == MOST_AWAITED == 8
    client.cancel()
    client.tick(10**6)  # when no late responses are expected any more
    for _ in range(2):
        client.start(10**6, Request("telemetry", 146))
    assert client.transfers() == []
    client.cancel(handle=cancelled)
    for _ in range(MOST_AWAITED):
        (late,) = client.transferred(10**6, bytes(6))
        assert isinstance(late, Late)
    assert client.transfers() == [I2cTransfer(b"\x92", 6)]
    (done,) = client.transferred(10**6, bytes([2, *bytes(5)]))
    assert (done.handle, done.data[0]) == (19 - cancelled, 2)
    assert client.transfers() == [] and not client.busy


@pytest.mark.parametrize(
    ("request_", "read", "event"),
    [
        (None, b"\1\2", Stray(b"\1\2")),
        (None, None, Stray(b"")),
        (Request("telemetry", 146), None, Late(146, b"")),
        (Request("telemetry", 146), bytes(6), Late(146, bytes(6))),
        (Request("telemetry", 146), bytes(5), LineError("length", 146)),
        (Request("telecommand", 31, b"\1"), None, Late(31, b"")),
        (Request("telecommand", 31, b"\1"), b"", Late(31, b"")),
    ],
)
def test_the_result_of_an_i2c_transaction_without_request_is_an_event(
    link, request_, read, event
):
    client = Client(link, "i2c", settings=QUICK)
    if request_ is not None:
        client.start(0, request_)
        assert len(client.transfers()) == 1
        client.cancel()
    (result,) = client.transferred(1, read)
    if isinstance(result, Late):
        result = replace(result, type=None)
    assert result == event


@st.composite
def requests(draw, link):
    """A request, sometimes one that the node does not support."""
    if draw(st.booleans()):
        return Request("telemetry", draw(st.sampled_from([*TELEMETRY, 5])))
    id = draw(st.sampled_from([*TELECOMMANDS, 200]))
    is_supported = id in link.commands and draw(st.integers(0, 9))
    length = link.commands[id].length if is_supported else 3
    data = draw(st.binary(min_size=length, max_size=length))
    return Request("telecommand", id, data, draw(st.booleans()))


@st.composite
def frames(draw, link):
    """Id and data of a frame, whose length is sometimes wrong."""
    id = draw(st.sampled_from(TELEMETRY))
    if id == 240:  # the result of a telecommand
        about = draw(st.sampled_from(TELECOMMANDS)), draw(st.integers(0, 1))
        return id, bytes((*about, draw(st.integers(0, 5)), 9))
    length = link.frames[id] + (not draw(st.integers(0, 7)))
    return id, draw(st.binary(min_size=length, max_size=length))


@st.composite
def received(draw, link, bus):
    """Bytes that the client receives: a response, a part of one, or noise."""
    id, frame = draw(frames(link))
    if bus == "i2c":
        checked = i2c_write(link, id, frame, True)[1:]
        wrong = checked[:-1] + bytes([checked[-1] ^ 1])
        return draw(st.sampled_from([None, b"", b"", frame, checked, checked, wrong]))
    about = draw(st.sampled_from(TELECOMMANDS))
    if bus == "can":
        kind = draw(st.sampled_from(CAN_KINDS))
        source = draw(st.sampled_from([NODE, NODE, 9]))
        if kind not in CAN_WITH_DATA:
            id, frame = draw(st.sampled_from([about, id])), b""
        message = CanMessage(kind, id, source, OURS, frame)
        return draw(st.sampled_from(can_split(link, message)))
    acknowledge = bytes((about, draw(st.sampled_from([0, 0, 1, 4, 77]))))
    complete = line(link, *draw(st.sampled_from([acknowledge, bytes((id,)) + frame])))
    place = draw(st.integers(0, len(complete)))
    pieces = [complete, complete, complete[:place], complete[place:]]
    return draw(st.sampled_from(pieces)) + draw(NOISE)


@given(st.data(), st.sampled_from(["uart", "i2c", "can"]), st.booleans())
@settings(max_examples=300)
def test_every_request_has_exactly_one_outcome(link, data, bus, checked):
    client, now, requested, ended = (
        talking(link, bus, crc=checked, address=OURS),
        0,
        [],
        [],
    )
    receive = {"uart": client.received, "i2c": client.transferred, "can": client.packet}

    def check(events):
        for take in (client.output, client.packets, client.transfers):
            take()
        for event in events:
            if isinstance(event, OUTCOMES):
                ended.append(event.id)
                assert event.attempts <= 1 + QUICK.retries
                if isinstance(event, Done) and event.type:
                    assert len(event.data) == link.frames[event.id]
        assert ended == requested[: len(ended)]
        assert (
            len(requested) - len(ended) == (client.deadline is not None) == client.busy
        )

    for action in data.draw(st.lists(st.sampled_from("srrtc"), max_size=25)):
        now += data.draw(st.sampled_from([0, 1, 5, 10, 49, 60, 100, 150]))
        if action == "r":
            check(receive[bus](now, data.draw(received(link, bus))))
        elif action == "t":
            check(client.tick(now))
        elif action == "c":
            client.cancel()
            del requested[len(ended) :]
            check([])
        else:
            request, is_busy = data.draw(requests(link)), client.busy
            try:
                client.start(now, request)
            except (UnknownIdError, LengthError):
                continue
            except BusyError:
                assert is_busy
                continue
            requested.append(request.id)
            check([])
    for _ in range(100):
        if client.busy:
            check(client.tick(client.deadline))
    assert requested == ended
