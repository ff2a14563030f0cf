"""UART messages are found completely, whatever bytes precede, separate or interrupt
them.
"""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st
from icdgen_runtime.wire.uart import UartDecoder, uart_encode, uart_kind

from tests.protocol import MARKERS, NOISE, cut, quick

ESCAPE, START, END = 0x1F, 0x7F, 0xFF
messages = st.one_of(
    st.binary(min_size=1, max_size=100),
    st.lists(MARKERS, min_size=1, max_size=100).map(bytes),
)
forms = st.fixed_dictionaries(
    {"escapes_id": st.booleans(), "ignores_other": st.booleans()}
)


def line(data):
    return b"\x1f\x7f" + data + b"\x1f\xff"


lines = messages.map(line) | messages.map(
    lambda message: line(message.replace(b"\x1f", b"\x1f\x1f"))
)
noises = st.lists(NOISE, max_size=8).map(b"".join)
streams = st.lists(lines | NOISE, max_size=8).map(b"".join)


def with_framing(link, form):
    return link._replace(framing=link.framing._replace(**form))


def decode(link, *chunks, limit=None):
    decoder = UartDecoder(link, limit)
    return [event for chunk in chunks for event in decoder.feed(chunk)], decoder


def decoded_messages(link, stream):
    return [e.message for e in decode(link, stream)[0] if e.event == "message"]


def test_the_id_that_is_the_escape_byte_is_escaped(link):
    assert uart_encode(link, bytes([31, 0])).hex() == "1f7f1f1f001fff"
    assert decoded_messages(link, bytes.fromhex("1f7f1f1f001fff")) == [bytes([31, 0])]


def test_an_end_within_the_data_is_data(link):
    message = bytes.fromhex("901f1fff")
    assert uart_encode(link, message).hex() == "1f7f901f1f1f1fff1fff"
    assert decoded_messages(link, uart_encode(link, message)) == [message]


@given(sent=st.lists(messages, max_size=5), form=forms)
def test_encoded_messages_are_decoded_unchanged(link, sent, form):
    link = with_framing(link, form)
    stream = b"".join(uart_encode(link, message) for message in sent)
    events, decoder = decode(link, stream)
    assert [e.message for e in events] == sent
    assert decoder.discarded == decoder.pending == 0


@given(
    stream=streams,
    places=st.lists(st.integers(0, 300), max_size=12),
    limit=st.integers(1, 40),
    form=forms,
)
@example(stream=b"\x1f\x7f\x1f\x1f\x1f\xff", places=[1, 3], limit=1, form={})
def test_events_do_not_depend_on_how_a_stream_is_cut(link, stream, places, limit, form):
    link = with_framing(link, form)
    uncut, first = decode(link, stream, limit=limit)
    for pieces in (cut(stream, places), cut(stream, list(range(len(stream))))):
        events, decoder = decode(link, *pieces, limit=limit)
        assert events == uncut
        assert (decoder.discarded, decoder.pending) == (first.discarded, first.pending)


@quick
@given(
    noise=noises.filter(lambda noise: bytes([ESCAPE, START]) not in noise),
    message=messages,
)
def test_a_message_after_noise_is_decoded_and_the_noise_is_counted(
    link, noise, message
):
    events, decoder = decode(link, noise + uart_encode(link, message))
    assert [e.message for e in events] == [message]
    assert decoder.discarded == len(noise)


@quick
@given(stream=streams, message=messages)
def test_a_message_after_an_end_is_found_after_any_bytes(link, stream, message):
    line = uart_encode(link, message)
    assert (
        decoded_messages(link, stream + bytes([0, ESCAPE, END]) + line)[-1] == message
    )


@quick
@given(stream=streams, limit=st.integers(1, 30))
def test_at_most_the_longest_message_is_buffered(link, stream, limit):
    decoder = UartDecoder(link, limit)
    delivered = 0
    for number, byte in enumerate(stream, 1):
        for event in decoder.feed(bytes([byte])):
            assert len(event.message) <= limit
            if event.event == "message":
                delivered += len(uart_encode(link, event.message))
        assert len(decoder._buffer) <= limit
        assert decoder.discarded + decoder.pending + delivered == number


def test_errors_in_the_stream_are_reported(link):
    start, end = bytes([ESCAPE, START]), bytes([ESCAPE, END])

    def kinds(stream, limit=None):
        return [e.event for e in decode(link, stream, limit=limit)[0]]

    assert kinds(start + b"\x90" + start + b"\x91" + end) == [
        "unexpected_start",
        "message",
    ]
    assert kinds(start + b"\x90\x1f\x00" + end) == ["protocol_error"]
    assert kinds(start + end) == ["empty"]
    assert kinds(start + b"\x90\x01\x02" + end, limit=2) == ["overrun"]
    assert kinds(start + b"\x90\x01" + end, limit=2) == ["message"]
    assert kinds(start + b"\x90\x1f") == []


def test_the_kind_of_a_message_is_recognized(link):
    assert uart_kind(link, bytes([31, 0])) == "acknowledge"
    assert uart_kind(link, bytes([119, 0])) == "acknowledge"
    assert uart_kind(link, bytes([119]) + bytes(22)) == "packet"
    assert uart_kind(link, bytes([119]) + bytes(21)) == "other"
    assert uart_kind(link, bytes([241]) + bytes(22)) == "reply"
    assert uart_kind(link, bytes([255, 1, *bytes(9), *bytes(6)])) == "log"
    assert uart_kind(link, bytes([255, 1, *bytes(9), *bytes(5)])) == "other"
    assert uart_kind(link, bytes([255])) == "other"


def test_another_device_can_have_other_escape_bytes(link):
    form = {"escape": 0xDB, "start": 0xC0, "end": 0xC1, "escaped": 0xDD}
    other = with_framing(link, {**form, "escapes_id": False, "ignores_other": True})
    line = uart_encode(other, bytes([0xDB, 0xDB, 1]))
    assert line.hex() == "dbc0dbdbdd01dbc1"
    assert decoded_messages(other, line) == [bytes([0xDB, 0xDB, 1])]
    assert decoded_messages(other, bytes.fromhex("dbc090db0001dbc1")) == [
        bytes([0x90, 1])
    ]
