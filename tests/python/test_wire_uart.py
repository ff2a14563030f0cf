"""The UART decoder handles noise and messages of any length in bounded memory."""

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
def test_a_megabyte_of_noise_does_not_hide_the_next_message(shipped, wire, noise):
    size, uart_link = 1_000_000, link(shipped)
    noise_bytes = {
        "random": bytes(
            index * index * 2654435761 >> 13 & 0xFF for index in range(size)
        ),
        "zeros": bytes(size),
        "starts": b"\x1f\x7f" * (size // 2),
        "escapes": b"\x1f" * size,
        "escaped data": b"\x1f\x1f\x7f\x00" * (size // 4),
    }[noise]
    noise_bytes = (
        noise_bytes[:-1] + b"\0"
    )  # a final escape byte would become part of the start
    line = wire.uart_encode(uart_link, b"\x92" + bytes(6))
    decoder = wire.UartDecoder(uart_link)
    start = time.process_time()
    messages = [
        event for event in decoder.feed(noise_bytes + line) if event.event == "message"
    ]
    duration = time.process_time() - start
    # The noise may end with the beginning of a message. The decoder then reports an
    # unexpected start, and still returns the message.
    assert messages[-1].message == b"\x92" + bytes(6)
    assert decoder.pending == 0
    on_line = sum(len(wire.uart_encode(uart_link, event.message)) for event in messages)
    assert decoder.discarded + on_line == len(noise_bytes) + len(line)
    # The decoder takes a second at most. With quadratic time, it would take hours.
    assert duration < 5


def test_the_decoder_buffers_at_most_the_longest_message(shipped, wire):
    decoder = wire.UartDecoder(link(shipped))
    for _ in range(100):
        decoder.feed(b"\x1f\x7f" + bytes(10_000))
        assert len(decoder._buffer) <= link(shipped).longest
    assert decoder.discarded + decoder.pending == 100 * 10_002


def test_a_message_of_maximum_length_is_decoded_and_a_longer_one_is_an_overrun(
    shipped, wire
):
    uart_link = link(shipped)
    for size, expected in (
        (uart_link.longest, "message"),
        (uart_link.longest + 1, "overrun"),
    ):
        for fill in (b"\0", b"\x1f"):
            line = wire.uart_encode(uart_link, fill * size)
            assert [
                event.event for event in wire.UartDecoder(uart_link).feed(line)
            ] == [expected]


def test_a_message_without_an_id_is_refused(shipped, wire):
    with pytest.raises(shipped.module().LengthError):
        wire.uart_encode(link(shipped), b"")


def test_a_node_without_a_uart_is_refused(shipped, wire):
    uart_link = link(shipped)._replace(framing=None)
    with pytest.raises(wire.UnsupportedError, match="uart"):
        wire.UartDecoder(uart_link)
    with pytest.raises(wire.UnsupportedError, match="uart"):
        wire.uart_encode(uart_link, b"\x80")
