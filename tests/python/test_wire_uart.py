"""Streams: what is found in them depends neither on how they are cut nor on the noise
around it.
"""

from __future__ import annotations

import time
from dataclasses import replace

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from icdgen.protocol import uart
from tests.python.wire import MARKERS, NOISE, cut, known, link

MESSAGES = st.lists(MARKERS, min_size=1, max_size=30).map(bytes)
LINES = MESSAGES.map(lambda message: uart.encode(known().framing, message))
STREAMS = st.lists(LINES | NOISE, max_size=8).map(b"".join)
CUTS = st.lists(st.integers(0, 300), max_size=12)
FORMS = st.builds(
    lambda id, other: {"escapes_id": id, "ignores_other": other}, st.booleans(), st.booleans()
)  # fmt: skip


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def events(decoder, chunks) -> list[tuple[str, bytes]]:
    return [
        (event.event, event.message)
        for chunk in chunks
        for event in decoder.feed(chunk)
    ]


@given(stream=STREAMS, places=CUTS, limit=st.integers(1, 40), form=FORMS)
@example(stream=b"\x1f\x7f\x1f\x1f\x1f\xff", places=[1, 2, 3, 4, 5], limit=1, form={})
def test_every_split_of_a_stream_gives_what_the_reference_finds(
    shipped, wire, stream, places, limit, form
):
    framing = replace(known().framing, **form)
    like = link(shipped)
    decoder = wire.UartDecoder(
        like._replace(framing=like.framing._replace(**form)), limit
    )
    reference = uart.Decoder(framing, limit)
    expected = [(event.event, event.message) for event in reference.feed(stream)]
    assert events(decoder, cut(stream, places)) == expected
    assert (decoder.discarded, decoder.pending) == (
        reference.discarded,
        reference.pending,
    )


@given(message=st.binary(min_size=1, max_size=200) | MESSAGES, escapes_id=st.booleans())
def test_what_is_encoded_is_decoded_and_no_markers_are_left_in_the_data(
    shipped, wire, message, escapes_id
):
    like = link(shipped)
    like = like._replace(framing=like.framing._replace(escapes_id=escapes_id))
    line = wire.uart_encode(like, message)
    assert line == uart.encode(replace(known().framing, escapes_id=escapes_id), message)
    assert events(wire.UartDecoder(like), [line]) == [("message", message)]


@pytest.mark.parametrize(
    "data",
    [b"\x01", b"\x1f\x1f\xff", b"\x1f\x7f", b"\x1f\xff", b"\x1f" * 7, b"\x7f\xff\x1f"],
)
def test_telecommand_31_and_markers_in_data_survive_in_both_directions(
    shipped, wire, data
):
    message = b"\x1f" + data
    line = wire.uart_encode(link(shipped), message)
    assert line.startswith(b"\x1f\x7f\x1f\x1f") and line.endswith(b"\x1f\xff")
    for size in (1, 2, 3, len(line)):
        chunks = [line[at : at + size] for at in range(0, len(line), size)]
        assert events(wire.UartDecoder(link(shipped)), chunks) == [("message", message)]


@pytest.mark.parametrize(
    "noise", ["random", "zeros", "starts", "escapes", "escaped data"]
)
def test_a_megabyte_of_noise_costs_nothing_but_that_noise(shipped, wire, noise):
    size, like = 1_000_000, link(shipped)
    made = {
        "random": bytes(
            index * index * 2654435761 >> 13 & 0xFF for index in range(size)
        ),
        "zeros": bytes(size),
        "starts": b"\x1f\x7f" * (size // 2),
        "escapes": b"\x1f" * size,
        "escaped data": b"\x1f\x1f\x7f\x00" * (size // 4),
    }[noise]
    made = made[:-1] + b"\0"  # an escape byte in front of the start would belong to it
    line = wire.uart_encode(like, b"\x92" + bytes(6))
    decoder = wire.UartDecoder(like)
    start = time.process_time()
    found = [event for event in decoder.feed(made + line) if event.event == "message"]
    took = time.process_time() - start
    # Noise may end within what looks like a message: then the start is unexpected, and
    # the message is there all the same.
    assert found[-1].message == b"\x92" + bytes(6)
    assert decoder.pending == 0
    on_line = sum(len(wire.uart_encode(like, event.message)) for event in found)
    assert decoder.discarded + on_line == len(made) + len(line)
    assert (
        took < 5
    )  # it takes milliseconds to a second: what grew with the square would take hours


def test_no_more_is_kept_than_the_longest_message(shipped, wire):
    decoder = wire.UartDecoder(link(shipped))
    for _ in range(100):
        decoder.feed(b"\x1f\x7f" + bytes(10_000))
        assert len(decoder._buffer) <= link(shipped).longest
    assert decoder.discarded + decoder.pending == 100 * 10_002


def test_a_message_as_long_as_the_longest_fits_and_a_longer_one_is_an_overrun(
    shipped, wire
):
    like = link(shipped)
    for size, expected in ((like.longest, "message"), (like.longest + 1, "overrun")):
        for fill in (b"\0", b"\x1f"):
            line = wire.uart_encode(like, fill * size)
            assert [event.event for event in wire.UartDecoder(like).feed(line)] == [
                expected
            ]


@given(message=st.binary(min_size=1, max_size=140))
def test_messages_are_told_apart_like_the_reference_does(shipped, wire, message):
    assert wire.uart_kind(link(shipped), message) == uart.kind(known(), message)


def test_kinds_of_messages(shipped, wire):
    like = link(shipped)
    packet = bytes((like.files.packet_ids["uart"],)) + bytes(22)
    samples = {
        "reply": b"\x92" + bytes(6),
        "acknowledge": b"\x1f\x00",
        "packet": packet,
        "log": b"\xff" + bytes(10),
    }
    for kind, message in samples.items():
        assert wire.uart_kind(like, message) == kind
    assert wire.uart_kind(like, b"\x01\x02\x03") == "other"
    assert wire.uart_kind(like, b"\xff" + bytes(11)) == "other"


def test_a_message_without_an_id_is_refused(shipped, wire):
    with pytest.raises(shipped.module().LengthError):
        wire.uart_encode(link(shipped), b"")


def test_a_node_without_a_uart_is_refused(shipped, wire):
    like = link(shipped)._replace(framing=None)
    with pytest.raises(wire.UnsupportedError, match="uart"):
        wire.UartDecoder(like)
    with pytest.raises(wire.UnsupportedError, match="uart"):
        wire.uart_encode(like, b"\x80")
