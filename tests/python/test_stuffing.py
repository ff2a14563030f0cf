"""Delimited frames, byte by byte: known encodings, limits of the buffer and errors."""

from __future__ import annotations

from random import Random

import pytest
from icdgen_runtime.wire.packet_formats import Escaping, Stream
from icdgen_runtime.wire.stuffing import Frame, stuffed, unstuffer

from tests.limits import assert_limits

DLE = Escaping(escape=0x10, end=0x03, data=0x10, start=0x02)
FIRST_BYTE = Escaping(escape=0x10, end=0x03, data=0x10)
TOLERANT = DLE._replace(ignores_other=True)


def form(delimited_by: str, escaping: Escaping | None = None) -> Stream:
    return Stream(delimited_by, False, (), (), (), escaping=escaping)  # type: ignore[arg-type]


FORMS = {
    "cobs": form("cobs"),
    "slip": form("slip"),
    "hdlc": form("hdlc"),
    "dle": form("escape", DLE),
    "first byte": form("escape", FIRST_BYTE),
}


def frames_in(stream: Stream, data: bytes, limit: int = 1000) -> list[Frame]:
    reader = unstuffer(stream, limit)
    assert reader is not None
    return reader.feed(data)


@pytest.mark.parametrize(
    "name, frame, encoded",
    [
        ("cobs", "", "01 00"),
        ("cobs", "00", "01 01 00"),
        ("cobs", "11 00 00 22", "02 11 01 02 22 00"),
        ("cobs", "11" * 253, "fe" + "11" * 253 + "00"),
        ("cobs", "11" * 254, "ff" + "11" * 254 + "00"),
        ("cobs", "11" * 255, "ff" + "11" * 254 + "02 11 00"),
        ("cobs", "11" * 254 + "00", "ff" + "11" * 254 + "01 01 00"),
        ("slip", "c0 db dc dd", "c0 db dc db dd dc dd c0"),
        ("hdlc", "7e 7d 5e 5d", "7e 7d 5e 7d 5d 5e 5d 7e"),
        ("dle", "02 10 03", "10 02 02 10 10 03 10 03"),
        ("first byte", "02 10 03", "10 02 10 10 03 10 03"),
    ],
)
def test_a_frame_has_the_delimiters_and_escapes_of_its_standard(name, frame, encoded):
    assert stuffed(FORMS[name], bytes.fromhex(frame)) == bytes.fromhex(encoded)


@pytest.mark.parametrize("name", FORMS)
def test_random_frames_come_back_from_any_pieces(name):
    random = Random(name)
    # Bytes with a meaning in one of the framings are frequent.
    special = bytes.fromhex("00 02 03 10 5d 5e 7d 7e c0 db dc dd ff")
    for _ in range(60):
        body = bytes(random.choices(special, k=random.randrange(1, 40)))
        frame = b"\x55" + body + b"\x66" * random.choice((0, 0, 300))
        encoded = stuffed(FORMS[name], frame)
        reader = unstuffer(FORMS[name], 1000)
        assert reader is not None
        cut = random.randrange(len(encoded) + 1)
        received = reader.feed(encoded[:cut]) + reader.feed(encoded[cut:])
        assert [each[::2] for each in received] == [(frame, None)]
        assert (reader.pending, reader.begun) == (0, b"")


@pytest.mark.parametrize("name", FORMS)
def test_a_frame_of_the_size_of_the_buffer_is_the_longest(name):
    def is_received(size: int) -> bool:
        frame = b"\x55" * size
        (received,) = frames_in(FORMS[name], stuffed(FORMS[name], frame), 8)
        assert received.fault in (None, "overrun")
        assert received.bytes == frame[:8]
        return received.fault is None

    assert_limits(is_received, most=8)


@pytest.mark.parametrize("name", ["cobs", "slip", "hdlc"])
def test_delimiters_between_frames_begin_no_frame(name):
    end = stuffed(FORMS[name], b"\x55")[-1:]
    assert frames_in(FORMS[name], end * 3) == []
    (frame,) = frames_in(FORMS[name], end * 3 + stuffed(FORMS[name], b"\x55"))
    assert frame.bytes == b"\x55"


@pytest.mark.parametrize(
    "name, data, expected",
    [
        ("cobs", "03 11 00", ("11", 3, "framing")),
        ("cobs", "02 11 00", ("11", 3, None)),
        ("slip", "11 db c0", ("11", 3, "framing")),
        ("slip", "11 db 22 33 c0", ("11", 5, "framing")),
        ("hdlc", "11 7d 7e", ("11", 3, "framing")),
        ("hdlc", "11 7d 31 7e", ("1111", 4, None)),
    ],
)
def test_a_frame_that_ends_within_an_escape_or_block_is_reported(name, data, expected):
    octets, size, fault = expected
    frame = Frame(bytes.fromhex(octets), size, fault)
    # The next frame is received again.
    after = stuffed(FORMS[name], b"\x44")
    first, *others = frames_in(FORMS[name], bytes.fromhex(data) + after)
    assert first == frame
    assert [(each.bytes, each.fault) for each in others] == [(b"\x44", None)]


@pytest.mark.parametrize(
    "escaping, data, expected",
    [
        (DLE, "44 55 10 02 11 10 03", [("", 2, "noise"), ("11", 5, None)]),
        # An escape byte and another byte before a frame are noise together.
        (DLE, "10 44 10 02 10 03", [("", 2, "noise"), ("", 4, None)]),
        # Only the last of several escape bytes begins a frame.
        (DLE, "10 10 02 11 10 03", [("", 1, "noise"), ("11", 5, None)]),
        # The end of the first frame was lost.
        (DLE, "10 02 11 10 02 22 10 03", [("11", 3, "framing"), ("22", 5, None)]),
        (DLE, "10 02 11 10 44 22 10 03", [("11", 8, "framing")]),
        (TOLERANT, "10 02 11 10 44 22 10 03", [("1122", 8, None)]),
        (FIRST_BYTE, "10 03 10 44 10 03", [("", 2, "noise"), ("44", 4, None)]),
        (FIRST_BYTE, "10 44 10 45 10 03", [("44", 2, "framing"), ("45", 4, None)]),
    ],
)
def test_each_byte_around_escape_characters_is_counted_once(escaping, data, expected):
    received = frames_in(form("escape", escaping), bytes.fromhex(data))
    assert received == [
        Frame(bytes.fromhex(octets), size, fault) for octets, size, fault in expected
    ]
    assert sum(frame.size for frame in received) == len(bytes.fromhex(data))


def test_a_frame_that_has_begun_is_visible_before_its_end():
    for name, data in [("slip", "c0 11 22"), ("cobs", "05 11 22")]:
        reader = unstuffer(FORMS[name], 9)
        assert reader is not None
        assert reader.feed(bytes.fromhex(data)) == []
        assert reader.begun == b"\x11\x22"
        assert reader.pending == (2 if name == "slip" else 3)
    reader = unstuffer(FORMS["dle"], 9)
    assert reader is not None
    assert reader.feed(bytes.fromhex("10 02 11 22 10")) == []
    assert (reader.begun, reader.pending) == (b"\x11\x22", 5)


@pytest.mark.parametrize("delimited_by", ["length", "datagram"])
def test_links_without_delimiters_leave_frames_as_they_are(delimited_by):
    assert unstuffer(form(delimited_by), 9) is None
    assert stuffed(form(delimited_by), b"\x00\xc0\x7e") == b"\x00\xc0\x7e"
