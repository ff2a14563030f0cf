"""Messages are split into CAN packets and joined again, in any order and from several
senders.

Incomplete messages are reported.
"""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.can import CanJoiner, CanMessage, CanPacket, can_split
from icdgen_runtime.wire.errors import TooLongError, UnsupportedError

from tests.protocol import quick

NODE, OBC, OTHER = 1, 0x42, 0x43
LONG = 19  # a telecommand of 127 bytes
contents = st.integers(0, 9999).map(lambda seed: Random(seed).randbytes(127))


def sent(link, data, source=OBC, id=LONG):
    return can_split(link, CanMessage("telecommand", id, source, NODE, data))


def joined(link, packets, **options):
    joiner = CanJoiner(link, **options)
    return [event for packet in packets for event in joiner.feed(0, packet)], joiner


def messages(events):
    return [event.message.data for event in events if event.event == "message"]


def test_the_identifier_has_its_parts_at_the_positions_in_the_icd(link):
    (packet,) = can_split(link, CanMessage("request", 146, 0x42, 1))
    assert packet == CanPacket(0x04 << 24 | 146 << 16 | 0x42 << 8 | 1, b"")
    (event,) = CanJoiner(link).feed(0, packet)
    assert event.message == CanMessage("request", 146, 0x42, 1)


def test_an_address_out_of_range_is_rejected(link):
    with pytest.raises(RangeError, match="source"):
        can_split(link, CanMessage("request", 146, 256, 1))


def test_eight_bytes_fit_into_one_packet_and_nine_into_two(link):
    (packet,) = sent(link, bytes(8))
    assert packet.id >> 24 == 1
    first, second = sent(link, bytes(range(1, 10)))
    assert (first.id >> 24, first.data.hex(), second.data.hex()) == (
        7,
        "0102030405060701",
        "0809000000000000",
    )


def test_the_longest_message_has_256_packets_and_no_more(link):
    packets = sent(link, bytes(1792))
    assert len(packets) == 256
    assert [p.data[7] for p in packets] == list(range(255, -1, -1))
    with pytest.raises(TooLongError) as error:
        sent(link, bytes(1793))
    assert (error.value.expected, error.value.actual) == (1792, 1793)
    with pytest.raises(TooLongError):
        can_split(link, CanMessage("acknowledge", 1, NODE, OBC, b"\0"))


@quick
@given(data=contents, order=st.permutations(range(19)))
def test_the_order_of_packets_does_not_matter(link, data, order):
    packets = [sent(link, data)[number] for number in order]
    assert messages(joined(link, packets)[0]) == [data]


@quick
@given(data=contents, repeated=st.sets(st.integers(0, 18)))
def test_repeated_packets_change_nothing_and_are_reported(link, data, repeated):
    packets = [
        p
        for number, p in enumerate(sent(link, data))
        for _ in range(1 + (number in repeated))
    ]
    events, _ = joined(link, packets)
    assert messages(events) == [data]
    assert sum(e.event == "duplicate" for e in events) == len(repeated)


@quick
@given(st.data())
def test_messages_of_several_senders_arrive_in_any_order(link, data):
    lengths = {id: command.length for id, command in link.commands.items()}
    sent = []
    for kind, sizes in (("telecommand", lengths), ("reply", link.frames)):
        long = [(id, size) for id, size in sizes.items() if 8 < size < 60]
        for (id, size), source in zip(long, (1, 1, 2), strict=False):
            content = data.draw(st.binary(min_size=size, max_size=size))
            sent.append(CanMessage(kind, id, source, OBC, content))
    packets = [packet for message in sent for packet in can_split(link, message)]
    events, _ = joined(
        link, data.draw(st.permutations(packets)), address=OBC, senders=len(sent)
    )
    assert {event.event for event in events} == {"message"}
    assert sorted(event.message for event in events) == sorted(sent)


@st.composite
def traffic(draw, link):
    """Packets with their times: mixed, lost, repeated, late, and sometimes invalid."""
    long_ids = [id for id, length in link.frames.items() if 8 < length < 40][:2]
    rows = []
    for _ in range(draw(st.integers(1, 4))):
        id = draw(st.sampled_from([*long_ids, 7, 250]))
        size = link.frames[id] if id in long_ids else draw(st.integers(9, 30))
        kind = draw(st.sampled_from(["reply", "telecommand"]))
        source, data = draw(st.sampled_from([NODE, OTHER])), draw(contents)[:size]
        rows += can_split(link, CanMessage(kind, id, source, OBC, data))
    if draw(st.booleans()):
        rows = draw(st.permutations(rows))
    if draw(st.booleans()):
        rows = draw(st.lists(st.sampled_from(rows), max_size=2 * len(rows)))
    odd = st.builds(CanPacket, st.integers(0, (1 << 29) - 1), st.binary(max_size=8))
    packets, now = [], 0
    for packet in rows:
        now += draw(st.sampled_from([0, 0, 0, 1, 400, 1000]))
        if draw(st.integers(0, 9)) == 0:
            packet = draw(odd)
        elif draw(st.integers(0, 9)) == 0:
            packet = packet._replace(data=draw(st.binary(min_size=8, max_size=8)))
        packets.append((now, packet))
    return packets


@given(st.data(), st.integers(1, 3), st.none() | st.just(OBC), contents)
def test_after_any_traffic_and_a_pause_a_message_arrives(
    link, data, senders, address, content
):
    joiner, events = CanJoiner(link, address, senders), []
    for now, packet in data.draw(traffic(link)):
        events += joiner.feed(now, packet)
        assert len(joiner._open) <= senders
    joiner.expire(100_000)
    assert not joiner._open and joiner.expire(200_000) == []
    for event in events:
        assert (event.message is not None) == (event.event == "message")
        assert (event.missing > 0) == (event.event == "incomplete")
        if event.message and address is not None:
            assert event.message.destination == address
    packets = can_split(link, CanMessage("telecommand", LONG, NODE, OBC, content))
    (event,) = [e for packet in packets for e in joiner.feed(200_000, packet)]
    assert event.message.data == content


@quick
@given(lost=st.integers(0, 18), first=contents, second=contents)
def test_a_lost_packet_costs_one_message_at_most(link, lost, first, second):
    packets = sent(link, first)
    del packets[lost]
    joiner = CanJoiner(link)
    events = [e for p in packets for e in joiner.feed(0, p)]
    events += joiner.expire(10_000)
    assert [e.event for e in events] == ["incomplete"] and events[0].missing == 1
    assert messages(
        [e for p in sent(link, second) for e in joiner.feed(10_000, p)]
    ) == [second]


@quick
@given(lost=st.integers(1, 18), data=contents)
def test_a_message_that_is_sent_again_arrives(link, lost, data):
    packets = sent(link, data)
    assert messages(joined(link, packets[:lost] + packets)[0])[0] == data


@quick
@given(
    sent_before=st.integers(1, 18),
    equal_packets=st.integers(0, 18),
    data=contents,
)
def test_another_message_in_place_of_an_unfinished_one_is_never_mixed_with_it(
    link, sent_before, equal_packets, data
):
    old = sent(link, data)
    new = data[: equal_packets * 7] + bytes(
        byte ^ 0xFF for byte in data[equal_packets * 7 :]
    )
    assert messages(joined(link, old[:sent_before] + sent(link, new))[0]) == [new]


def test_the_number_of_senders_is_limited(link):
    packets = [sent(link, bytes(127), source)[0] for source in range(200)]
    events, joiner = joined(link, packets, senders=2)
    assert [(e.event, e.source) for e in events] == [
        ("busy", source) for source in range(2, 200)
    ]
    assert len(joiner._open) == 2


def test_messages_for_other_addresses_are_ignored(link):
    assert joined(link, sent(link, bytes(127)), address=9)[0] == []


def test_a_count_beyond_the_longest_message_is_rejected(link):
    unknown = next(i for i in range(128) if i not in link.commands)
    events, joiner = joined(link, sent(link, bytes(1792), id=unknown)[:1])
    assert [e.event for e in events] == ["malformed"]
    assert not joiner._open


def test_a_node_without_can_is_rejected(link):
    with pytest.raises(UnsupportedError, match="can"):
        CanJoiner(link._replace(can=None))
