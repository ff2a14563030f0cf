"""Messages in a stream of bytes: found whole, whatever comes before, between and within
them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import uart
from tests.protocol import quick

ESCAPE, START, END = 0x1F, 0x7F, 0xFF
markers = st.sampled_from([ESCAPE, START, END, 0x00, 0x90])
streams = st.one_of(st.binary(max_size=200), st.lists(markers, max_size=200).map(bytes))
messages = st.one_of(
    st.binary(min_size=1, max_size=100),
    st.lists(markers, min_size=1, max_size=100).map(bytes),
)


def decode(known, *chunks, limit=None):
    decoder = uart.Decoder(known.framing, limit or known.longest)
    return [event for chunk in chunks for event in decoder.feed(chunk)], decoder


def found(known, stream):
    return [e.message for e in decode(known, stream)[0] if e.event == uart.MESSAGE]


def test_the_id_that_is_the_escape_byte_is_escaped(known):
    assert uart.encode(known.framing, bytes([31, 0])).hex() == "1f7f1f1f001fff"
    assert found(known, bytes.fromhex("1f7f1f1f001fff")) == [bytes([31, 0])]


def test_an_end_within_the_data_is_data(known):
    message = bytes.fromhex("901f1fff")
    assert uart.encode(known.framing, message).hex() == "1f7f901f1f1f1fff1fff"
    assert found(known, uart.encode(known.framing, message)) == [message]


@quick
@given(all=st.lists(messages, max_size=5))
def test_what_is_encoded_is_decoded(known, all):
    stream = b"".join(uart.encode(known.framing, one) for one in all)
    events, decoder = decode(known, stream)
    assert [e.message for e in events] == all
    assert decoder.discarded == decoder.pending == 0


@quick
@given(stream=streams, cuts=st.lists(st.integers(0, 200), max_size=6))
def test_events_do_not_depend_on_how_a_stream_is_cut(known, stream, cuts):
    places = sorted({0, len(stream), *(cut for cut in cuts if cut < len(stream))})
    pieces = [stream[a:b] for a, b in pairwise(places)]
    whole, first = decode(known, stream, limit=20)
    cut, second = decode(known, *pieces, limit=20)
    assert whole == cut
    assert (first.discarded, first.pending) == (second.discarded, second.pending)


@quick
@given(
    noise=streams.filter(lambda noise: bytes([ESCAPE, START]) not in noise),
    message=messages,
)
def test_noise_costs_nothing_but_the_noise(known, noise, message):
    events, decoder = decode(known, noise + uart.encode(known.framing, message))
    assert [e.message for e in events] == [message]
    assert decoder.discarded == len(noise)


@quick
@given(stream=streams, message=messages)
def test_a_message_after_an_end_is_found_whatever_was_before_it(known, stream, message):
    line = uart.encode(known.framing, message)
    assert found(known, stream + bytes([0, ESCAPE, END]) + line)[-1] == message


@quick
@given(stream=streams, limit=st.integers(1, 30))
def test_no_more_is_kept_than_the_longest_message(known, stream, limit):
    decoder = uart.Decoder(known.framing, limit)
    delivered = 0
    for number, byte in enumerate(stream, 1):
        for event in decoder.feed(bytes([byte])):
            assert len(event.message) <= limit
            delivered += (
                len(uart.encode(known.framing, event.message))
                if event.event == uart.MESSAGE
                else 0
            )
        assert len(decoder.buffer) <= limit
        assert decoder.discarded + decoder.pending + delivered == number


def test_what_goes_wrong_is_told(known):
    start, end = bytes([ESCAPE, START]), bytes([ESCAPE, END])

    def kinds(stream, limit=None):
        return [e.event for e in decode(known, stream, limit=limit)[0]]

    assert kinds(start + b"\x90" + start + b"\x91" + end) == [
        uart.UNEXPECTED_START,
        uart.MESSAGE,
    ]
    assert kinds(start + b"\x90\x1f\x00" + end) == [uart.PROTOCOL_ERROR]
    assert kinds(start + end) == [uart.EMPTY]
    assert kinds(start + b"\x90\x01\x02" + end, limit=2) == [uart.OVERRUN]
    assert kinds(start + b"\x90\x01" + end, limit=2) == [uart.MESSAGE]
    assert kinds(start + b"\x90\x1f") == []


def test_messages_are_told_apart(known):
    assert uart.kind(known, bytes([31, 0])) == uart.ACKNOWLEDGE
    assert uart.kind(known, bytes([119, 0])) == uart.ACKNOWLEDGE
    assert uart.kind(known, bytes([119]) + bytes(22)) == uart.PACKET
    assert uart.kind(known, bytes([119]) + bytes(21)) == uart.OTHER
    assert uart.kind(known, bytes([241]) + bytes(22)) == uart.REPLY
    assert uart.kind(known, bytes([255, 1, *bytes(9), *bytes(6)])) == uart.LOG
    assert uart.kind(known, bytes([255, 1, *bytes(9), *bytes(5)])) == uart.OTHER
    assert uart.kind(known, bytes([255])) == uart.OTHER


def test_other_devices_escape_otherwise(known):
    framing = replace(
        known.framing,
        escape=0xDB,
        start=0xC0,
        end=0xC1,
        escaped=0xDD,
        escapes_id=False,
        ignores_other=True,
    )
    line = uart.encode(framing, bytes([0xDB, 0xDB, 1]))
    assert line.hex() == "dbc0dbdbdd01dbc1"
    decoder = uart.Decoder(framing, 10)
    assert [e.message for e in decoder.feed(line)] == [bytes([0xDB, 0xDB, 1])]
    assert [e.message for e in decoder.feed(bytes.fromhex("dbc090db0001dbc1"))] == [
        bytes([0x90, 1])
    ]
