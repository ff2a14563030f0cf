"""Messages and CAN packets: whole again in any order, from several senders, and told
when they are not.
"""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import can, errors
from tests.protocol import quick

NODE, OBC, OTHER = 1, 0x42, 0x43
LONG = 19  # a telecommand of 127 bytes
contents = st.integers(0, 9999).map(lambda seed: Random(seed).randbytes(127))


def sent(known, data, source=OBC, id=LONG):
    return can.split(known, can.Message("telecommand", id, source, NODE, data))


def joined(known, packets, **options):
    joiner = can.Joiner(known, **options)
    return [event for packet in packets for event in joiner.feed(0, packet)], joiner


def messages(events):
    return [event.message.data for event in events if event.event == can.MESSAGE]


def test_the_identifier_has_its_parts_where_the_icd_says(known):
    (packet,) = can.split(known, can.Message("request", 146, 0x42, 1))
    assert packet == can.Packet(0x04 << 24 | 146 << 16 | 0x42 << 8 | 1, b"")
    assert can.parts_of(known.can, packet.id) == {
        "type": 4,
        "channel": 146,
        "source": 0x42,
        "destination": 1,
    }


def test_eight_bytes_fit_one_packet_nine_need_two(known):
    (one,) = sent(known, bytes(8))
    assert one.id >> 24 == 1
    first, second = sent(known, bytes(range(1, 10)))
    assert (first.id >> 24, first.data.hex(), second.data.hex()) == (
        7,
        "0102030405060701",
        "0809000000000000",
    )


def test_the_longest_message_has_256_packets_and_no_more(known):
    packets = sent(known, bytes(1792))
    assert len(packets) == 256
    assert [p.data[7] for p in packets] == list(range(255, -1, -1))
    with pytest.raises(errors.TooLongError):
        sent(known, bytes(1793))
    with pytest.raises(errors.TooLongError):
        can.split(known, can.Message("acknowledge", 1, NODE, OBC, b"\0"))


@quick
@given(data=contents, order=st.permutations(range(19)))
def test_the_order_of_packets_does_not_matter(known, data, order):
    packets = [sent(known, data)[number] for number in order]
    assert messages(joined(known, packets)[0]) == [data]


@quick
@given(data=contents, twice=st.sets(st.integers(0, 18)))
def test_repeated_packets_change_nothing_and_are_told(known, data, twice):
    packets = [
        p
        for number, p in enumerate(sent(known, data))
        for _ in range(1 + (number in twice))
    ]
    events, _ = joined(known, packets)
    assert messages(events) == [data]
    assert sum(e.event == can.DUPLICATE for e in events) == len(twice)


@quick
@given(
    sources=st.permutations([0x10, 0x20, 0x30, 0x40]),
    shuffle=st.randoms(use_true_random=False),
)
def test_senders_may_interleave(known, sources, shuffle):
    data = {source: bytes([source]) * 127 for source in sources}
    queues = {source: sent(known, data[source], source) for source in sources}
    mixed = []
    while any(queues.values()):
        mixed.append(queues[shuffle.choice([s for s in sources if queues[s]])].pop(0))
    events, _ = joined(known, mixed)
    assert {e.source: e.message.data for e in events if e.message} == data


@quick
@given(lost=st.integers(0, 18), first=contents, second=contents)
def test_a_lost_packet_costs_one_message_at_most(known, lost, first, second):
    packets = sent(known, first)
    del packets[lost]
    joiner = can.Joiner(known)
    events = [e for p in packets for e in joiner.feed(0, p)]
    events += joiner.expire(10_000)
    assert [e.event for e in events] == [can.INCOMPLETE] and events[0].missing == 1
    assert messages(
        [e for p in sent(known, second) for e in joiner.feed(10_000, p)]
    ) == [second]


@quick
@given(lost=st.integers(1, 18), data=contents)
def test_a_message_that_is_sent_again_arrives(known, lost, data):
    packets = sent(known, data)
    assert messages(joined(known, packets[:lost] + packets)[0])[0] == data


@quick
@given(
    begun=st.integers(1, 18),
    alike=st.integers(0, 18),
    data=contents,
)
def test_another_message_in_place_of_an_unfinished_one_is_never_mixed_with_it(
    known, begun, alike, data
):
    old = sent(known, data)
    new = data[: alike * 7] + bytes(byte ^ 0xFF for byte in data[alike * 7 :])
    assert messages(joined(known, old[:begun] + sent(known, new))[0]) == [new]


def test_there_is_room_for_so_many_senders_and_no_more(known):
    packets = [sent(known, bytes(127), source)[0] for source in range(3)]
    events, joiner = joined(known, packets, senders=2)
    assert [(e.event, e.source) for e in events] == [(can.BUSY, 2)]
    assert len(joiner.open) == 2


def test_messages_for_others_are_not_ours(known):
    assert joined(known, sent(known, bytes(127)), address=9)[0] == []


def test_a_count_beyond_the_longest_message_is_refused(known):
    unknown = next(i for i in range(128) if i not in known.telecommands)
    events, joiner = joined(known, sent(known, bytes(1792), id=unknown)[:1])
    assert [e.event for e in events] == [can.MALFORMED]
    assert joiner.open == []
