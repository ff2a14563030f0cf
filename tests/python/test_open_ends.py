"""Messages of variable length: tuples, bytes and texts as long as they are."""

from __future__ import annotations

import pytest

from tests.conformance import odd
from tests.python import packages


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("open")
    (folder / "open.yaml").write_text(odd.OPEN, encoding="utf-8")
    return packages.write(packages.read(folder / "open.yaml"), folder, "open_messages")


@pytest.fixture(scope="module")
def messages(package):
    return package.module("open")


def test_an_open_array_is_as_long_as_the_frame_says(messages):
    message = messages.Narrow.from_bytes(bytes([3, 1, 0, 0, 255, 255, 255]))
    assert (message.number, message.samples) == (3, (1, -1))
    assert message.to_bytes() == bytes([3, 1, 0, 0, 255, 255, 255])
    assert messages.Narrow().to_bytes() == bytes(1)
    assert messages.Narrow.LENGTH == 16 and messages.Narrow.TAIL.most == 5


def test_bytes_and_texts_are_as_long_as_they_are(messages):
    text = messages.Text(severity=1)
    text.match_text = "hello"
    assert text.match == b"hello" and text.to_bytes() == b"\0\1hello"
    assert messages.Text.from_bytes(b"\0\1hello") == text
    assert messages.Payload.from_bytes(b"").data == b"" and messages.Payload(data=b"\1").to_bytes() == b"\1"


def test_a_field_that_counts_must_agree(package, messages):
    errors = package.module("_errors")
    gauges = messages.Gauges(gauges=(300, 1))
    with pytest.raises(errors.RangeError, match="gauges_count takes 2, as many as gauges has, not 0"):
        gauges.to_bytes()
    gauges.gauges_count = 2
    assert gauges.to_bytes() == bytes([2, 0, 1, 44, 0, 1])
    with pytest.raises(errors.LengthError, match="has 8 bytes, 4 given"):
        messages.Gauges.from_bytes(bytes([3, 0, 0, 1]))


@pytest.mark.parametrize("size", [0, 2, 3, 5, 17, 400])
def test_a_frame_of_no_length_of_the_message_is_refused(package, messages, size):
    with pytest.raises(package.module("_errors").LengthError):
        messages.Narrow.from_bytes(bytes(size))


def test_more_elements_than_there_can_be_are_refused(package, messages):
    error = package.module("_errors").RangeError
    with pytest.raises(error, match="samples takes up to 5 values"):
        messages.Narrow(samples=(0,) * 6).to_bytes()
    with pytest.raises(error, match=r"samples\[1\] takes integers"):
        messages.Narrow(samples=(0, 1 << 23)).to_bytes()
    with pytest.raises(error):
        messages.Payload(data=bytes(256)).to_bytes()


def test_zeros_that_a_frame_ends_with_may_be_left_out(package, messages):
    whole = messages.CutOff.from_bytes(b"\xff\xe5\x3f\x80" + bytes(19))
    cut = messages.CutOff.from_bytes(b"\xff\xe5\x3f\x80")
    assert cut == whole and (cut.input, cut.value, cut.words_text) == (-2, 1.0, "")
    assert len(cut.to_bytes()) == 23 and messages.Two.from_bytes(b"\0") == messages.Two()
    for size, known in ((0, 1), (24, 23)):
        with pytest.raises(package.module("_errors").LengthError, match=f"has {known} byte.*, {size} given"):
            messages.CutOff.from_bytes(bytes(size))
    frames = [b"\0\5\x3f\x80", bytes(23)]
    assert messages.CutOff.decode_many(frames)["value"].tolist() == [1.0, 0.0]
    assert messages.CutOff.decode_many(bytes(46))["value"].tolist() == [0.0, 0.0]


def test_columns_hold_what_is_there(package, messages):
    frames = [messages.Narrow(samples=values).to_bytes() for values in ((), (1, -1), (7,))]
    column = messages.Narrow.decode_many(frames)["samples"]
    assert [one.tolist() for one in column] == [[], [1, -1], [7]]
    assert messages.Narrow.decode_table(frames, physical=False)["samples"].to_pylist() == [[], [1, -1], [7]]
    texts = messages.Text.decode_table([b"\0\1hi", b"\0\2"])
    assert texts["match_text"].to_pylist() == ["hi", ""]
    assert messages.Payload.decode_table([b"ab", b""])["data"].to_pylist() == [b"ab", b""]
    assert messages.Narrow.decode_table([], physical=False)["samples"].to_pylist() == []
    with pytest.raises(package.module("_errors").IcdError, match="give them as a list"):
        messages.Narrow.decode_many(b"\0")
