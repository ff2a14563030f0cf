"""CAN: packets of any order, of several senders, lost and doubled ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import can
from tests.python.wire import known, link

OURS, NODE, OTHER = 0x42, 0x01, 0xFE


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def long(like) -> list[tuple[str, int, int]]:
    """Messages of several packets: kind, id, bytes."""
    sent = [
        ("telecommand", id, one.length)
        for id, one in like.commands.items()
        if 8 < one.length < 60
    ]
    return (
        sent[:3]
        + [
            ("reply", id, length)
            for id, length in like.frames.items()
            if 8 < length < 60
        ][:3]
    )


@st.composite
def traffic(draw):
    """Packets of the reference, mixed, lost, doubled, late, and now and then nonsense."""
    facts, rows = known(), []
    telemetry = [id for id, m in facts.telemetry.items() if 8 < m.length < 40][:2]
    for _ in range(draw(st.integers(1, 4))):
        id = draw(st.sampled_from([*telemetry, 7, 250]))
        size = (
            facts.telemetry[id].length if id in telemetry else draw(st.integers(9, 30))
        )
        source = draw(st.sampled_from([NODE, OTHER]))
        data = draw(st.binary(min_size=size, max_size=size))
        kind = draw(st.sampled_from(["reply", "telecommand"]))
        rows += can.split(facts, can.Message(kind, id, source, OURS, data))
    rows = draw(st.permutations(rows)) if draw(st.booleans()) else rows
    picked = (
        draw(st.lists(st.integers(0, len(rows) - 1), max_size=2 * len(rows)))
        if draw(st.booleans())
        else range(len(rows))
    )
    packets, now = [], 0
    for index in picked:
        now += draw(st.sampled_from([0, 0, 0, 1, 400, 1000]))
        packet = rows[index]
        if draw(st.integers(0, 9)) == 0:
            packet = can.Packet(
                draw(st.integers(0, (1 << 29) - 1)), draw(st.binary(max_size=8))
            )
        elif draw(st.integers(0, 9)) == 0:
            packet = can.Packet(packet.id, draw(st.binary(min_size=8, max_size=8)))
        packets.append((now, packet))
    return packets


@given(packets=traffic(), senders=st.integers(1, 3), address=st.none() | st.just(OURS))
def test_whatever_comes_gives_what_the_reference_finds(
    shipped, wire, packets, senders, address
):
    joiner, reference = wire.CanJoiner(link(shipped), address, senders), can.Joiner(
        known(), address, senders
    )
    for now, packet in packets:
        assert joiner.feed(now, wire.CanPacket(*packet)) == reference.feed(now, packet)
    assert joiner.expire(10_000) == reference.expire(10_000)


@given(st.data())
def test_interleaved_messages_in_any_order_arrive(shipped, wire, data):
    like = link(shipped)
    messages = []
    for (kind, id, size), source in zip(long(like), (1, 1, 1, 2, 2, 2), strict=False):
        content = data.draw(st.binary(min_size=size, max_size=size))
        messages.append(wire.CanMessage(kind, id, source, OURS, content))
    packets = data.draw(
        st.permutations(
            [p for message in messages for p in wire.can_split(like, message)]
        )
    )
    joiner = wire.CanJoiner(like, OURS, len(messages))
    events = [event for packet in packets for event in joiner.feed(0, packet)]
    assert {event.event for event in events} == {"message"}
    assert sorted(event.message for event in events) == sorted(messages)


def test_short_messages_are_one_packet(shipped, wire):
    like = link(shipped)
    (packet,) = wire.can_split(
        like, wire.CanMessage("telecommand", 31, OURS, NODE, b"\1")
    )
    assert packet == (1 << 24 | 31 << 16 | OURS << 8 | NODE, b"\1")
    (event,) = wire.CanJoiner(like).feed(0, packet)
    assert event.message == ("telecommand", 31, OURS, NODE, b"\1")


def test_what_does_not_fit_is_refused(shipped, wire):
    like = link(shipped)
    message = wire.CanMessage("telecommand", 31, OURS, NODE, bytes(1793))
    with pytest.raises(wire.TooLongError) as error:
        wire.can_split(like, message)
    assert (error.value.expected, error.value.actual) == (1792, 1793)
    with pytest.raises(wire.TooLongError):
        wire.can_split(like, message._replace(kind="request", data=b"\1"))
    with pytest.raises(shipped.module().RangeError, match="source"):
        wire.can_split(like, message._replace(data=b"", source=256))
    with pytest.raises(wire.UnsupportedError):
        wire.CanJoiner(like._replace(can=None))


def test_senders_are_bounded(shipped, wire):
    like = link(shipped)
    _, id, size = long(like)[0]
    joiner, events = wire.CanJoiner(like, senders=4), []
    for source in range(200):
        packets = wire.can_split(
            like, wire.CanMessage("telecommand", id, source, NODE, bytes(size))
        )
        events += [event.event for event in joiner.feed(0, packets[0])]
        assert len(joiner._open) <= 4
    assert events == ["busy"] * 196
