"""Fields of fixed size behind parts of variable length: a message has them wherever the
part in front of them ends.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen import codec
from icdgen.icd.frames import frame_fields
from icdgen.vectors import patterns
from tests.conformance import odd
from tests.python import packages


@pytest.fixture(scope="module")
def icd():
    return packages.read(odd.FOLDER / "behind.yaml")


@pytest.fixture(scope="module")
def package(icd, tmp_path_factory):
    return packages.write(icd, tmp_path_factory.mktemp("behind"), "behind_messages")


@pytest.fixture(scope="module")
def messages(package):
    return package.module("behind")


def test_a_checksum_is_read_behind_a_payload_of_any_length(messages):
    for size in (0, 1, 17, 40):
        payload = bytes(range(size))
        frame = b"\x12\x34" + payload + b"\xcd\xab"
        packet = messages.Packet.from_bytes(frame)
        assert (packet.sender, packet.payload, packet.crc) == (0x1234, payload, 0xABCD)
        assert packet.to_bytes() == frame
    assert messages.Packet().to_bytes() == bytes(4)


def test_a_frame_that_ends_within_the_fields_behind_is_refused(package, messages):
    errors = package.module("_errors")
    for size in (0, 1, 3, 45):
        with pytest.raises(errors.LengthError):
            messages.Packet.from_bytes(bytes(size))
    with pytest.raises(errors.LengthError, match="has 2 bytes, 1 given"):
        messages.Counted.from_bytes(b"\0")
    with pytest.raises(errors.LengthError, match="has 4 bytes, 3 given"):
        messages.Counted.from_bytes(b"\2\1\1")


def test_a_constant_behind_a_text_ends_each_frame(messages):
    sentence = messages.Sentence(length=5, words=b"ok", codes=(1, 2))
    assert sentence.to_bytes() == b"\5ok\x01\x02\x00\x03"
    assert messages.Sentence.from_bytes(b"\5ok\x01\x02\x00\x03") == sentence


def test_fields_between_two_parts_move_with_the_first(messages):
    frame = bytes.fromhex("01 00 02 0004 55 61620000 aabb 9004 fffffffffffffffe")
    between = messages.Between.from_bytes(frame)
    assert between.first_physical[0] == 1.0 and between.label_text == "ab"
    assert between.third == b"\xaa\xbb" and between.total == -2
    assert (between.flags.level, between.flags.is_valid) == (4, True)
    assert between.to_bytes() == frame


def test_a_value_is_derived_from_a_field_behind(messages):
    points = messages.Points.from_bytes(bytes(3 + 1 + 2 + 1 + 6) + b"\x64\0\0")
    assert points.wide_m == 2.0


def test_many_frames_of_different_lengths_are_read_into_columns(messages):
    frames = [b"\0\1" + bytes(size) + b"\5\0" for size in (3, 0, 2)]
    columns = messages.Packet.decode_many(frames)
    assert columns["crc"].tolist() == [5, 5, 5]
    assert list(columns["payload"]) == [bytes(3), b"", bytes(2)]


@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_any_frame_means_what_the_reference_codec_reads(data, icd, messages):
    node = icd.node("behind")
    message = data.draw(st.sampled_from(node.messages))
    longest = data.draw(st.binary(min_size=message.length, max_size=message.length))
    counts = {
        name: data.draw(st.integers(part.fewest, part.most), label=name)
        for name, part in message.layout.parts_by_size.items()
    }
    frame = patterns.with_counts(message, node, longest, counts)
    frame = patterns.shortened(message, frame, counts)
    frame = frame[: len(frame) - data.draw(st.sampled_from((0, 0, 0, 1, 2)))]
    kind = getattr(messages, message.name.title().replace(" ", ""))
    try:
        expected = codec.decode_frame(node, message, frame)
    except codec.LengthError as error:
        with pytest.raises(ValueError, match=f" {error.expected} bytes"):
            kind.from_bytes(frame)
        return
    decoded = kind.from_bytes(frame)
    assert decoded.to_bytes() == codec.frame_with(
        node, message, codec.decode(node, message, frame)
    )
    for field in frame_fields(message.layout, node.orders):
        is_plain = len(field.steps) == 1 and field.steps[0].element is None
        if is_plain and field.role == "field" and field.type in ("uint", "int"):
            attribute = field.name.lower().replace(" ", "_")
            assert getattr(decoded, attribute) == expected[field.name]
