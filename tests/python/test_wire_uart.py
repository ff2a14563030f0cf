"""Streams: noise and messages of any length cost neither memory nor time."""

from __future__ import annotations

import time

import pytest

from tests.python.wire import link


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


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


def test_a_message_without_an_id_is_refused(shipped, wire):
    with pytest.raises(shipped.module().LengthError):
        wire.uart_encode(link(shipped), b"")


def test_a_node_without_a_uart_is_refused(shipped, wire):
    like = link(shipped)._replace(framing=None)
    with pytest.raises(wire.UnsupportedError, match="uart"):
        wire.UartDecoder(like)
    with pytest.raises(wire.UnsupportedError, match="uart"):
        wire.uart_encode(like, b"\x80")
