"""Fields of characters: raw bytes that are kept, and the text in them."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="module")
def texts(odd):
    return odd.module("odd").Texts


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        (b"EXT CORE 1.00 (61b2dd)".ljust(30, b"\0"), "EXT CORE 1.00 (61b2dd)"),
        (bytes(30), ""),
        (b"x" * 30, "x" * 30),
        (b"ends\0 here".ljust(30, b"\0"), "ends"),
        (b"\x01\x7f\x80\xff".ljust(30, b"\0"), "\x01\x7f\ufffd\ufffd"),
    ],
)
def test_a_text_ends_at_its_first_nul_and_keeps_its_bytes(texts, raw, text):
    frame = raw + bytes(14)
    message = texts.from_bytes(frame)
    assert (message.software, message.software_text) == (raw, text)
    assert message.to_bytes() == frame


@pytest.mark.parametrize("text", ["", "a", "u-blox", "x" * 30, "\x01\x7f"])
def test_a_text_that_is_set_is_filled_with_nul(texts, text):
    message = texts(software=b"\xff" * 30)
    message.software_text = text
    assert message.software == text.encode().ljust(30, b"\0")
    assert texts.from_bytes(message.to_bytes()).software_text == text


@pytest.mark.parametrize("text", ["x" * 31, "\u00e9", "a\0b", "\0", b"bytes", None, 7])
def test_what_is_no_such_text_is_refused_and_nothing_set(odd, texts, text):
    message = texts(software=b"y" * 30)
    with pytest.raises(odd.module().RangeError) as caught:
        message.software_text = text
    assert caught.value.field == "software_text"
    assert message.software == b"y" * 30


def test_physical_values_of_a_message_hold_its_texts(texts):
    message = texts.from_physical(software_text="1.2", raw_physical=6)
    physical = {
        "software_text": "1.2",
        "one_text": "",
        "hard_ware_text": "",
        "raw_physical": 6.0,
    }
    assert message.as_dict(physical=True) == physical


def test_tables_have_texts_as_strings(texts):
    frames = b"".join(
        texts.from_physical(software_text=text).to_bytes()
        for text in ("", "abc", "x" * 30)
    )
    table = texts.decode_table(frames)
    assert table["software_text"].to_pylist() == ["", "abc", "x" * 30]
    assert str(table.schema.field("software_text").type) == "string"
    assert texts.decode_table(frames, physical=False)["software"].to_pylist()[
        1
    ] == b"abc".ljust(30, b"\0")
